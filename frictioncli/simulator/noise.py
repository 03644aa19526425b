"""Random parts of the log: torque noise, and friction that varies between round trips."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import ArrayLike
from scipy.signal import lfilter

from frictioncli.arrays import Array

PAIR_SPACING = 75.0
"""Mean time between the pairs of the thermal cycle, to which drift correlations refer [s]."""

OUTLIER = 10.0
"""Factor on the noise of an outlier [-]."""


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

    def stationary_noise(
        self, generator: np.random.Generator, *, count: int, interval: float
    ) -> Array:
        """Return ``count`` samples of torque noise, ``interval`` seconds apart [N·m]."""
        memory = float(np.exp(-interval / self.correlation_time))
        drive = generator.standard_normal(count) * np.sqrt(1.0 - memory**2)
        if count:
            drive[0] /= np.sqrt(1.0 - memory**2)  # start in the stationary state
        correlated = lfilter([1.0], [1.0, -memory], drive)
        white = generator.standard_normal(count)
        return np.asarray(self.correlated * correlated + self.white * white)

    def torque_noise(
        self,
        generator: np.random.Generator,
        *,
        torque: Array,
        velocity: Array,
        interval: float,
    ) -> Array:
        """Return the noise of samples from their torques [N·m] and velocities [deg/s] [N·m]."""
        return self.stationary_noise(generator, count=len(torque), interval=interval)

    def pair_offsets(self, generator: np.random.Generator, times: Array) -> Array:
        """Return the friction offset of round trips at increasing times in s [N·m]."""
        drive = generator.standard_normal(times.shape)
        memory = np.exp(-np.diff(times) / self.slow_time)
        slow = np.empty(times.shape)
        level = 0.0
        for number, innovation in enumerate(drive):
            kept = float(memory[number - 1]) if number else 0.0
            level = kept * level + float(np.sqrt(1.0 - kept**2) * innovation)
            slow[number] = level
        return np.asarray(self.slow * slow + self.per_pair * generator.standard_normal(times.shape))


@dataclass(frozen=True, slots=True, kw_only=True)
class HeteroscedasticNoise(SimulatedNoise):
    """Torque noise with outliers, or of a standard deviation that depends on torque and speed.

    Attributes
    ----------
    outliers : float
        Share of samples with ten times the noise. [-]
    by_torque : float
        Growth of the noise with the absolute torque. [1/(N·m)]
    by_speed : float
        Growth of the noise with the absolute velocity. [1/(deg/s)]
    """

    outliers: float = 0.0
    by_torque: float = 0.0
    by_speed: float = 0.0

    def spread(self, torque: ArrayLike, velocity: ArrayLike) -> Array:
        """Return the factor on the noise at torques in N·m and velocities in deg/s [-]."""
        growth = self.by_torque * np.abs(torque) + self.by_speed * np.abs(velocity)
        constant = 1.0 if self.by_torque == self.by_speed == 0.0 else 0.4
        return np.asarray(constant + growth)

    def torque_noise(
        self,
        generator: np.random.Generator,
        *,
        torque: Array,
        velocity: Array,
        interval: float,
    ) -> Array:
        """Return the torque noise of samples ``interval`` seconds apart [N·m]."""
        noise = self.stationary_noise(generator, count=len(torque), interval=interval)
        is_outlier = generator.random(len(torque)) < self.outliers
        return noise * self.spread(torque, velocity) * np.where(is_outlier, OUTLIER, 1.0)


def noise_of_kind(kind: str, default: SimulatedNoise) -> SimulatedNoise:
    """Return the noise of a kind.

    Parameters
    ----------
    kind : str
        ``default``; ``white``: samples are independent; ``pair``: besides, friction varies from
        round trip to round trip; ``drift90``, ``drift97``, ``drift99``: besides, friction drifts
        with that correlation, in percent, over the mean time between two pairs of the cycle;
        ``outliers``: 1 % of the samples have ten times the noise; ``heteroscedastic``: noise grows
        with torque and speed.
    default : SimulatedNoise
        The default noise.

    Returns
    -------
    SimulatedNoise
        Noise of that kind.
    """
    if kind == "default":
        return default
    independent = HeteroscedasticNoise(
        white=default.white,
        correlated=0.0,
        correlation_time=default.correlation_time,
        slow=0.0,
        slow_time=default.slow_time,
        per_pair=0.15,
    )
    if kind.startswith("drift"):
        memory = float(kind.removeprefix("drift")) / 100.0
        return replace(independent, slow=0.25, slow_time=float(-PAIR_SPACING / np.log(memory)))
    return {
        "white": replace(independent, per_pair=0.0),
        "pair": replace(independent, per_pair=0.25),
        "outliers": replace(independent, outliers=0.01),
        "heteroscedastic": replace(independent, by_torque=0.012, by_speed=0.008),
    }[kind]
