r"""Nonlinear least squares of equation (16) at a hidden temperature.

The friction of a pair is

.. math:: \tau = \tau_c + \alpha L^2 + (\beta + \gamma e^{-\delta (T + E)}) \sqrt v
    + \sum_k X_k c_k, \qquad E = \sum_j x_j(\theta)\, s_j

with the measured temperature *T*, the parts :math:`x_j` of the thermal network
(:class:`frictioncli.effects.thermal_lag.ThermalInputs`), their coefficients *s* within physical
bounds and sum of shares up to 1, and columns *X* of other effects. All but :math:`\theta`,
:math:`\delta` and *s* is linear and projected out (variable projection [1]_, with the Jacobian of
Kaufman [2]_). Temperature is the same in all angle bins of a pair, so that the nonlinear part acts
on pair means only; what the bins tell about the linear part is compressed into a few rows.

References
----------
.. [1] G. H. Golub and V. Pereyra, "The differentiation of pseudo-inverses and nonlinear least
   squares problems whose variables separate," SIAM J. Numer. Anal. 10(2), 1973,
   doi:10.1137/0710036.
.. [2] L. Kaufman, "A variable projection method for solving separable nonlinear least squares
   problems," BIT 15, 1975, doi:10.1007/BF01932995.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from frictioncli.arrays import Array, Flags
from frictioncli.diagnosis.thermal.pair_data import RANK, LinearPart, ThermalData
from frictioncli.effects.thermal_lag import EFFECT

LEAST_DELTA, GREATEST_DELTA = 1e-3, 0.3
"""Bounds of delta. [1/°C]"""

STARTS = (300.0, 1200.0, 4800.0)
"""Time constants from which the fit starts. [s]"""

_SHARES = tuple(i for i, one in enumerate(EFFECT.coefficients) if one.name.endswith("share"))
"""Places of the shares, whose sum is at most 1."""

_MOTOR = [one.name for one in EFFECT.coefficients].index("lag_share")
"""Place of the share of the friction at a gear that follows the motor."""

_HOUSING = [one.name for one in EFFECT.coefficients].index("housing_share")
"""Place of the share of the friction at the housing itself."""

_PENALTY = 1e3
"""Weight by which the sum of the shares is kept below 1."""

_STEP = 1e-4
"""Relative step of the derivative by the time constant."""

_MOST_STEPS = 40
"""Greatest number of steps of a fit from one start."""

_EDGE = 1e-3
"""A parameter nearer to a bound than this share of its range lies on it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class NonlinearFit:
    """Equation (16) fitted at a hidden temperature.

    Attributes
    ----------
    time_constant : float
        Time constant of the gear. [s]
    housing_time_constant : float or None
        Time constant of a housing that is not measured; none where it is no part. [s]
    coefficients : ndarray, shape (4,)
        Coefficients of the network's parts; 0 where a part is not in the structure.
    delta, gamma : float
        Delta and gamma of (16) at that temperature. [1/°C], [N·m/(deg/s)^0.5]
    linear : ndarray, shape (columns,)
        Coefficients of the linear columns.
    cost : float
        Sum of squared weighted residuals.
    residual : ndarray, shape (pairs,)
        Residual of the pair means. [N·m]
    derivative : ndarray, shape (pairs, parameters)
        Derivatives of the pair means: by the linear coefficients, gamma, delta, the logarithms of
        the time constants, and the free coefficients. [N·m per unit]
    names : tuple of str
        What the last columns of the derivative belong to, from delta on.
    inside : ndarray of bool, shape (names,)
        Which of these do not lie on a bound.
    """

    time_constant: float
    housing_time_constant: float | None
    coefficients: Array
    delta: float
    gamma: float
    linear: Array
    cost: float
    residual: Array
    derivative: Array
    names: tuple[str, ...]
    inside: Flags

    @property
    def design(self) -> Array:
        """Derivatives by the parameters that do not lie on a bound, shape (pairs, parameters)."""
        first = self.derivative.shape[1] - len(self.names)
        return self.derivative[:, np.append(np.ones(first, dtype=bool), self.inside)]


@dataclass(frozen=True, slots=True, kw_only=True)
class NetworkForm:
    """A thermal network, one of the rivals.

    Attributes
    ----------
    name : str
        ``measured``, ``housing``, ``mix``, ``one_node`` or ``two_nodes``.
    parts : tuple of int
        Which coefficients of the effect ``thermal_lag`` are free; the others are 0.
    times : int
        Number of time constants: of the gear, and of a housing that is not measured.
    at_housing : bool
        Whether all friction is at the temperature of the housing.
    whole : bool
        Whether all friction is at the gear: what does not follow the housing follows the motor.
    """

    name: str
    parts: tuple[int, ...] = ()
    times: int = 0
    at_housing: bool = False
    whole: bool = False

    @property
    def order(self) -> tuple[int, int]:
        """Number of time constants, and of all parameters: the simpler, the less."""
        return self.times, self.times + len(self.parts)


def fit_structure(data: ThermalData, structure: NetworkForm) -> NonlinearFit:
    """Fit (16) at the temperature of a structure, from a few time constants.

    Parameters
    ----------
    data : ThermalData
        The pairs.
    structure : NetworkForm
        The network.
    """
    projection = _Projection(data, structure, LinearPart.of(data))
    starts = STARTS if structure.times else STARTS[:1]
    return min((projection.fitted(start) for start in starts), key=lambda one: one.cost)


@dataclass(frozen=True, slots=True)
class _Projected:
    """The projected problem at one set of nonlinear parameters."""

    excess: Array
    falling: Array
    gamma: float
    residual: Array
    direction: Array


@dataclass(frozen=True, slots=True)
class _Projection:
    """Variable projection; parameters are delta, logarithms of time constants, coefficients."""

    data: ThermalData
    structure: NetworkForm
    linear: LinearPart

    def fitted(self, time_constant: float) -> NonlinearFit:
        """Return the fit from a starting time constant of the gear."""
        bounds = [(LEAST_DELTA, GREATEST_DELTA)]
        start = [float(np.clip(self.data.delta, 2 * LEAST_DELTA, GREATEST_DELTA / 2))]
        axis, times = EFFECT.shape[0], self.structure.times
        bounds += times * [(np.log(axis.lower), np.log(axis.upper))]
        start += [np.log(time_constant), np.log(2 * time_constant)][:times]
        for part in self.structure.parts:
            coefficient = EFFECT.coefficients[part]
            bounds.append((coefficient.lower, coefficient.upper))
            start.append(coefficient.lower + 0.2 * (coefficient.upper - coefficient.lower))
        low, high = np.array(bounds).T
        latest: list[tuple[Array, _Projected]] = []

        def at(x: Array) -> _Projected:
            if not latest or not np.array_equal(latest[0][0], x):
                latest[:] = [(x.copy(), self._at(x))]
            return latest[0][1]

        search = least_squares(
            lambda x: at(x).residual,
            start,
            jac=lambda x: self._jacobian(x, at(x)),
            bounds=(low, high),
            x_scale=np.append(0.02, (high - low)[1:] / 5),
            ftol=1e-8,
            xtol=1e-6,
            max_nfev=_MOST_STEPS,
        )
        return self._result(search.x, low, high)

    def _split(self, x: Array) -> tuple[float, list[float], Array]:
        """Return delta, the time constants and all coefficients."""
        first = 1 + self.structure.times
        coefficients = np.zeros(len(EFFECT.coefficients))
        coefficients[_HOUSING] = float(self.structure.at_housing)
        coefficients[list(self.structure.parts)] = x[first:]
        if self.structure.whole:
            coefficients[_MOTOR] = 1.0 - np.sum(coefficients[list(_SHARES)])
        return float(x[0]), [float(value) for value in np.exp(x[1:first])], coefficients

    def _excess(self, times: Sequence[float]) -> Array:
        first, second = [*times, None, None][:2]
        return self.data.excess(EFFECT.shape[0].lower if first is None else first, second)

    def _over(self, coefficients: Array) -> float:
        """Return by how much the shares together exceed 1."""
        return max(float(np.sum(coefficients[list(_SHARES)])) - 1.0, 0.0)

    def _at(self, x: Array) -> _Projected:
        data = self.data
        delta, times, coefficients = self._split(x)
        excess = self._excess(times)
        temperature = data.inputs.base[data.pairs] + excess @ coefficients
        falling = data.root_speed * np.exp(-delta * temperature)
        basis, left = self.linear.basis, self.linear.left
        column = self.linear.weighted(falling)
        beyond = column - basis @ (basis.T @ column)
        size = float(np.linalg.norm(beyond))
        if size <= RANK * float(np.linalg.norm(column)):
            size = np.inf
        direction = beyond / size
        along = float(direction @ left)
        residual = np.append(left - along * direction, _PENALTY * self._over(coefficients))
        return _Projected(excess, falling, along / size, residual, direction)

    def _directions(self, x: Array, point: _Projected) -> Array:
        """Return the derivatives of the pair means by the nonlinear parameters [N·m]."""
        data = self.data
        delta, times, coefficients = self._split(x)
        viscous = point.gamma * point.falling
        temperature = data.inputs.base[data.pairs] + point.excess @ coefficients
        columns = [-temperature * viscous]
        for number in range(len(times)):
            moved = [value * (1 + _STEP * (i == number)) for i, value in enumerate(times)]
            change = (self._excess(moved) - point.excess) @ coefficients / np.log1p(_STEP)
            columns.append(-delta * viscous * change)
        for part in self.structure.parts:
            column = point.excess[:, part]
            if self.structure.whole and part in _SHARES:
                column = column - point.excess[:, _MOTOR]
            columns.append(-delta * viscous * column)
        return np.column_stack(columns)

    def _jacobian(self, x: Array, point: _Projected) -> Array:
        directions = self._directions(x, point)
        whole = np.column_stack([self.linear.weighted(one) for one in directions.T])
        projected = whole - self.linear.basis @ (self.linear.basis.T @ whole)
        projected -= np.outer(point.direction, point.direction @ projected)
        over = np.zeros(directions.shape[1])
        if self._over(self._split(x)[2]) > 0:
            first = 1 + self.structure.times
            for place, part in enumerate(self.structure.parts, start=first):
                over[place] = _PENALTY * (part in _SHARES)
        return np.vstack([-projected, over])

    def _result(self, x: Array, low: Array, high: Array) -> NonlinearFit:
        point, data = self._at(x), self.data
        delta, times, coefficients = self._split(x)
        names = ["delta", *("time_constant", "housing_time_constant")[: len(times)]]
        names += [EFFECT.coefficients[part].name for part in self.structure.parts]
        edge = _EDGE * (high - low)
        inside = (x - low > edge) & (high - x > edge)
        inside[0] = True
        directions = self._directions(x, point)
        on_bound = np.where(x - low <= edge, low, np.where(high - x <= edge, high, x))
        coefficients = self._split(on_bound)[2]
        return NonlinearFit(
            time_constant=times[0] if times else EFFECT.shape[0].lower,
            housing_time_constant=times[1] if len(times) > 1 else None,
            coefficients=coefficients,
            delta=delta,
            gamma=point.gamma,
            linear=self.linear.beside(point.gamma * point.falling),
            cost=float(point.residual @ point.residual),
            residual=point.residual[: len(data.target)] * data.deviation,
            derivative=np.column_stack([data.linear, point.falling, directions]),
            names=tuple(names),
            inside=inside,
        )
