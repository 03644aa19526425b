"""Within which limits a joint may move: those of the data at hand, unless the user sets others."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from frictioncli.design.settings import PlanSettings
from frictioncli.design.steps import ACCELERATION
from frictioncli.errors import OptionError

USUAL_HOTTEST = 65.0
"""Heating moves may go as far as the paper's, whatever was measured. [°C]"""

SLOWER = 60.0
"""Slow moves endanger nothing: they may be slower than the fastest by this, whatever was measured.
"""

BIN = 5.0
"""Width of the angle bins where the data do not tell. [deg]"""

_ROOM = 1e-6


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """Limits and measured range of one joint.

    Attributes
    ----------
    low, high : float
        Angles between which it may turn. [deg]
    slowest, fastest : float
        Lowest and highest speed of moves. [deg/s]
    hottest : float
        Motor temperature at which heating moves end. [°C]
    payloads : tuple of float
        Payloads that may be mounted. [kg]
    speed_step : float or None
        Speeds are whole multiples of it: one per cent of the rated speed. [deg/s]
    beyond : tuple of str
        Which of them go beyond what was measured, because the user said so.
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
        """Return the speed next to the one that is wanted that is allowed and can be stated."""
        bounded = min(max(wanted, self.slowest), self.fastest)
        if self.speed_step is None:
            return float(f"{bounded:.3g}") if float(f"{bounded:.3g}") <= self.fastest else bounded
        steps = min(round(bounded / self.speed_step), int(self.fastest / self.speed_step + _ROOM))
        return max(steps, 1) * self.speed_step

    def speeds(self, count: int, slowest: float = 0.0) -> tuple[float, ...]:
        """Return so many speeds from slow to fast in equal ratios; fewer if they coincide."""
        # the highest needs room to reach its speed and hold it
        high = min(self.fastest, self.highest_useful)
        low = min(max(self.slowest, slowest), high)
        return tuple(sorted({self.speed(float(one)) for one in np.geomspace(low, high, count)}))

    @property
    def highest_useful(self) -> float:
        """Highest speed that leaves a third of the stroke at constant speed [deg/s]."""
        return float(np.sqrt(ACCELERATION * self.stroke * 2 / 3))


def limits_of(torques: pd.DataFrame, settings: PlanSettings) -> Limits:
    """Return the limits of one joint.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of a single joint.
    settings : PlanSettings
        What the user allows.

    Raises
    ------
    OptionError
        If they contradict each other, or one per cent of the rated speed is more than the highest.
    """
    half = bin_width(torques) / 2
    low, high = float(torques["position"].min() - half), float(torques["position"].max() + half)
    measured, fastest = float(torques["speed"].min()), float(torques["speed"].max())
    warmest = float(torques["motor_temperature"].max())
    hottest = USUAL_HOTTEST if np.isnan(warmest) else max(warmest, USUAL_HOTTEST)
    beyond = []
    if settings.low is not None and settings.low < low - _ROOM:
        beyond.append(f"--from {settings.low:g} deg (measured from {low:g})")
    if settings.high is not None and settings.high > high + _ROOM:
        beyond.append(f"--to-angle {settings.high:g} deg (measured to {high:g})")
    if settings.max_speed is not None and settings.max_speed > fastest * (1 + _ROOM):
        beyond.append(f"--max-speed {settings.max_speed:g} deg/s (measured to {fastest:.4g})")
    low = low if settings.low is None else settings.low
    high = high if settings.high is None else settings.high
    fastest = fastest if settings.max_speed is None else settings.max_speed
    step = None if settings.rated_speed is None else settings.rated_speed / 100
    if step is not None and not step <= fastest <= _rated(settings) * (1 + _ROOM):
        raise OptionError(
            f"highest speed {fastest:.4g} deg/s: expected between 1 and 100 % of the rated speed,"
            f" --rated-speed {settings.rated_speed:g} deg/s"
        )
    return Limits(
        low=low,
        high=high,
        slowest=min(measured, fastest / SLOWER),
        fastest=fastest,
        hottest=hottest if settings.max_temperature is None else settings.max_temperature,
        payloads=settings.payload,
        speed_step=step,
        beyond=tuple(beyond),
    )


def _rated(settings: PlanSettings) -> float:
    """Return the rated speed, or no bound where it is not known [deg/s]."""
    return float("inf") if settings.rated_speed is None else settings.rated_speed


def bin_width(torques: pd.DataFrame) -> float:
    """Return the width of the angle bins, from the distance of their centres [deg]."""
    centres = np.unique(torques["position"].to_numpy(float))
    return float(np.min(np.diff(centres))) if len(centres) > 1 else BIN
