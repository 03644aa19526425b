"""A housing that warps when warm, so that friction depends on the angle."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from frictioncli.simulator.planted.effect import PlantedEffect
from frictioncli.simulator.planted.state import Extra, State


@dataclass(frozen=True, slots=True, kw_only=True)
class PositionTemperature(PlantedEffect):
    r"""Friction by the product of angle and temperature.

    Attributes
    ----------
    magnitude : float
        Torque at 20 K above the reference. [N·m]
    angle : float
        Angle of the most friction. [deg]
    reference : float
        Housing is straight at this motor temperature. [°C]

    Notes
    -----
    .. math:: m \cos(2 (q - q_0)) (T_m - T_0)/20

    Ranges: angle 0 to 360 deg, reference 35 to 50 °C. No catalogue entry has this form.
    """

    name: ClassVar[str] = "position_temperature"
    equation: ClassVar[str] = "m cos(2 (q - q0)) (Tmotor - T0) / 20"
    listed: ClassVar[bool] = False

    angle: float
    reference: float

    @classmethod
    def draw(cls, generator: np.random.Generator) -> Self:
        """Return the effect with random shape parameters."""
        return cls(
            angle=float(generator.uniform(0.0, 360.0)),
            reference=float(generator.uniform(35.0, 50.0)),
        )

    def torque(self, state: State) -> Extra:
        """Return the torque that the effect adds [N·m]."""
        warp = np.cos(2.0 * np.radians(state.position - self.angle))
        return Extra(friction=self.magnitude * warp * (state.motor - self.reference) / 20.0)
