"""Friction by load that falls when the gear is warm."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from frictioncli.simulator.planted.effect import PlantedEffect
from frictioncli.simulator.planted.state import Extra, State


@dataclass(frozen=True, slots=True, kw_only=True)
class LoadTemperature(PlantedEffect):
    r"""Friction by load that falls with temperature.

    Attributes
    ----------
    magnitude : float
        Torque at 50 N·m that is lost in full warmth. [N·m]
    reference : float
        Temperature at which nothing is added. [°C]
    width : float
        Width of the fall. [K]

    Notes
    -----
    .. math:: -m\,(L/50)^2 \tanh\!\left((T_m - T_0)/w\right)

    Ranges: reference 35 to 50 °C, width 15 to 40 K. A textbook column is linear in temperature.
    """

    name: ClassVar[str] = "load_temperature"
    equation: ClassVar[str] = "-m (L / 50)^2 tanh((Tmotor - T0) / w)"

    reference: float
    width: float

    @classmethod
    def draw(cls, generator: np.random.Generator) -> Self:
        """Return the effect with random shape parameters."""
        return cls(
            reference=float(generator.uniform(35.0, 50.0)),
            width=float(generator.uniform(15.0, 40.0)),
        )

    def torque(self, state: State) -> Extra:
        """Return the torque that the effect adds [N·m]."""
        fall = np.tanh((state.motor - self.reference) / self.width)
        return Extra(friction=-self.magnitude * np.square(state.load / 50.0) * fall)
