"""Random parts of the log: torque noise, and friction that varies between round trips."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from scipy.signal import lfilter

from frictioncli.arrays import Array


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulatedNoise:
    """Standard deviations and correlation times of the random parts.

    Attributes
    ----------
    white : float
        Standard deviation of white torque noise. [N·m]
    correlated : float
        Standard deviation of correlated torque noise, from ripple and control. [N·m]
    correlation_time : float
        Its correlation time. [s]
    slow : float
        Standard deviation of the slow variation of friction, as of grease redistribution. [N·m]
    slow_time : float
        Its correlation time. [s]
    per_pair : float
        Standard deviation of friction from one round trip to the next. [N·m]
    """

    white: float
    correlated: float
    correlation_time: float
    slow: float
    slow_time: float
    per_pair: float

    def scaled(self, factor: float) -> Self:
        """Return the noise with all standard deviations multiplied by ``factor``."""
        return replace(
            self,
            white=self.white * factor,
            correlated=self.correlated * factor,
            slow=self.slow * factor,
            per_pair=self.per_pair * factor,
        )

    def torque(self, generator: np.random.Generator, *, count: int, interval: float) -> Array:
        """Return ``count`` samples of torque noise, ``interval`` seconds apart [N·m]."""
        memory = float(np.exp(-interval / self.correlation_time))
        drive = generator.standard_normal(count) * np.sqrt(1.0 - memory**2)
        if count:
            drive[0] /= np.sqrt(1.0 - memory**2)  # start in the stationary state
        correlated = lfilter([1.0], [1.0, -memory], drive)
        white = generator.standard_normal(count)
        return np.asarray(self.correlated * correlated + self.white * white)

    def at(
        self,
        generator: np.random.Generator,
        *,
        torque: Array,
        velocity: Array,
        interval: float,
    ) -> Array:
        """Return the noise of samples from their torques [N·m] and velocities [deg/s] [N·m]."""
        return self.torque(generator, count=len(torque), interval=interval)

    def pair_offsets(self, generator: np.random.Generator, times: Array) -> Array:
        """Return the friction offset of round trips at increasing times in s [N·m]."""
        drive = generator.standard_normal(times.shape)
        memory = np.exp(-np.diff(times) / self.slow_time)
        slow = np.empty(times.shape)
        level = 0.0
        for number, pulse in enumerate(drive):
            kept = float(memory[number - 1]) if number else 0.0
            level = kept * level + float(np.sqrt(1.0 - kept**2) * pulse)
            slow[number] = level
        return np.asarray(self.slow * slow + self.per_pair * generator.standard_normal(times.shape))
