"""Kinds of noise that may cause false detections."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from frictioncli.arrays import Array
from frictioncli.simulator.noise import SimulatedNoise

PAIR_SPACING = 75.0
"""Mean time between the pairs of the thermal cycle, to which drift correlations refer [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class UnevenNoise(SimulatedNoise):
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

    def at(
        self,
        generator: np.random.Generator,
        *,
        torque: Array,
        velocity: Array,
        interval: float,
    ) -> Array:
        """Return the torque noise of samples ``interval`` seconds apart [N·m]."""
        noise = self.torque(generator, count=len(torque), interval=interval)
        is_outlier = generator.random(len(torque)) < self.outliers
        return noise * self.spread(torque, velocity) * np.where(is_outlier, OUTLIER, 1.0)


OUTLIER = 10.0
"""Factor on the noise of an outlier [-]."""


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
    """
    if kind == "default":
        return default
    white = UnevenNoise(
        white=default.white,
        correlated=0.0,
        correlation_time=default.correlation_time,
        slow=0.0,
        slow_time=default.slow_time,
        per_pair=0.15,
    )
    if kind.startswith("drift"):
        memory = float(kind.removeprefix("drift")) / 100.0
        return replace(white, slow=0.25, slow_time=float(-PAIR_SPACING / np.log(memory)))
    return {
        "white": replace(white, per_pair=0.0),
        "pair": replace(white, per_pair=0.25),
        "outliers": replace(white, outliers=0.01),
        "heteroscedastic": replace(white, by_torque=0.012, by_speed=0.008),
    }[kind]
