"""Ambient temperature that changes over the day."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from frictioncli.arrays import Array
from frictioncli.simulator.nuisances.definition import Nuisances
from frictioncli.simulator.thermal_network import Ambient


@dataclass(frozen=True, slots=True, kw_only=True)
class DailyAmbient(Ambient):
    """Ambient temperature with a daily swing and the cycles of an air conditioning.

    Attributes
    ----------
    swing : float
        Amplitude over the day. [K]
    warmest : float
        Warmest hour since the run's start. [h]
    cycle : float
        Amplitude of the air conditioning. [K]
    cycle_period : float
        Its period. [h]
    """

    swing: float
    warmest: float
    cycle: float
    cycle_period: float

    def at(self, time: ArrayLike) -> Array:
        """Return the ambient temperature at a time in s [°C]."""
        hours = np.asarray(time, dtype=float) / 3600.0
        day = 2.0 * np.pi / 24.0
        swing = np.cos(day * (hours - self.warmest)) - np.cos(day * self.warmest)
        cycle = np.sin(2.0 * np.pi * hours / self.cycle_period)
        return np.asarray(Ambient.at(self, time) + self.swing * swing + self.cycle * cycle)


def changed_ambient(ambient: Ambient, nuisances: Nuisances) -> Ambient:
    """Return the ambient with its swing, if there is one."""
    swing = nuisances.size("ambient_swing")
    if swing == 0.0:
        return ambient
    return DailyAmbient(
        start=ambient.start,
        drift=ambient.drift,
        swing=swing,
        warmest=nuisances.parameter("ambient_swing", "warmest"),
        cycle=swing * nuisances.parameter("ambient_swing", "cycle"),
        cycle_period=nuisances.parameter("ambient_swing", "cycle_period"),
    )
