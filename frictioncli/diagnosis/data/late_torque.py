r"""Effects as a log shows them whose torque belongs to an earlier moment than its position.

Behind a delay and a filter the torque that stands beside the angle *q* of a move with velocity
:math:`\sigma v` is the mean of the torques at :math:`q - \sigma v t` over the times *t* that the
response remembers, with mean *D* and variance *S*. An effect that adds
:math:`\sigma\varphi(q) + \lambda(q)` shows in the separated torques as

.. math::
    \Delta\tau(q) = \sum_k w_k \left[\frac{\varphi(q - v t_k) + \varphi(q + v t_k)}{2}
        + \frac{\lambda(q - v t_k) - \lambda(q + v t_k)}{2}\right], \quad
    \Delta L(q) = \sum_k w_k \left[\frac{\lambda(q - v t_k) + \lambda(q + v t_k)}{2}
        + \frac{\varphi(q - v t_k) - \varphi(q + v t_k)}{2}\right]

with nodes :math:`t_k` and weights :math:`w_k` of the Gauss rule of two points for a delay and an
exponential response, which are exact up to the third moment. Columns that are sines and cosines of
*N* times the angle have the exact response instead,

.. math::
    H = \frac{e^{-i \omega (D - \theta)}}{1 + i \omega \theta}, \quad \omega = N v, \quad
    \theta = \sqrt{S}:

its real part is what each is multiplied by, and its imaginary part what it adds of the other to the
other channel. A fast ripple hardly passes a filter. The base model needs none of this: gravity
varies so slowly with the angle that the effects ``torque_delay`` and ``torque_filter``, the moments
of the response, are enough.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from frictioncli.arrays import Array, ComplexArray, Indices
from frictioncli.effects.base import Basis, Effect, EffectTable

_ROOT2 = math.sqrt(2.0)
_NODES = (2.0 - _ROOT2, 2.0 + _ROOT2)
_WEIGHTS = ((2.0 + _ROOT2) / 4.0, (2.0 - _ROOT2) / 4.0)
"""Gauss-Laguerre rule of two points."""

_MOVING = frozenset({"angle", "load", "load_slope", "friction"})
"""Columns of the table that change along a move."""

_ALL = slice(None)
"""All rows."""

EarlierTables = dict[float, EffectTable]
"""Tables at the angles of a forward move so long before, of a reverse move after. [s]"""


@dataclass(frozen=True, slots=True, kw_only=True)
class LateTorque:
    """Response behind which the torque was logged.

    Attributes
    ----------
    delay : float
        Mean time by which the torque is late. [s]
    variance : float
        Variance of that time: the square of the filter's time constant. [s²]
    """

    delay: float
    variance: float = 0.0

    def nodes(self) -> tuple[tuple[float, float], ...]:
        """Return weights [-] and times [s] of what the log remembers.

        Examples
        --------
        >>> nodes = LateTorque(delay=0.05, variance=0.0016).nodes()
        >>> round(sum(weight * time for weight, time in nodes), 9)
        0.05
        """
        if self.variance <= 0.0:
            return ((1.0, self.delay),)
        time_constant = math.sqrt(self.variance)
        begin = self.delay - time_constant
        return tuple(
            (weight, begin + time_constant * node)
            for weight, node in zip(_WEIGHTS, _NODES, strict=True)
        )

    def response(self, frequency: Array) -> ComplexArray:
        """Return the frequency response, shape of the frequencies [-].

        Parameters
        ----------
        frequency : ndarray
            Angular frequencies. [rad/s]
        """
        time_constant = math.sqrt(max(self.variance, 0.0))
        turned = np.exp(-1j * frequency * (self.delay - time_constant))
        return np.asarray(turned / (1.0 + 1j * frequency * time_constant))


def late_basis(
    effect: Effect,
    table: EffectTable,
    shape: Mapping[str, float],
    late: LateTorque,
    *,
    rows: slice | Indices = _ALL,
    counted: float,
    alpha: float,
    separate_load: bool,
    known: EarlierTables | None = None,
) -> Basis:
    """Return the columns of an effect of the joint in separated torques that are late.

    Parameters
    ----------
    effect : Effect
        An effect that is no property of the measurement.
    table : EffectTable
        Pairs and angle bins.
    shape : mapping of str to float
        Its shape parameters.
    late : LateTorque
        Response behind which the torque was logged.
    rows : slice or ndarray of int, optional
        Rows of the table that the columns are for.
    counted : float
        Sign convention of the torques: +1 where forward is load plus friction, else -1.
    alpha : float
        Coefficient of the squared load in friction. [1/(N·m)]
    separate_load : bool
        Whether the load was measured apart, and is not late with the torque.
    known : dict, optional
        Tables at earlier moments, by time: those of earlier calls are used, new ones added.
    """
    known = {} if known is None else known
    if _MOVING.isdisjoint((*effect.needs, *effect.uses)):
        there = effect.evaluate(table, shape)
        return Basis(there.friction[rows], there.load[rows])
    if effect.orders is not None:
        there = effect.evaluate(table, shape)
        there = Basis(there.friction[rows], there.load[rows])
        speed = np.radians(table.speed[rows])
        response = late.response(np.outer(speed, effect.orders(**shape)))
        return _of_harmonics(there, response, 0.0 if separate_load else counted)
    friction: Array | float = 0.0
    load: Array | float = 0.0
    for weight, time in late.nodes():
        for moment in (time, -time):
            if moment not in known:
                known[moment] = _earlier(table, moment, counted, alpha, separate_load)
        forward, reverse = (effect.evaluate(known[way], shape) for way in (time, -time))
        size = forward.friction[rows].shape
        (friction_mean, friction_change), (load_mean, load_change) = (
            _mean_and_half_change(one[rows], two[rows])
            for one, two in zip(forward, reverse, strict=True)
        )
        friction = friction + weight * friction_mean
        load = load + weight * load_mean
        if not separate_load:
            friction = friction + counted * weight * load_change
            load = load + counted * weight * friction_change
    return Basis(*(np.broadcast_to(one, size) for one in (friction, load)))


def _of_harmonics(there: Basis, response: ComplexArray, counted: float) -> Basis:
    """Return sines and cosines behind a response, shape (rows, orders), in both channels."""

    def mean_and_half_change(columns: Array) -> tuple[Array, Array]:
        mean, change = np.empty_like(columns), np.empty_like(columns)
        for first, way in ((0, 1.0), (1, -1.0)):
            mean[:, first::2] = response.real * columns[:, first::2]
            change[:, first::2] = way * response.imag * columns[:, 1 - first :: 2]
        return mean, change

    (friction, of_friction), (load, of_load) = map(mean_and_half_change, there)
    return Basis(friction + counted * of_load, load + counted * of_friction)


def _mean_and_half_change(
    forward: Array, reverse: Array
) -> tuple[Array, Array] | tuple[float, float]:
    """Return half the sum and half the difference of columns; 0 where all are zero."""
    if not (forward.any() or reverse.any()):
        return 0.0, 0.0
    return (forward + reverse) / 2, (forward - reverse) / 2


def _earlier(
    table: EffectTable, time: float, counted: float, alpha: float, separate_load: bool
) -> EffectTable:
    """Return a table at the angles of a forward move that long before, of a reverse move after."""
    way = table.speed * time
    moved = replace(table, angle=table.position - way)
    if separate_load:
        return moved
    # gravity is a sine of the angle beside a constant
    turn = np.radians(way)
    gradient, curvature = counted * table.load_gradient, table.load_curvature
    change = np.degrees(1.0) ** 2 * curvature * (1.0 - np.cos(turn))
    change -= np.degrees(1.0) * gradient * np.sin(turn)
    load = table.load + change
    return replace(
        moved,
        load=load,
        load_slope=table.load_slope + 2 * alpha * change,
        friction=table.friction + alpha * (np.square(load) - np.square(table.load)),
    )
