r"""Delay and filter of the logged torque, from the starts of moves.

In a log the torque :math:`u(t)` stands as :math:`h * u`, with the response *h* of a delay *d* and a
filter of first order with time constant :math:`\theta`. Both shift it, by :math:`D = d + \theta` on
average; the filter smears it too, with the variance :math:`S = \theta^2`. Where a move starts,

.. math:: u = L(q) + J \ddot q + \sigma\tau(v) + \text{constant of the start}

follows the motion at once but for friction, which builds up over an unknown way: what it is late by
is a parameter of its own, and the first 0.04 s are left out. *D*, *S* and that lateness are found
by nonlinear least squares, the linear ones within (variable projection) [1]_. Where a load
is not known, as of a payload that was put on, each start has a line over the angle besides.
Standard errors are robust to correlation within a start and within all starts of one direction and
speed, since a servo repeats its misfit exactly.

That the torque is neither late nor smeared, is late, filtered, or both, are four rivals, whose
evidence is the integral of the likelihood of *D* and *S* over uniform priors of *d* and
:math:`\theta`.

References
----------
.. [1] G. H. Golub and V. Pereyra, "The differentiation of pseudo-inverses and nonlinear least
   squares problems whose variables separate," SIAM J. Numer. Anal. 10(2), 1973,
   doi:10.1137/0710036.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.ramps.evidence import RampEstimate, RampLog
from frictioncli.diagnosis.ramps.logged_response import responded
from frictioncli.diagnosis.ramps.robust_fit import Labels
from frictioncli.diagnosis.ramps.start_windows import StartWindows
from frictioncli.diagnosis.ramps.timing_rivals import (
    DELAYS,
    LONGEST_FILTER,
    TimingRivals,
)
from frictioncli.distributions import normal_quantile, t_quantile

MAX_LOG_ODDS = 12.0
"""Greatest log odds that the starts may contribute: their model is not exact."""

_LATENESS = 0.06
"""Greatest lateness of friction, either way. [s]"""

_SHIFT_TOLERANCE = 0.05
_SMEAR_TOLERANCE = 0.5
"""Errors of a model of samples: of the shift, and square root of that of its variance. [periods]"""

_SHARE = (0.02, 0.05)
"""Errors of shift and smear that grow with them: no drive's filter is quite of first order."""

_STARTS = tuple((shift, smear) for shift in (0.0, 0.02, 0.06) for smear in (1e-6, 4e-4, 3e-3))
_STEPS = (5e-4, 2e-5, 5e-4)
"""Values of shift [s] and smear [s²] to start from, and steps of derivatives. [s], [s²], [s]"""

_OF_UNKNOWN_LOAD = 1 / 3
"""Share of the squared misfit of the starts that is left where a load is not known, as of a payload
that nobody told of. It takes a line over the angle for each start, which costs precision."""

_WIDEST = 0.05
"""Width of an interval of the shift that says nothing: hardly a drive is as late, and where starts
tell no more, something else happens at them. [s]"""

_CONFIDENT = 0.975
_NO_COLUMN = 1e-9


@dataclass(frozen=True, slots=True, kw_only=True)
class TorqueTiming:
    """When the logged torque is that of the logged motion.

    Attributes
    ----------
    shift : RampEstimate
        Mean time by which the torque is late, D: delay and filter together. [s]
    smear : RampEstimate
        Variance of that time, S: the square of the filter's time constant. [s²]
    rivals : TimingRivals
        What may be the reason: nothing, a delay, a filter, or both.
    rms : float
        RMS misfit of the starts. [N·m]
    starts : int
        Number of starts.
    period : float
        Sampling period. [s]
    """

    shift: RampEstimate
    smear: RampEstimate
    rivals: TimingRivals
    rms: float
    starts: int
    period: float

    @property
    def best(self) -> str:
        """The rival with the greatest evidence."""
        return self.rivals.best

    @property
    def delay(self) -> RampEstimate:
        """Delay over all rivals, each with its probability [s]."""
        return self.rivals.estimates()[0]

    @property
    def time_constant(self) -> RampEstimate:
        """Time constant of the filter likewise [s]."""
        return self.rivals.estimates()[1]

    def contradicts(self, shift: float, error: float) -> bool:
        """Return whether another estimate of the shift is of something else.

        Parameters
        ----------
        shift, error : float
            Shift by the segments at constant speed, and its standard error. [s]
        """
        own = (self.shift.high - self.shift.low) / 2
        reach = math.hypot(own, normal_quantile(_CONFIDENT) * error)
        return abs(shift - self.shift.value) > self.period + reach

    @property
    def log_odds(self) -> float:
        """Log odds of a filter, with or without a delay, against a delay alone, at most 12."""
        return float(np.clip(self.rivals.log_odds, -MAX_LOG_ODDS, MAX_LOG_ODDS))


def torque_timing(ramps: RampLog, problem: Problem, temperature: str) -> TorqueTiming | None:
    """Return delay and filter of the torque; None where the starts of moves do not show them.

    There may be too few, or something else may happen at them.

    Parameters
    ----------
    ramps : RampLog
        Ramps of the joint, with the samples around starts of moves.
    problem : Problem
        One joint's measurements and base model.
    temperature : {"motor", "housing", "mean"}
        Temperature that the friction function is given.
    """
    if ramps.starts is None:
        return None
    windows = StartWindows.of(ramps.starts, ramps.sign, problem, temperature)
    found = None if windows is None else timing_of(windows)
    return None if found is None or found.shift.high - found.shift.low > _WIDEST else found


def timing_of(windows: StartWindows) -> TorqueTiming:
    """Return delay and filter of the torque in the samples around starts of moves."""
    windows, weight, found = _with_loads(windows)
    misfit = _residual(windows, weight, found)
    point, covariance, freedom = _one_step(windows, weight, found)
    reach = -t_quantile(1 - _CONFIDENT, freedom)
    shift, smear = (
        RampEstimate(value, value - reach * error, value + reach * error)
        for value, error in zip(point[:2], np.sqrt(np.diag(covariance)), strict=False)
    )
    tolerance = np.array([_SHIFT_TOLERANCE, _SMEAR_TOLERANCE**2 * windows.period])
    tolerance = tolerance * windows.period + np.array(_SHARE) * np.abs(point[:2])
    # the normal distribution stands for Student's with as wide an interval
    wider = np.square(reach / -normal_quantile(1 - _CONFIDENT))
    rivals = TimingRivals(point[:2], wider * covariance[:2, :2] + np.diag(np.square(tolerance)))
    return TorqueTiming(
        shift=shift,
        smear=smear,
        rivals=rivals,
        rms=float(np.sqrt(np.sum(np.square(misfit)) / max(np.sum(np.square(weight)), 1))),
        starts=len(windows.torque),
        period=windows.period,
    )


def _with_loads(windows: StartWindows) -> tuple[StartWindows, Array, Array]:
    """Return windows with all loads known, unless others explain far more, and their best fit."""
    fits = []
    for one in (replace(windows, turned=None), windows):
        weight, found = _found(one)
        left = float(np.sum(np.square(_residual(one, weight, found))))
        fits.append((left, (one, weight, found)))
    (left, known), (left_beside, unknown) = fits
    return unknown if left_beside < _OF_UNKNOWN_LOAD * left else known


def _found(windows: StartWindows) -> tuple[Array, Array]:
    """Return the weights of samples, and shift, smear and lateness with the least misfit."""
    weight = windows.weights(0.0)
    first = min(
        (np.array([shift, smear, 0.0]) for shift, smear in _STARTS),
        key=lambda point: float(np.sum(np.square(_residual(windows, weight, point)))),
    )
    found = _fitted(windows, weight, first)
    # a late onset of friction looks like a smear of up to a sample
    smear_for_sure = max(found[1] - windows.period**2, 0.0)
    weight = windows.weights(found[0] - math.sqrt(smear_for_sure))
    return weight, _fitted(windows, weight, found)


def _fitted(windows: StartWindows, weight: Array, first: Array) -> Array:
    """Return shift [s], smear [s²] and lateness of friction [s] with the least misfit."""
    lowest = np.array([DELAYS[0], 0.0, -_LATENESS])
    highest = np.array([DELAYS[1] + LONGEST_FILTER, LONGEST_FILTER**2, _LATENESS])
    found = least_squares(
        lambda point: _residual(windows, weight, point).ravel(),
        np.clip(first, lowest + 1e-9, highest - 1e-9),
        bounds=(lowest, highest),
        x_scale=[0.01, 3e-4, 0.01],
        diff_step=1e-3,
        max_nfev=30,
    )
    return np.asarray(found.x)


def _residual(windows: StartWindows, weight: Array, point: Array) -> Array:
    """Return the misfit of the torque, less all linear columns, shape (starts, samples) [N·m]."""
    shift, smear, late = point
    time_constant = math.sqrt(max(smear, 0.0))
    delay = shift - time_constant

    def logged(signals: Sequence[Array], extra: float = 0.0) -> Array:
        shape = (len(signals), *windows.torque.shape)
        rows = np.concatenate(signals)
        delayed = responded(
            rows,
            windows.period,
            delay=delay + extra,
            time_constant=time_constant,
            stride=windows.stride,
        )
        return delayed.reshape(shape)

    turned = () if windows.turned is None else (windows.turned,)
    early = logged((windows.gravity, *turned, *windows.inertial))
    later = logged((windows.friction, *windows.frictional), late)
    basis: list[Array] = []
    lines = 1 + len(turned)
    for column in (np.ones_like(windows.torque), later[0], *early[1:lines]):
        rest = _without(column * weight, basis)
        size = np.sqrt(np.sum(np.square(rest), axis=1, keepdims=True))
        basis.append(np.divide(rest, size, out=np.zeros_like(rest), where=size > _NO_COLUMN))
    misfit = _without((windows.torque - early[0]) * weight, basis)
    common = _without(np.concatenate([early[lines:], later[1:]]) * weight, basis)
    columns = common.reshape(len(common), -1).T
    columns = columns / np.maximum(np.linalg.norm(columns, axis=0), _NO_COLUMN)
    orthogonal, triangle = np.linalg.qr(columns)
    coefficients = np.linalg.lstsq(triangle, orthogonal.T @ misfit.ravel(), rcond=1e-8)[0]
    return np.asarray(misfit - (columns @ coefficients).reshape(misfit.shape))


def _without(column: Array, basis: list[Array]) -> Array:
    """Return columns less their projections on a basis, start by start."""
    for one in basis:
        column = column - one * np.sum(one * column, axis=-1, keepdims=True)
    return column


def _one_step(windows: StartWindows, weight: Array, point: Array) -> tuple[Array, Array, int]:
    """Return the estimate after a step without bounds, its covariance, and degrees of freedom.

    Without its bound a smear that is not there comes out negative as often as positive.
    """
    misfit = _residual(windows, weight, point)
    slopes = []
    for place, step in enumerate(_STEPS):
        moved = point.copy()
        moved[place] += step
        slopes.append((_residual(windows, weight, moved) - misfit) / step)
    jacobian = np.stack(slopes, axis=2)
    scale = np.maximum(np.sqrt(np.sum(np.square(jacobian), axis=(0, 1))), _NO_COLUMN)
    jacobian /= scale
    inverse = np.linalg.pinv(np.einsum("ijk,ijl->kl", jacobian, jacobian), rcond=1e-10)
    scores = np.einsum("ijk,ij->ik", jacobian, misfit)
    clusterings: tuple[Labels, ...] = (np.arange(len(misfit)), windows.conditions)
    covariance = np.zeros_like(inverse)
    for labels in clusterings:
        count = int(labels.max()) + 1
        sums = np.column_stack([np.bincount(labels, score, count) for score in scores.T])
        covariance += count / max(count - 1, 1) * sums.T @ sums
    covariance = inverse @ covariance @ inverse / np.outer(scale, scale)
    freedom = max(min(int(labels.max()) for labels in clusterings), 1)
    return point - inverse @ scores.sum(axis=0) / scale, covariance, freedom
