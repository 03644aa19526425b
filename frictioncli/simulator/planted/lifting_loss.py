"""A gear that loses more torque when it lifts a load than when it lowers it."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from frictioncli.simulator.planted.effect import PlantedEffect
from frictioncli.simulator.planted.state import Extra, State


@dataclass(frozen=True, slots=True, kw_only=True)
class LiftingLoss(PlantedEffect):
    r"""Friction by load that differs between lifting and lowering.

    Attributes
    ----------
    magnitude : float
        Torque at 50 N·m. [N·m]
    exponent : float
        Exponent a of the load. [-]

    Notes
    -----
    .. math:: m \operatorname{sign}(v L) (|L|/50)^a

    Range: exponent 1.5 to 2.5, so that it is no error of the mass. No catalogue entry has this
    form.
    """

    name: ClassVar[str] = "lifting_loss"
    equation: ClassVar[str] = "m sign(v L) (|L| / 50)^a"
    listed: ClassVar[bool] = False

    exponent: float

    @classmethod
    def draw(cls, generator: np.random.Generator) -> Self:
        """Return the effect with random shape parameters."""
        return cls(
            exponent=float(generator.uniform(1.5, 2.5)),
        )

    def torque(self, state: State) -> Extra:
        """Return the torque that the effect adds [N·m]."""
        lifting = state.direction * np.sign(state.load)
        load = (np.abs(state.load) / 50.0) ** self.exponent
        return Extra(friction=self.magnitude * lifting * load)
