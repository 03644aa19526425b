"""What the numbers of a log say about the units of its time, position and velocity.

Positions, velocities and times are checked against each other and against what a joint can do;
each function returns what it believes and the evidence for it.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.logs.channels.units import FACTORS

_TURN = 180.0 / np.pi
_LIMIT = 2 * np.pi
_MARGIN = 1.1
RADIAN_LIMIT = _LIMIT * _MARGIN
"""A joint with end stops does not turn further than this. [rad]"""
_COUPLED = 0.02
"""Positions whose ratio varies by more than this share are not those of one gear."""
_RAW = 0.5
"""Velocities are rather in a usual unit and time in ms than raw values without their scale."""
_LEVER = (0.02, 5.0)  # [m]
_WILD = 1e6


@dataclass(frozen=True, slots=True)
class MotionEvidence:
    """Raw samples of one axis in one file, for finding units; velocity empty where none.

    ``time`` in the raw unit, shape (n,); ``position`` and ``velocity`` raw, shape (n,).
    """

    time: Array
    position: Array
    velocity: Array


def motion_ratio(motions: list[MotionEvidence]) -> float | None:
    """Return the median ratio of position change to the integral of velocity, in raw units.

    Robust: windows of about 0.1 s or ten samples in which the axis moves, median over all of them;
    None when nothing moves or the ratios disagree by more than a third.
    """
    ratios = [_window_ratios(motion) for motion in motions if len(motion.time) >= 3]
    pooled = np.concatenate(ratios) if ratios else np.empty(0)
    if len(pooled) < 3:
        return None
    median = float(np.median(pooled))
    spread = float(np.median(np.abs(pooled - median)))
    return median if median != 0 and spread < abs(median) / 3 else None


def _window_ratios(motion: MotionEvidence) -> Array:
    if len(motion.velocity) != len(motion.time):
        return np.empty(0)
    # one damaged cell must not be the only place that moves
    speed = np.abs(motion.velocity)
    usual = speed <= _WILD * (float(np.quantile(speed, 0.95)) or np.inf)
    if not usual.all():
        motion = MotionEvidence(motion.time[usual], motion.position[usual], motion.velocity[usual])
    steps = np.diff(motion.time)
    if not np.any(steps > 0):
        return np.empty(0)
    area = steps * (motion.velocity[1:] + motion.velocity[:-1]) / 2
    travelled = np.concatenate(([0.0], np.cumsum(area)))
    period = float(np.median(steps))
    width = 1 if len(steps) < 200 else 8
    by_velocity = travelled[width:] - travelled[:-width]
    by_position = motion.position[width:] - motion.position[:-width]
    elapsed = motion.time[width:] - motion.time[:-width]
    even = (elapsed > 0) & (elapsed < 2 * width * period)
    moving = np.abs(by_velocity) > 0.3 * np.max(np.abs(by_velocity), initial=0.0)
    return by_position[even & moving] / by_velocity[even & moving]


def position_range(motions: list[MotionEvidence]) -> tuple[float, float]:
    """Return the greatest distance from zero and the greatest span within a file, in raw units.

    A thousandth of the samples on either side does not count, so that damaged cells do not, nor
    does what lies a million times further from zero than most: an axis at rest at zero has no scale
    of its own.
    """
    furthest = span = 0.0
    moved = [motion for motion in motions if len(motion.position)]
    usual = (float(np.quantile(np.abs(motion.position), 0.95)) for motion in moved)
    most = max(usual, default=0.0) or np.inf
    for motion in moved:
        position = motion.position[np.abs(motion.position) <= _WILD * most]
        n = len(position)
        if not n:
            continue
        damaged = int(np.ceil(n / 1000)) if n >= 50 else 0
        ordered = np.sort(position)[damaged : n - damaged]
        furthest = max(furthest, float(np.max(np.abs(ordered))))
        span = max(span, float(ordered[-1] - ordered[0]))
    return furthest, span


def lever(tool: Array, axes: Array) -> float | None:
    """Return the median way of the tool per turn of the fastest axis [mm per raw unit].

    Parameters
    ----------
    tool : ndarray, shape (n, 3)
        Tool position. [mm]
    axes : ndarray, shape (n, m)
        Axis positions, raw.
    """
    if len(tool) < 10:
        return None
    way = np.linalg.norm(np.diff(tool, axis=0), axis=1)
    turn = np.max(np.abs(np.diff(axes, axis=0)), axis=1)
    moving = turn > 0.2 * np.quantile(turn, 0.98)
    if not np.any(moving & (turn > 0)):
        return None
    return float(np.median(way[moving] / turn[moving]))


def possible_position_units(
    *, furthest: float, span: float, on_motor: bool, way_per_turn: float | None
) -> tuple[frozenset[str], str]:
    """Return the units that positions can be in, and why.

    Parameters
    ----------
    furthest, span : float
        Greatest distance from zero and span. [raw]
    on_motor : bool
        A motor turns without limit.
    way_per_turn : float or None
        Result of :func:`lever`.
    """
    if furthest > 1e6 or (furthest > 1e5 and not on_motor):
        return frozenset({"udeg"}), f"values reach {furthest:.3g}"
    if on_motor:
        return frozenset({"deg", "rad"}), ""
    if furthest > RADIAN_LIMIT:
        return frozenset({"deg"}), f"values reach ±{furthest:.4g}, beyond a turn in rad"
    levers = _units_by_lever(way_per_turn) if way_per_turn is not None else frozenset()
    if len(levers) == 1 and way_per_turn is not None:
        metres = way_per_turn / 1000 * (_TURN if "deg" in levers else 1.0)
        return levers, f"the tool then moves on a lever of {metres:.2g} m"
    if span > 0.01:
        return frozenset({"rad"}), f"values span {span:.2g} and stay within ±6.3"
    return frozenset({"deg", "rad"}), "it does not move"


def _units_by_lever(way_per_turn: float) -> frozenset[str]:
    metres = {"rad": way_per_turn / 1000, "deg": way_per_turn / 1000 * _TURN}
    return frozenset(unit for unit, size in metres.items() if _LEVER[0] <= size <= _LEVER[1])


@dataclass(frozen=True, slots=True)
class MotionUnits:
    """Units of time, position and velocity that fit together.

    ``velocity`` is None where none fits; ``reversed_velocity`` where it runs against position.
    ``evidence`` tells what was measured.
    """

    time: str
    position: str
    velocity: str | None
    reversed_velocity: bool
    evidence: str


def motion_units(
    *,
    declared: tuple[str | None, str | None, str | None],
    possible: frozenset[str],
    ratio: float | None,
) -> MotionUnits:
    """Choose the units that agree with the measurements and differ least from the header.

    Parameters
    ----------
    declared : tuple of str or None
        Units of time, position and velocity by the header.
    possible : frozenset of str
        Position units that the values allow.
    ratio : float or None
        Result of :func:`motion_ratio`; None where velocity says nothing.
    """
    time, position, velocity = declared
    positions = sorted(possible, key=lambda unit: (unit != position, unit))
    if ratio is None:
        assumed = velocity or ("rad/s" if positions[0] == "rad" else "deg/s")
        return MotionUnits(time or "s", positions[0], assumed, False, "")
    best: tuple[float, MotionUnits] | None = None
    for time_unit in ("s", "ms", "us"):
        for position_unit in positions:
            for velocity_unit, velocity_factor in FACTORS["velocity"].items():
                expected = (
                    velocity_factor
                    * FACTORS["time"][time_unit]
                    / FACTORS["position"][position_unit]
                )
                if not 0.9 < abs(ratio) / expected < 1.1:
                    continue
                cost = (
                    2.0 * _differs(time_unit, time, "s")
                    + _differs(position_unit, position, "deg")
                    + _differs(velocity_unit, velocity, "deg/s")
                    + _RAW * (velocity_unit == "mdeg/s" and velocity != "mdeg/s")
                )
                found = MotionUnits(
                    time_unit,
                    position_unit,
                    velocity_unit,
                    ratio < 0,
                    f"position changes by {ratio:.4g} per integrated velocity",
                )
                if best is None or cost < best[0]:
                    best = (cost, found)
    if best is not None:
        return best[1]
    return MotionUnits(
        time or "s",
        positions[0],
        None,
        False,
        f"position changes by {ratio:.4g} per integrated velocity, which no units explain",
    )


def _differs(unit: str, declared: str | None, usual: str) -> float:
    if declared is None:
        return 0.0 if unit == usual else 0.25
    return 0.0 if unit == declared else 1.0


def gear_ratio(motor: Array, joint: Array) -> float | None:
    """Return motor turn per joint turn from both positions.

    None when too little moves, or the two do not move together.

    Parameters
    ----------
    motor, joint : ndarray, shape (n,)
        Positions in the same unit; rows where one is NaN are left out.
    """
    good = np.isfinite(motor) & np.isfinite(joint)
    motor, joint = motor[good], joint[good]
    if len(joint) < 20 or np.ptp(joint) < 1.0:
        return None
    width = max(1, len(joint) // 200)
    by_motor, by_joint = motor[width:] - motor[:-width], joint[width:] - joint[:-width]
    moving = np.abs(by_joint) > 0.3 * np.max(np.abs(by_joint))
    ratios = by_motor[moving] / by_joint[moving]
    ratio = float(np.median(ratios))
    spread = float(np.median(np.abs(ratios - ratio)))
    return ratio if spread < _COUPLED * abs(ratio) else None


def gear_offset(pairs: Sequence[tuple[Array, Array]], ratio: float) -> float:
    """Return the joint's position where the motor's is 0 [deg], median over all samples.

    Parameters
    ----------
    pairs : sequence of (ndarray, ndarray)
        Positions of the motor and of the joint, per log. [deg]
    ratio : float
        Motor turn per joint turn.
    """
    left = np.concatenate([joint - motor / ratio for motor, joint in pairs])
    left = left[np.isfinite(left)]
    return float(np.median(left)) if len(left) else 0.0
