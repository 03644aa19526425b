r"""Torque constant of a joint, from a motor current and a torque that are logged beside each other.

Friction cannot tell it: a controller may have freed the torque of friction, in part or whole, and a
sensor behind the gear does not see it. Both channels share the load. With :math:`\varphi` the
angle,

.. math::

    u = k i + c + \operatorname{sign}(\dot\varphi) f(\varphi, |\dot\varphi|)
    + \dot\varphi\, d(\varphi) + J \ddot\varphi + e

whose terms but the first say what only one of them has: an offset, friction, a delay of one against
the other (a derivative of the load), and the rotor's inertia. Both channels err, so :math:`k` comes
from instruments [1]_ that know the motion only: cosine and sine of the angle and its double. Where
no gravity acts, the acceleration takes their place.

References
----------
.. [1] J. D. Sargan, "The estimation of economic relationships using instrumental variables,"
   Econometrica 26(3), 1958, doi:10.2307/1907619.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Numbers
from frictioncli.errors import NotEnoughData
from frictioncli.logs.channels.shared_load import (
    GRAVITY,
    INERTIA,
    LEAST_ROWS,
    ChannelPair,
    SharedRun,
    delay_of_torque,
    rows_in_motion,
    shared_run,
)

_BLOCKS = 40
"""Most blocks of time that are left out in turn."""
_LEAST_BLOCKS = 6
_TURN = 2 * np.pi
_SECTOR_EDGES = np.arange(1, 12) / 12
"""Quantiles of the angle between the sectors that are left out in turn."""
_LEAST_SHARED = 0.9
"""Least share of the squared correlation of what both channels share."""
_LEAST_PART = 0.1
"""Least share of what the other terms leave of a channel that the shared part is."""
_VAGUE = 0.1
"""Half intervals above this share of the constant tell none."""


@dataclass(frozen=True, slots=True)
class ConstantEstimate:
    """A torque constant.

    Attributes
    ----------
    value : float
        Torque per current; negative where the current counts the other way. [N·m/A]
    ci95 : (float, float)
        Its 95 % interval. [N·m/A]
    shared : float
        Squared correlation of the parts that both channels share. [-]
    seen_by : str
        ``gravity`` or ``inertia``: what makes that part.
    rows : int
        Rows in motion.
    """

    value: float
    ci95: tuple[float, float]
    shared: float
    seen_by: str
    rows: int


@dataclass(frozen=True, slots=True)
class TorqueConstant:
    """Torque at the joint per motor current, and where it comes from.

    Attributes
    ----------
    value : float
        The constant. [N·m/A]
    ci95 : (float, float) or None
        Its 95 % interval; None where the user gave it. [N·m/A]
    reason : str
        Where it comes from.
    """

    value: float
    ci95: tuple[float, float] | None
    reason: str

    def text(self, joint: int, current: str) -> str:
        """Return the note on its use.

        Parameters
        ----------
        joint : int
            Number of the joint.
        current : str
            Name of the current's column.
        """
        interval = shared = ""
        if self.ci95 is not None:
            low, high = self.ci95
            interval = f" ({low:.4g} to {high:.4g})"
            shared = (
                "; all torque-like results share its error of"
                f" ±{(high - low) / 2 / abs(self.value):.1%}"
            )
        return (
            f"{current} is converted to N·m at joint {joint} by the torque constant"
            f" {self.value:.4g}{interval} N·m/A, {self.reason}{shared}"
        )

    def fact(self) -> dict[str, object]:
        """Return it for the metadata of tables."""
        return {
            "estimate": self.value,
            "ci95": None if self.ci95 is None else list(self.ci95),
            "unit": "N·m/A",
            "reason": self.reason,
        }


def estimate_constant(runs: Sequence[Sequence[ChannelPair]]) -> ConstantEstimate:
    """Return the torque constant from what a current and a torque share.

    Parameters
    ----------
    runs : sequence of sequence of ChannelPair
        Samples of one joint: the recordings of each run, which share a payload.

    Returns
    -------
    ConstantEstimate
        The constant; its interval is the widest of three: of a jackknife over blocks of time, of
        one over sectors of the angle, and the constants from either channel given the other.

    Raises
    ------
    NotEnoughData
        If the joint hardly moves, or the load of both channels does not tell a constant.

    Examples
    --------
    A gear of 12 N·m/A with 8 N·m of friction, which the torque channel does not see:

    >>> rng = np.random.default_rng(0)
    >>> time = np.arange(0, 60, 0.01)
    >>> angle = 50 * np.sin(0.7 * time)
    >>> load = 40 * np.cos(np.radians(angle + 30))
    >>> current = (load + 8 * np.sign(np.cos(0.7 * time))) / 12 + rng.normal(0, 0.1, len(time))
    >>> torque = load + rng.normal(0, 1, len(time))
    >>> found = estimate_constant([[ChannelPair(time, angle, current, torque)]])
    >>> round(found.value), found.ci95[0] < 12 < found.ci95[1]
    (12, True)
    """
    delay = delay_of_torque([one for run in runs for one in run])
    tables = [
        [part for one in run if (part := rows_in_motion(one, delay)) is not None] for run in runs
    ]
    kept = [parts for parts in tables if sum(map(len, parts)) >= LEAST_ROWS]
    if not kept:
        raise NotEnoughData("the joint hardly moves where current and torque are logged")
    reasons = []
    for seen_by in (GRAVITY, INERTIA):
        try:
            return _estimate(kept, seen_by)
        except NotEnoughData as why:
            reasons.append(str(why))
    raise NotEnoughData("; ".join(reasons))


def _estimate(tables: Sequence[Sequence[Array]], seen_by: str) -> ConstantEstimate:
    rows = sum(len(part) for parts in tables for part in parts)
    runs = [shared_run(parts, seen_by, max(rows // _BLOCKS, 1)) for parts in tables]
    found = [run.shared(run.table.T @ run.table) for run in runs]
    shared = np.sum([one for one, _ in found], axis=0)
    left = np.sum([one for _, one in found], axis=0)
    squares = np.diag(shared)
    part = squares / np.maximum(squares + np.diag(left), 1e-300)
    if part.min() < _LEAST_PART:
        raise NotEnoughData(
            f"{seen_by} explains only {max(part[0], 0):.0%} of the current without friction and"
            f" {max(part[1], 0):.0%} of the torque"
        )
    alike = float(shared[0, 1] ** 2 / squares.prod())
    if alike < _LEAST_SHARED:
        raise NotEnoughData(
            f"{seen_by} changes the current and the torque differently (squared"
            f" correlation {alike:.2f})"
        )
    # reading logs otherwise needs no scipy, which takes long to import
    from frictioncli.distributions import t_quantile

    # the current given the torque, and the torque given the current, err to either side
    value = _ratio(shared)
    half = [abs(value) * (1 / np.sqrt(alike) - 1)]
    edges = np.quantile(np.concatenate([run.angle for run in runs]) % _TURN, _SECTOR_EDGES)
    for changes in (
        _left_out(runs, found, shared, [run.block for run in runs]),
        _left_out(runs, found, shared, [np.searchsorted(edges, r.angle % _TURN) for r in runs]),
    ):
        if len(changes) < _LEAST_BLOCKS:
            raise NotEnoughData("too few moves for an interval")
        spread = (len(changes) - 1) * float(np.mean(np.square(changes - np.mean(changes))))
        half.append(t_quantile(0.975, len(changes) - 1) * float(np.sqrt(spread)))
    if max(half) > _VAGUE * abs(value):
        raise NotEnoughData(
            f"by {seen_by} {value:.3g} ± {max(half):.2g} N·m/A: not known well enough"
        )
    interval = (value - max(half), value + max(half))
    return ConstantEstimate(value, interval, alike, seen_by, rows)


def _ratio(shared: Array) -> float:
    """Return the torque per current of the shared parts, as if both err alike."""
    return float(np.sign(shared[0, 1]) * np.sqrt(shared[1, 1] / shared[0, 0]))


def _left_out(
    runs: Sequence[SharedRun],
    found: Sequence[tuple[Array, Array]],
    shared: Array,
    numbers: Sequence[Numbers],
) -> Array:
    """Return the constant with each block of each run left out, shape (blocks,)."""
    values = []
    for run, (own, _), number in zip(runs, found, numbers, strict=True):
        gram = run.table.T @ run.table
        for one in np.unique(number):
            part = run.table[number == one]
            without = shared - own + run.shared(gram - part.T @ part)[0]
            if np.diag(without).min() > 0:
                values.append(_ratio(without))
    return np.array(values)
