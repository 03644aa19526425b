"""A hose package that pulls like a stiffening spring."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from frictioncli.simulator.planted.effect import PlantedEffect
from frictioncli.simulator.planted.state import Extra, State


@dataclass(frozen=True, slots=True, kw_only=True)
class DressPack(PlantedEffect):
    r"""A spring of hoses and cables.

    Attributes
    ----------
    magnitude : float
        Torque at 90 deg from rest, without stiffening. [N·m]
    rest : float
        Angle at which it does not pull. [deg]
    stiffening : float
        Weight of the cubic part. [-]

    Notes
    -----
    .. math:: m \left(x + c x^3\right),\quad x = (q - q_0)/90

    Ranges: rest angle 20 to 160 deg, stiffening 0.1 to 1.5. A textbook column is a linear spring.
    """

    name: ClassVar[str] = "dress_pack"
    equation: ClassVar[str] = "m (x + c x^3), x = (q - q0) / 90, on the load"

    rest: float
    stiffening: float

    @classmethod
    def draw(cls, generator: np.random.Generator) -> Self:
        """Return the effect with random shape parameters."""
        return cls(
            rest=float(generator.uniform(20.0, 160.0)),
            stiffening=float(generator.uniform(0.1, 1.5)),
        )

    def torque(self, state: State) -> Extra:
        """Return the torque that the effect adds [N·m]."""
        turn = (state.position - self.rest) / 90.0
        return Extra(load=self.magnitude * (turn + self.stiffening * turn**3))
