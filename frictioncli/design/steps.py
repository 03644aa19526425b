"""What a joint is made to do: series that are measured, moves that heat, rests."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

ACCELERATION = 200.0
"""Acceleration that durations are reckoned with; the robot's own is not known. [deg/s²]"""

DWELL = 0.5
"""Standing time at each end of a measured move. [s]"""

LEAD = 2.0
"""Standing time before a series, in which the recording starts. [s]"""

MOUNTING = 240.0
"""Time to change the payload. [s]"""


@dataclass(frozen=True, slots=True, kw_only=True)
class SeriesStep:
    """Moves there and back at constant speed, one pair per speed; recorded.

    Attributes
    ----------
    speeds : tuple of float
        In this order. [deg/s]
    low, high : float
        Angles between which it moves. [deg]
    payload : float or None
        Mass that is on; None: what is on stays. [kg]
    """

    speeds: tuple[float, ...]
    low: float
    high: float
    payload: float | None = None

    @property
    def seconds(self) -> float:
        """Its duration, its lead included [s]."""
        return LEAD + sum(round_trip(speed, self.high - self.low) for speed in self.speeds)


@dataclass(frozen=True, slots=True, kw_only=True)
class HeatStep:
    """Moves there and back without pauses, to heat or to travel; not recorded.

    Attributes
    ----------
    speed : float
        Their speed. [deg/s]
    low, high : float
        Angles between which it moves. [deg]
    seconds : float
        Longest duration. [s]
    until : float or None
        Motor temperature at which it ends before that. [°C]
    """

    speed: float
    low: float
    high: float
    seconds: float
    until: float | None = None


@dataclass(frozen=True, slots=True)
class RestStep:
    """The joint is held still for a time [s], or until the motor has cooled to ``until`` [°C]."""

    seconds: float
    until: float | None = None


Step = SeriesStep | HeatStep | RestStep


def round_trip(speed: float, stroke: float) -> float:
    """Return the duration of a move there and back, its two dwells included [s].

    Parameters
    ----------
    speed, stroke : float
        Speed of the constant part, and the angle of one move. [deg/s], [deg]
    """
    ramp = speed / ACCELERATION
    if speed * ramp >= stroke:  # too short to reach the speed
        return 2 * (2 * float(np.sqrt(stroke / ACCELERATION)) + DWELL)
    return 2 * (stroke / speed + ramp + DWELL)


def duration(steps: Sequence[Step]) -> float:
    """Return how long steps take, changes of payload apart [s]."""
    return sum(step.seconds for step in steps)


def mountings(steps: Sequence[Step], payload: float | None) -> Iterator[bool]:
    """Yield for each step whether the payload must be changed before it.

    Parameters
    ----------
    steps : sequence of Step
        The steps.
    payload : float or None
        What is on before the first. [kg]
    """
    for step in steps:
        wanted = step.payload if isinstance(step, SeriesStep) else None
        yield wanted is not None and wanted != payload
        payload = payload if wanted is None else wanted
