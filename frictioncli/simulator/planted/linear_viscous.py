"""A viscous torque proportional to speed."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from frictioncli.simulator.planted.effect import PlantedEffect, log_uniform
from frictioncli.simulator.planted.state import Extra, State


@dataclass(frozen=True, slots=True, kw_only=True)
class LinearViscous(PlantedEffect):
    r"""Friction proportional to speed, rounded near rest.

    Attributes
    ----------
    magnitude : float
        Torque at 100 deg/s. [N·m]
    rounding : float
        Speed below which the law is round. [deg/s]

    Notes
    -----
    .. math:: m \left(\sqrt{v^2 + v_r^2} - v_r\right) / 100

    Range: rounding 0.5 to 4 deg/s. A textbook column is the speed itself, with a corner at rest.
    """

    name: ClassVar[str] = "linear_viscous"
    equation: ClassVar[str] = "m (sqrt(v^2 + vr^2) - vr) / 100"

    rounding: float

    @classmethod
    def draw(cls, generator: np.random.Generator) -> Self:
        """Return the effect with random shape parameters."""
        return cls(
            rounding=log_uniform(generator, 0.5, 4.0),
        )

    def torque(self, state: State) -> Extra:
        """Return the torque that the effect adds [N·m]."""
        rounded = np.hypot(state.speed, self.rounding) - self.rounding
        return Extra(friction=self.magnitude * rounded / 100.0)
