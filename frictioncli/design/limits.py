"""Limits of a joint's motion: the measured ranges, unless the user sets others."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from frictioncli.design.settings import PlanSettings
from frictioncli.design.steps import ACCELERATION
from frictioncli.errors import OptionError

DEFAULT_HOTTEST = 65.0
"""Heating moves may always reach the temperature of the paper. [°C]"""

SPEED_RATIO = 60.0
"""Slow moves are safe: the lowest speed may always be the highest divided by this."""

DEFAULT_BIN_WIDTH = 5.0
"""Width of the angle bins where there is only one. [deg]"""

_TOLERANCE = 1e-6
"""Tolerance of comparisons with a limit: relative, or [deg]."""


_TEMPERATURE_MARGIN = 10.0
"""All motion waits above the temperature at which heating ends plus this margin. [°C]"""

LEAST_SPEED = 0.5
"""Least highest speed; slower moves would take hours, and be written as zero. [deg/s]"""

_SLOWEST = 0.01
"""Least speed that robot programs state with two digits at least. [deg/s]"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """Limits of one joint's motion.

    Attributes
    ----------
    low, high : float
        Range of the angle. [deg]
    slowest, fastest : float
        Range of the speed. [deg/s]
    hottest : float
        Motor temperature at which heating moves end. [°C]
    payloads : tuple of float
        Payloads that may be mounted. [kg]
    speed_step : float or None
        Speeds are whole multiples of it: one per cent of the rated speed. [deg/s]
    beyond : tuple of str
        Limits that exceed the measured range because the user set them so.
    """

    low: float
    high: float
    slowest: float
    fastest: float
    hottest: float
    payloads: tuple[float, ...] = ()
    speed_step: float | None = None
    beyond: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not self.high - self.low >= 10.0:
            raise OptionError(
                f"the joint may turn from {self.low:g} to {self.high:g} deg: expected at least"
                " 10 deg; widen it with --from and --to-angle if the robot's surroundings allow"
            )
        if not self.fastest >= LEAST_SPEED:
            raise OptionError(
                f"highest speed {self.fastest:g} deg/s: expected at least {LEAST_SPEED:g} deg/s,"
                " which a robot program can state"
            )
        if not self.slowest <= self.fastest:
            raise OptionError(
                f"highest speed {self.fastest:g} deg/s: expected at least the lowest measured,"
                f" {self.slowest:g} deg/s"
            )

    @property
    def stroke(self) -> float:
        """Angle of a full move [deg]."""
        return self.high - self.low

    def speed(self, wanted: float) -> float:
        """Return the allowed speed nearest to a wanted one that can be programmed [deg/s]."""
        bounded = min(max(wanted, self.slowest), self.fastest)
        if self.speed_step is None:
            return float(f"{bounded:.3g}") if float(f"{bounded:.3g}") <= self.fastest else bounded
        steps = min(
            round(bounded / self.speed_step), int(self.fastest / self.speed_step + _TOLERANCE)
        )
        return max(steps, 1) * self.speed_step

    def speeds(self, count: int, slowest: float = 0.0) -> tuple[float, ...]:
        """Return speeds in equal ratios from slow to fast; fewer where they coincide [deg/s].

        Parameters
        ----------
        count : int
            Number of speeds.
        slowest : float
            Lowest speed, if it is above the limit. [deg/s]
        """
        # the highest speed needs room to accelerate and to stay constant
        high = min(self.fastest, self.highest_useful)
        low = min(max(self.slowest, slowest), high)
        return tuple(sorted({self.speed(float(one)) for one in np.geomspace(low, high, count)}))

    @property
    def waiting(self) -> float:
        """Motor temperature above which all motion waits [°C]."""
        return self.hottest + _TEMPERATURE_MARGIN

    @property
    def highest_useful(self) -> float:
        """Highest speed that leaves a third of the stroke at constant speed [deg/s]."""
        return float(np.sqrt(ACCELERATION * self.stroke * 2 / 3))


def limits_of(
    torques: pd.DataFrame, settings: PlanSettings, *, angle_logged: bool = True
) -> Limits:
    """Return the limits of one joint.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of a single joint.
    settings : PlanSettings
        Limits that the user sets.
    angle_logged : bool
        Whether the angles were measured; those integrated from velocity are unknown but for a
        constant, and tell no range.

    Returns
    -------
    Limits
        The limits.

    Raises
    ------
    OptionError
        If they contradict each other, one per cent of the rated speed exceeds the highest speed, or
        the range of the angle is not known.
    """
    if not angle_logged and (settings.low is None or settings.high is None):
        raise OptionError(
            "the log has no position, so it does not tell the range of the angle: expected --from"
            " and --to-angle"
        )
    half = bin_width(torques) / 2 if angle_logged else -np.inf
    low, high = float(torques["position"].min() - half), float(torques["position"].max() + half)
    measured, fastest = float(torques["speed"].min()), float(torques["speed"].max())
    warmest = float(torques["motor_temperature"].max())
    hottest = DEFAULT_HOTTEST if np.isnan(warmest) else max(warmest, DEFAULT_HOTTEST)
    beyond = []
    if settings.low is not None and settings.low < low - _TOLERANCE:
        measured_from = f"measured from {low:g}" if angle_logged else "not measured"
        beyond.append(f"--from {settings.low:g} deg ({measured_from})")
    if settings.high is not None and settings.high > high + _TOLERANCE:
        measured_to = f"measured to {high:g}" if angle_logged else "not measured"
        beyond.append(f"--to-angle {settings.high:g} deg ({measured_to})")
    if settings.max_speed is not None and settings.max_speed > fastest * (1 + _TOLERANCE):
        beyond.append(f"--max-speed {settings.max_speed:g} deg/s (measured to {fastest:.4g})")
    low = low if settings.low is None else settings.low
    high = high if settings.high is None else settings.high
    fastest = fastest if settings.max_speed is None else settings.max_speed
    step = None if settings.rated_speed is None else settings.rated_speed / 100
    if step is not None and not step <= fastest <= _rated(settings) * (1 + _TOLERANCE):
        raise OptionError(
            f"highest speed {fastest:.4g} deg/s: expected between 1 and 100 % of the rated speed,"
            f" --rated-speed {settings.rated_speed:g} deg/s"
        )
    return Limits(
        low=low,
        high=high,
        slowest=max(min(measured, fastest / SPEED_RATIO), _SLOWEST),
        fastest=fastest,
        hottest=hottest if settings.max_temperature is None else settings.max_temperature,
        payloads=settings.payload,
        speed_step=step,
        beyond=tuple(beyond),
    )


def _rated(settings: PlanSettings) -> float:
    """Return the rated speed, infinity where it is not known [deg/s]."""
    return float("inf") if settings.rated_speed is None else settings.rated_speed


def bin_width(torques: pd.DataFrame) -> float:
    """Return the width of the angle bins, the least distance of their centres [deg]."""
    centres = np.unique(torques["position"].to_numpy(float))
    return float(np.min(np.diff(centres))) if len(centres) > 1 else DEFAULT_BIN_WIDTH
