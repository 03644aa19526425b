"""Units of positions by their values: the range of motion of a joint, and the path of the tool."""

from collections.abc import Collection, Sequence

import numpy as np

from frictioncli.arrays import Array
from frictioncli.logs.channels.unit_evidence import OUTLIER_FACTOR, RawMotion

_DEGREES_PER_RADIAN = 180.0 / np.pi
_LIMIT = 2 * np.pi
_MARGIN = 1.1
_MIT_RANGE = 12.5
"""Range of positions in the CAN protocol of the MIT Mini Cheetah and of many motors since. [rad]"""
RADIAN_LIMIT = _LIMIT * _MARGIN
"""Largest absolute position of a joint with end stops. [rad]"""
_LEAST_SPAN = 0.01
"""Range of positions above which an axis moves. [raw]"""
_LEVER_ARM = (0.02, 5.0)
"""Range of the tool's distance from an axis. [m]"""


def position_range(motions: list[RawMotion]) -> tuple[float, float]:
    """Return the largest absolute position and the largest position range within a file.

    The extreme thousandth of the samples on either side is left out, as it may be damaged. So are
    values a million times larger than most; the reference is the largest 95 % quantile of all
    files, as that of an axis at rest at zero would be zero.

    Parameters
    ----------
    motions : list of RawMotion
        The axis in each file.

    Returns
    -------
    largest, span : float
        Both 0 where there are no samples. [raw]

    Examples
    --------
    >>> position_range([RawMotion(np.arange(3.0), np.array([-10.0, 5.0, 20.0]), np.empty(0))])
    (20.0, 30.0)
    """
    largest = span = 0.0
    filled = [motion for motion in motions if len(motion.position)]
    usual = (float(np.quantile(np.abs(motion.position), 0.95)) for motion in filled)
    reference = max(usual, default=0.0) or np.inf
    for motion in filled:
        position = motion.position[np.abs(motion.position) <= OUTLIER_FACTOR * reference]
        n = len(position)
        if not n:
            continue
        trimmed = int(np.ceil(n / 1000)) if n >= 50 else 0
        ordered = np.sort(position)[trimmed : n - trimmed]
        largest = max(largest, float(np.max(np.abs(ordered))))
        span = max(span, float(ordered[-1] - ordered[0]))
    return largest, span


def tool_path_per_angle(tool: Array, axes: Array) -> float | None:
    """Return the median path of the tool per angle of the fastest axis: its lever arm.

    Parameters
    ----------
    tool : ndarray, shape (n, 3)
        Tool position. [raw]
    axes : ndarray, shape (n, axes)
        Axis positions. [raw]

    Returns
    -------
    float or None
        None where nothing moves; the lever arm if positions are in rad. [raw]

    Examples
    --------
    >>> angle = np.linspace(0, 1, 50)
    >>> tool = 400 * np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    >>> round(tool_path_per_angle(tool, angle[:, None]), 1)
    400.0
    """
    if len(tool) < 10:
        return None
    path = np.linalg.norm(np.diff(tool, axis=0), axis=1)
    angle = np.max(np.abs(np.diff(axes, axis=0)), axis=1)
    moving = angle > 0.2 * np.quantile(angle, 0.98)
    if not np.any(moving & (angle > 0)):
        return None
    return float(np.median(path[moving] / angle[moving]))


def possible_position_units(
    *, largest: float, span: float, on_motor: bool, paths_per_angle: Collection[float]
) -> tuple[frozenset[str], str]:
    """Return the units that positions can be in, and why.

    Parameters
    ----------
    largest, span : float
        Largest absolute position and position range. [raw]
    on_motor : bool
        Whether it is the position of the motor, which turns without limit.
    paths_per_angle : collection of float
        Path of the tool per angle in each unit that it may be logged in; empty where it is not
        known. [mm/raw]

    Examples
    --------
    >>> units, why = possible_position_units(
    ...     largest=170, span=300, on_motor=False, paths_per_angle=()
    ... )
    >>> sorted(units), why
    (['deg'], 'values reach ±170, beyond a turn in rad')
    """
    if largest > 1e6 or (largest > 1e5 and not on_motor):
        return frozenset({"udeg"}), f"values reach {largest:.3g}"
    if on_motor:
        return frozenset({"deg", "rad"}), ""
    if largest > RADIAN_LIMIT:
        return frozenset({"deg"}), f"values reach ±{largest:.4g}, beyond a turn in rad"
    # a tool near the axis of a joint in rad moves as little per angle as one far off does in deg
    levers = [path / 1000 for path in paths_per_angle if _may_be_lever(path / 1000)]
    if levers and not any(
        _may_be_lever(path / 1000 * _DEGREES_PER_RADIAN) for path in paths_per_angle
    ):
        return frozenset({"rad"}), f"the tool then moves on a lever of {levers[0]:.2g} m"
    if span > _LEAST_SPAN:
        return frozenset({"deg", "rad"}), f"values span {span:.2g} and stay within ±6.3"
    return frozenset({"deg", "rad"}), "it does not move"


def _may_be_lever(arm: float) -> bool:
    return _LEVER_ARM[0] <= arm <= _LEVER_ARM[1]


def usual_position_unit(*, largest: float, span: float, on_motor: bool) -> str:
    """Return the unit of positions of which nothing else is known.

    A joint that moves within ±6.9 is logged in rad more often than it turns by a few degrees only.

    Parameters
    ----------
    largest, span : float
        Largest absolute position and position range. [raw]
    on_motor : bool
        Whether it is the position of the motor.

    Examples
    --------
    >>> usual_position_unit(largest=3.1, span=4.0, on_motor=False)
    'rad'
    """
    in_turn = not on_motor and largest <= RADIAN_LIMIT
    return "rad" if in_turn and span > _LEAST_SPAN else "deg"


def are_whole(positions: Sequence[Array]) -> bool:
    """Return whether positions are whole numbers only, as counts of an encoder are.

    Parameters
    ----------
    positions : sequence of ndarray, shape (n,)
        Positions of each log. [raw]

    Examples
    --------
    >>> are_whole([np.array([2048.0, 2050.0])]), are_whole([np.array([12.0, 12.5])])
    (True, False)
    """
    return any(len(one) for one in positions) and all(
        bool(np.all(one == np.round(one))) for one in positions
    )


def wraps_as_of_mit_protocol(positions: Sequence[Array]) -> bool:
    """Return whether a position jumps between the ends of ±12.5, the range of the MIT protocol.

    Parameters
    ----------
    positions : sequence of ndarray, shape (n,)
        Positions of each log. [raw]

    Examples
    --------
    >>> turned = (np.linspace(0, 100, 500) + 12.5) % 25 - 12.5
    >>> wraps_as_of_mit_protocol([turned]), wraps_as_of_mit_protocol([np.linspace(-12.5, 12.5, 9)])
    (True, False)
    """
    largest = max((float(np.max(np.abs(one), initial=0.0)) for one in positions), default=0.0)
    jump = max((float(np.max(np.abs(np.diff(one)), initial=0.0)) for one in positions), default=0.0)
    return _MIT_RANGE - 0.2 < largest <= _MIT_RANGE + 0.01 and jump > 1.8 * _MIT_RANGE
