"""A torque that is needed near one speed only, as at a resonance of the drive train."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from frictioncli.simulator.planted.effect import PlantedEffect, log_uniform
from frictioncli.simulator.planted.state import Extra, State


@dataclass(frozen=True, slots=True, kw_only=True)
class SpeedResonance(PlantedEffect):
    r"""A bump of friction at one speed.

    Attributes
    ----------
    magnitude : float
        Torque at the top. [N·m]
    centre : float
        Speed of the top. [deg/s]
    width : float
        Width in the logarithm of speed. [-]

    Notes
    -----
    .. math:: m\,e^{-(\ln(|v|/v_0)/w)^2/2}

    Ranges: speed 15 to 80 deg/s, width 0.15 to 0.4. No catalogue entry has this form.
    """

    name: ClassVar[str] = "speed_resonance"
    equation: ClassVar[str] = "m exp(-(ln(|v| / v0) / w)^2 / 2)"
    listed: ClassVar[bool] = False

    centre: float
    width: float

    @classmethod
    def draw(cls, generator: np.random.Generator) -> Self:
        """Return the effect with random shape parameters."""
        return cls(
            centre=log_uniform(generator, 15.0, 80.0),
            width=float(generator.uniform(0.15, 0.4)),
        )

    def torque(self, state: State) -> Extra:
        """Return the torque that the effect adds [N·m]."""
        speed = np.maximum(state.speed, 1e-3)
        distance = np.log(speed / self.centre) / self.width
        return Extra(friction=self.magnitude * np.exp(-np.square(distance) / 2.0))
