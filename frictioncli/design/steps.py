"""Steps of a measuring programme: recorded series, heating moves and rests."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

ACCELERATION = 200.0
"""Assumed acceleration of all moves; that of the robot is not known. [deg/s²]"""

DWELL = 0.5
"""Standing time at each end of a measured move. [s]"""

LEAD = 2.0
"""Standing time before a series, in which the recording starts. [s]"""

PAYLOAD_CHANGE = 240.0
"""Time to change the payload. [s]"""


@dataclass(frozen=True, slots=True, kw_only=True)
class SeriesStep:
    """Recorded moves there and back at constant speed, one pair per speed.

    Attributes
    ----------
    speeds : tuple of float
        Speeds in their order. [deg/s]
    low, high : float
        Ends of the moves. [deg]
    payload : float or None
        Payload to mount; None: the mounted one stays. [kg]
    """

    speeds: tuple[float, ...]
    low: float
    high: float
    payload: float | None = None

    @property
    def seconds(self) -> float:
        """Duration with the standing time before it [s]."""
        return LEAD + sum(round_trip(speed, self.high - self.low) for speed in self.speeds)


@dataclass(frozen=True, slots=True, kw_only=True)
class HeatStep:
    """Unrecorded moves there and back without pauses, to heat the joint.

    Attributes
    ----------
    speed : float
        Speed. [deg/s]
    low, high : float
        Ends of the moves. [deg]
    seconds : float
        Longest duration. [s]
    until : float or None
        Motor temperature at which the moves end earlier. [°C]
    """

    speed: float
    low: float
    high: float
    seconds: float
    until: float | None = None


@dataclass(frozen=True, slots=True)
class RestStep:
    """Static hold.

    Attributes
    ----------
    seconds : float
        Longest duration. [s]
    until : float or None
        Motor temperature at which the hold ends earlier. [°C]
    """

    seconds: float
    until: float | None = None


Step = SeriesStep | HeatStep | RestStep


def round_trip(speed: float, stroke: float) -> float:
    """Return the duration of a move there and back with a dwell at each end.

    Parameters
    ----------
    speed : float
        Constant speed. [deg/s]
    stroke : float
        Angle of one move. [deg]

    Returns
    -------
    float
        Duration. [s]

    Examples
    --------
    >>> round_trip(50.0, stroke=100.0)
    5.5
    """
    ramp = speed / ACCELERATION
    if speed * ramp >= stroke:  # too short to reach the speed
        return 2 * (2 * float(np.sqrt(stroke / ACCELERATION)) + DWELL)
    return 2 * (stroke / speed + ramp + DWELL)


def duration(steps: Sequence[Step]) -> float:
    """Return the duration of steps without changes of payload [s]."""
    return sum(step.seconds for step in steps)


def payload_changes(steps: Sequence[Step], payload: float | None) -> Iterator[bool]:
    """Yield for each step whether the payload must be changed before it.

    Parameters
    ----------
    steps : sequence of Step
        The steps.
    payload : float or None
        Payload that is mounted before the first. [kg]

    Yields
    ------
    bool
        Whether a payload has to be mounted.
    """
    for step in steps:
        wanted = step.payload if isinstance(step, SeriesStep) else None
        yield wanted is not None and wanted != payload
        payload = payload if wanted is None else wanted
