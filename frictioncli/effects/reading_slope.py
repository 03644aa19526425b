r"""Rate of change of a temperature reading, from its heat balance.

A few readings of one measuring series tell their own slope poorly, and that changes from move to
move: slow moves warm a motor less than fast ones. What warms and cools it is known in part. The
reading *R* of a sensor with time constant :math:`\theta` follows

.. math:: \theta \ddot R = q - \dot R, \qquad q = b_0 + b_1 P + b_2 R + w

with the friction power *P* that the log tells, losses linear in the temperature, and white noise
*w* for all other heat; readings have white noise as well. By how much a reading rises in a pause
tells nothing of its slope at the end: the joint may have been heated first, and then have rested.

The slope is the mean of :math:`\dot R` given all readings [1]_. Its error is not correlated with
it, as that of the slope of a line is, so that a coefficient of it is not reduced. How much heat is
not known, in a measuring series and in a pause between two, the readings tell: the mean is over
some variances, by their likelihood [2]_.

References
----------
.. [1] A. C. Harvey, *Forecasting, Structural Time Series Models and the Kalman Filter*, Cambridge
   University Press, 1990, doi:10.1017/CBO9781107049994.
.. [2] D. A. Harville, "Maximum likelihood approaches to variance component estimation and to
   related problems," J. Am. Stat. Assoc. 72(358), 1977, doi:10.1080/01621459.1977.10480998.
"""

from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.linalg import cho_solve_banded, cholesky_banded

from frictioncli.arrays import Array, Flags
from frictioncli.effects.base import EffectTable
from frictioncli.effects.friction_heat import friction_power
from frictioncli.effects.pair_series import PairHeads, pair_heads, starts

_TIME_CONSTANT = 90.0
"""Time constant with which a reading follows heat; sensors in a winding have 60 to 120 s. [s]"""

_NOISE = (0.3, 10.0, 300.0, 10_000.0)
"""Variances of a reading that are tried, relative to the intensity of the unknown heat. [s]"""

_IN_PAUSES = (1.0, 30.0, 1000.0)
"""Intensities of the unknown heat in a pause that are tried, relative to that in a series. [-]"""

_PAIRS_PER_INPUT = 5
"""Least number of pairs per input of the heat balance."""

_LEAST_STEP = 1.0
"""Least time between two pairs; those that share moves may have the same middle. [s]"""

_FLAT = 1e-8
"""Weight of a slope of zero, which decides where no reading does, as in a run of one pair. [s]"""

_SHORT = 0.01
"""Greatest step, relative to the time constant, that counts as short."""

_EXACT = 1e-9
"""Intensity of unknown heat that counts as none. [°C²/s]"""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Balance:
    """Readings, and what is known of the heat from each pair to the next.

    Attributes
    ----------
    reading : ndarray, shape (pairs,)
        Readings. [°C]
    inputs : ndarray, shape (pairs - 1, inputs)
        Known parts of the heat, each times an unknown coefficient.
    joined, pause : ndarray of bool, shape (pairs - 1,)
        Whether both pairs belong to the same run, and whether a pause lies between them.
    step : ndarray, shape (pairs - 1,)
        Time between them. [s]
    """

    reading: Array
    inputs: Array
    joined: Flags
    pause: Flags
    step: Array


@dataclass(frozen=True, slots=True, kw_only=True)
class _Equation:
    """An equation from each pair to the next, whose error has variance 1.

    Attributes
    ----------
    state : list of ndarray, shape (pairs - 1,)
        Factors of reading and slope of the pair, and of reading and slope of the next.
    inputs : ndarray, shape (pairs - 1, inputs)
        Inputs.
    """

    state: list[Array]
    inputs: Array


@dataclass(frozen=True, slots=True, kw_only=True)
class _Heat:
    """Normal equations of all equations from pair to pair.

    Attributes
    ----------
    banded : ndarray, shape (4, 2 * pairs)
        Lower diagonals of the matrix of readings and slopes, in turn.
    mixed : ndarray, shape (2 * pairs, inputs)
        That of readings and slopes with the coefficients of the inputs.
    inputs : ndarray, shape (inputs, inputs)
        That of the coefficients.
    spread : float
        Logarithm of the determinant of the covariance of the errors.
    """

    banded: Array
    mixed: Array
    inputs: Array
    spread: float


def reading_slope(table: EffectTable) -> Array:
    """Return the rate of change of the temperature of each pair.

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.

    Returns
    -------
    ndarray, shape (pairs,)
        Its mean given the readings; 0 in a run of one pair. [°C/s]
    """
    heads = pair_heads(table)
    if len(heads.first) < 2:
        return np.zeros(len(heads.first))
    balance = _balance(table, heads)
    slopes, deviances = zip(
        *(
            _slope(balance, heat, noise)
            for heat, noise in product([_heat(balance, one) for one in _IN_PAUSES], _NOISE)
        ),
        strict=True,
    )
    likelihood = np.exp((np.min(deviances) - np.array(deviances)) / 2)
    return np.asarray(np.average(slopes, axis=0, weights=likelihood))


def _balance(table: EffectTable, heads: PairHeads) -> _Balance:
    """Return the heat balance of the pairs of a table."""
    reading, run = table.temperature[heads.first], table.run[heads.first]
    reading = reading - reading.mean()
    power = friction_power(table, heads)
    first = starts(run)
    known = [power, (reading[1:] + reading[:-1]) / 2]
    # on another day the surroundings may be warmer
    known += [(run[1:] == one).astype(float) for one in np.unique(run)[1:]]
    varying = [one / np.ptp(one) for one in known if np.ptp(one) > 0]
    most = max(1, (len(reading) - 2 * int(first.sum())) // _PAIRS_PER_INPUT)
    return _Balance(
        reading=reading,
        inputs=np.column_stack([np.ones_like(power), *varying][:most]),
        joined=~first[1:],
        pause=table.order[heads.first][1:] == 0,
        step=np.maximum(np.diff(table.time[heads.first]), _LEAST_STEP),
    )


def _heat(balance: _Balance, in_pauses: float) -> _Heat:
    """Return what the heat tells of readings and slopes."""
    size = 2 * len(balance.reading)
    equations, spread = _equations(balance, in_pauses)
    banded = np.zeros((4, size))
    banded[0, 1::2] = _FLAT
    mixed = np.zeros((size, balance.inputs.shape[1]))
    for one in equations:
        for i, factor in enumerate(one.state):
            mixed[i : i + size - 2 : 2] += factor[:, np.newaxis] * one.inputs
            for j in range(i + 1):
                banded[i - j, j : j + size - 2 : 2] += factor * one.state[j]
    inputs = sum(one.inputs.T @ one.inputs for one in equations)
    return _Heat(banded=banded, mixed=mixed, inputs=np.asarray(inputs), spread=spread)


def _slope(balance: _Balance, heat: _Heat, noise: float) -> tuple[Array, float]:
    """Return the mean slope given the readings, and the restricted deviance of two variances.

    The scale of both variances is the one that is likeliest.
    """
    reading, mixed = balance.reading, heat.mixed
    banded = heat.banded.copy()
    banded[0, ::2] += 1.0 / noise
    measured = np.zeros(len(mixed))
    measured[::2] = reading / noise
    root = cholesky_banded(banded, lower=True, check_finite=False)
    solved = cho_solve_banded((root, True), np.column_stack([measured, mixed]), check_finite=False)
    normal = heat.inputs - mixed.T @ solved[:, 1:] + _FLAT * np.eye(len(heat.inputs))
    state = solved[:, 0] + solved[:, 1:] @ np.linalg.solve(normal, mixed.T @ solved[:, 0])
    missed = max(float(reading @ (reading - state[::2])) / noise, 0.0)
    runs = len(reading) - int(balance.joined.sum())
    freedom = max(len(reading) - 2 * runs - len(normal), 1)
    deviance = (
        freedom * np.log(missed + freedom * _EXACT)
        + heat.spread
        + len(reading) * np.log(noise)
        + 2 * np.log(root[0]).sum()
        + np.linalg.slogdet(normal)[1]
    )
    return state[1::2], float(deviance)


def _equations(balance: _Balance, in_pauses: float) -> tuple[list[_Equation], float]:
    r"""Return the equations of slope and reading, and the log determinant of their covariance.

    With :math:`e = e^{-h/\theta}` and :math:`g = \theta (1 - e)`, exactly

    .. math:: \dot R_1 = e \dot R_0 + (1 - e) q, \qquad R_1 = R_0 + g \dot R_0 + (h - g) q
    """
    ratio = balance.step / _TIME_CONSTANT
    gone = -np.expm1(-ratio)
    reached = _TIME_CONSTANT * gone
    twice = -np.expm1(-2 * ratio) / 2
    intensity = np.where(balance.pause, in_pauses, 1.0)
    # the difference of nearly equal numbers where a step is short
    series = np.where(ratio < _SHORT, ratio**3 / 3, ratio - 2 * gone + twice)
    of_slope = intensity * twice / _TIME_CONSTANT
    of_reading = intensity * _TIME_CONSTANT * series
    both = np.where(balance.pause, 0.0, intensity * np.square(gone) / 2)
    follows = both / of_slope
    slope_weight = balance.joined / np.sqrt(of_slope)
    # what is left is a quarter of the variance of the reading in short steps
    left = np.maximum(of_reading - follows * both, of_reading / 8)
    reading_weight = balance.joined / np.sqrt(left)
    nothing, unit = np.zeros_like(ratio), np.ones_like(ratio)
    slope = [nothing, gone - 1.0, nothing, unit]
    reading = [-unit, -reached - follows * slope[1], unit, -follows]
    shares = gone, balance.step - reached - follows * gone
    equations = [
        _Equation(
            state=[weight * one for one in state],
            inputs=(weight * share)[:, np.newaxis] * balance.inputs,
        )
        for weight, state, share in zip(
            (slope_weight, reading_weight), (slope, reading), shares, strict=True
        )
    ]
    return equations, float(np.log((of_slope * left)[balance.joined]).sum())
