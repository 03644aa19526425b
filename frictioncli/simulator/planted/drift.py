"""A slow drift of friction over the hours of operation, as of grease that ages."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from frictioncli.simulator.planted.effect import PlantedEffect, log_uniform, sign
from frictioncli.simulator.planted.state import Extra, State


@dataclass(frozen=True, slots=True, kw_only=True)
class Drift(PlantedEffect):
    r"""Drift over the hours of operation, kept overnight.

    Attributes
    ----------
    magnitude : float
        Torque gained or lost in the end. [N·m]
    time_constant : float
        Time constant of the approach. [h]
    way : float
        +1: friction grows; -1: it falls. [-]

    Notes
    -----
    .. math:: s\,m \left(1 - e^{-t/\tau}\right)

    Ranges: time constant 3 to 40 h, either sign. A textbook column is linear in time.
    """

    name: ClassVar[str] = "drift"
    equation: ClassVar[str] = "s m (1 - exp(-t / tau)), t of operation"

    time_constant: float
    way: float

    @classmethod
    def draw(cls, generator: np.random.Generator) -> Self:
        """Return the effect with random shape parameters."""
        return cls(
            time_constant=log_uniform(generator, 3.0, 40.0),
            way=sign(generator),
        )

    def torque(self, state: State) -> Extra:
        """Return the torque that the effect adds [N·m]."""
        hours = state.operated / 3600.0
        return Extra(friction=-self.way * self.magnitude * np.expm1(-hours / self.time_constant))
