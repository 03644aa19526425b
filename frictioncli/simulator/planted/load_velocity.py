"""Friction by load that grows with speed."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from frictioncli.simulator.planted.effect import PlantedEffect
from frictioncli.simulator.planted.state import Extra, State


@dataclass(frozen=True, slots=True, kw_only=True)
class LoadVelocity(PlantedEffect):
    r"""Friction that grows with load and speed together.

    Attributes
    ----------
    magnitude : float
        Torque at 50 N·m and 50 deg/s. [N·m]
    load_exponent : float
        Exponent a of the load. [-]
    speed_exponent : float
        Exponent b of the speed. [-]

    Notes
    -----
    .. math:: m\,(|L|/50)^a (|v|/50)^b

    Ranges: exponent of load 1.6 to 2.2, of speed 0.4 to 0.8. A textbook column has 2 and 1/2.
    """

    name: ClassVar[str] = "load_velocity"
    equation: ClassVar[str] = "m (|L| / 50)^a (|v| / 50)^b"

    load_exponent: float
    speed_exponent: float

    @classmethod
    def draw(cls, generator: np.random.Generator) -> Self:
        """Return the effect with random shape parameters."""
        return cls(
            load_exponent=float(generator.uniform(1.6, 2.2)),
            speed_exponent=float(generator.uniform(0.4, 0.8)),
        )

    def torque(self, state: State) -> Extra:
        """Return the torque that the effect adds [N·m]."""
        load = (np.abs(state.load) / 50.0) ** self.load_exponent
        speed = (state.speed / 50.0) ** self.speed_exponent
        return Extra(friction=self.magnitude * load * speed)
