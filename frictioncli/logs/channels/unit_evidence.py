"""Units of time, position and velocity: the change of position against the integral of velocity."""

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from frictioncli.arrays import Array, Flags
from frictioncli.logs.channels.units import FACTORS, ONLY_WRITTEN

_SHORTEST = 2e-5
"""Shortest period of logs from row to row. [s]"""
_UNSCALED_COST = 0.5
"""Cost of velocity in mdeg/s, that is without scale; velocity in deg/s with time in ms is
preferred."""
OUTLIER_FACTOR = 1e6
"""A value so many times larger than the 95 % quantile of absolute values is damaged."""

_SPIKE_FACTOR = 10
"""A velocity so many times larger than those before and after it, and than usual, is damaged."""


@dataclass(frozen=True, slots=True)
class RawMotion:
    """Raw samples of one axis in one file.

    Attributes
    ----------
    time, position : ndarray, shape (n,)
        Time and position. [raw]
    velocity : ndarray, shape (n,) or (0,)
        Velocity, empty where the file has none. [raw]
    """

    time: Array
    position: Array
    velocity: Array


def motion_ratio(motions: list[RawMotion]) -> float | None:
    """Return the median ratio of the change of position to the integral of velocity.

    The ratio is taken over windows of eight samples (one sample in short files) in which the axis
    moves.

    Parameters
    ----------
    motions : list of RawMotion
        The axis in each file.

    Returns
    -------
    float or None
        None where nothing moves, or where the median absolute deviation of the ratios exceeds a
        third of their median. [raw position / (raw velocity · raw time)]

    Examples
    --------
    >>> time = np.linspace(0, 10, 101)
    >>> position = np.degrees(np.sin(time))
    >>> velocity = np.cos(time)  # [rad/s]
    >>> round(motion_ratio([RawMotion(time, position, velocity)]), 1)
    57.3
    """
    ratios = [_window_ratios(motion) for motion in motions if len(motion.time) >= 3]
    pooled = np.concatenate(ratios) if ratios else np.empty(0)
    if len(pooled) < 3:
        return None
    median = float(np.median(pooled))
    spread = float(np.median(np.abs(pooled - median)))
    return median if median != 0 and spread < abs(median) / 3 else None


def isolated(values: Array, factor: float) -> Flags:
    """Return which values are many times larger than those before and after, and than most others.

    Parameters
    ----------
    values : ndarray, shape (n,)
        A channel without NaN.
    factor : float
        How many times. [-]

    Returns
    -------
    ndarray of bool, shape (n,)

    Examples
    --------
    >>> isolated(np.array([0.0, 1.0, 2.0, 1e4, -2.0, -1.0]), 10)
    array([False, False, False,  True, False, False])
    """
    size = np.abs(values)
    if len(size) < 3:
        return np.zeros(len(size), bool)
    beside = np.maximum(np.append(size[1], size[:-1]), np.append(size[1:], size[-2]))
    return np.asarray(size / factor > np.maximum(np.quantile(size, 0.8), beside))


def _window_ratios(motion: RawMotion) -> Array:
    if len(motion.velocity) != len(motion.time):
        return np.empty(0)
    # a single damaged value must not raise the threshold of motion for all others
    speed = np.abs(motion.velocity)
    usual = speed / OUTLIER_FACTOR <= (float(np.quantile(speed, 0.95)) or np.inf)
    usual &= ~isolated(speed, _SPIKE_FACTOR)
    if not usual.all():
        motion = RawMotion(motion.time[usual], motion.position[usual], motion.velocity[usual])
    steps = np.diff(motion.time)
    if not np.any(steps > 0):
        return np.empty(0)
    period = float(np.median(steps))
    width = 1 if len(steps) < 200 else 8
    if len(steps) < width:
        return np.empty(0)
    with np.errstate(over="ignore", invalid="ignore"):  # damaged values are left out below
        increments = steps * (motion.velocity[1:] + motion.velocity[:-1]) / 2
        # a sum of its own for each window: a damaged time would cost all later ones their digits
        by_velocity = sliding_window_view(increments, width).sum(axis=1)
        by_position = motion.position[width:] - motion.position[:-width]
        elapsed = motion.time[width:] - motion.time[:-width]
        longest = 2 * width * period
        even = sliding_window_view(np.abs(steps) < longest, width).all(axis=1)
    known = np.isfinite(by_velocity) & np.isfinite(by_position) & even
    without_gap = known & (elapsed > 0) & (elapsed < longest)
    fastest = np.max(np.abs(by_velocity), initial=0.0, where=without_gap)
    moving = np.abs(by_velocity) > 0.3 * fastest
    counted = without_gap & moving
    with np.errstate(over="ignore"):
        ratios = by_position[counted] / by_velocity[counted]
    return ratios[np.isfinite(ratios)]


@dataclass(frozen=True, slots=True)
class MotionUnits:
    """Units of time, position and velocity that agree with each other.

    Attributes
    ----------
    time, position : str
        Units.
    velocity : str or None
        Unit; None where none agrees with time and position.
    reversed_velocity : bool
        Whether velocity has the opposite sign of the change of position.
    evidence : str
        The measured ratio in words; "" where there is no velocity.
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
    usual: str = "deg",
    period: float | None = None,
) -> MotionUnits:
    """Choose the units that agree with the values and differ least from the header.

    Parameters
    ----------
    declared : tuple of str or None
        Units of time, position and velocity in the header.
    possible : frozenset of str
        Position units that the values allow.
    ratio : float or None
        Result of :func:`motion_ratio`.
    usual : str, optional
        Position unit that is preferred where neither the header nor the values tell it.
    period : float, optional
        Step of time from row to row, where the unit of time is not declared. [raw]

    Examples
    --------
    >>> found = motion_units(
    ...     declared=("s", None, "deg/s"), possible=frozenset({"deg"}), ratio=57.3
    ... )
    >>> found.velocity
    'rad/s'
    """
    time, position, velocity = declared
    positions = sorted(possible, key=lambda unit: (unit != position, unit != usual, unit))
    if ratio is None:
        assumed = velocity or ("rad/s" if positions[0] == "rad" else "deg/s")
        return MotionUnits(time or "s", positions[0], assumed, False, "")
    best: tuple[float, MotionUnits] | None = None
    for time_unit in dict.fromkeys((time or "s", "s", "ms", "us")):
        if time is None and period is not None and period * FACTORS["time"][time_unit] < _SHORTEST:
            continue
        for position_unit in positions:
            for velocity_unit, velocity_factor in FACTORS["velocity"].items():
                if velocity_unit in ONLY_WRITTEN and velocity_unit not in (
                    velocity,
                    f"{position}/s",
                ):
                    continue
                expected = (
                    velocity_factor
                    * FACTORS["time"][time_unit]
                    / FACTORS["position"][position_unit]
                )
                if not 0.9 < abs(ratio) / expected < 1.1:
                    continue
                cost = (
                    2.0 * _cost(time_unit, time, "s")
                    + _cost(position_unit, position, usual)
                    + _cost(velocity_unit, velocity, "deg/s")
                    + _UNSCALED_COST * (velocity_unit == "mdeg/s" and velocity != "mdeg/s")
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


def _cost(unit: str, declared: str | None, usual: str) -> float:
    """Return the cost of a unit: 1 where the header names another one, 0.25 where it is unusual."""
    if declared is None:
        return 0.0 if unit == usual else 0.25
    return 0.0 if unit == declared else 1.0
