"""Friction that ripples with the joint angle."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from frictioncli.simulator.planted.effect import PlantedEffect, log_uniform
from frictioncli.simulator.planted.state import Extra, State


@dataclass(frozen=True, slots=True, kw_only=True)
class PositionRipple(PlantedEffect):
    r"""Ripple of friction at a fixed order of the joint angle.

    Attributes
    ----------
    magnitude : float
        Amplitude of the first line. [N·m]
    order : float
        Periods per turn of the joint. [1/turn]
    phase : float
        Phase of the first line. [rad]
    second : float
        Amplitude of the line of twice the order, as a share. [-]
    second_phase : float
        Its phase. [rad]

    Notes
    -----
    .. math:: m \left(\sin(N q + p_1) + r \sin(2 N q + p_2)\right)

    Ranges: order 3 to 23 per turn, not whole; second harmonic 0 to 0.5. A textbook column has one
    line at a whole order.
    """

    name: ClassVar[str] = "position_ripple"
    equation: ClassVar[str] = "m (sin(N q + p1) + r sin(2 N q + p2))"

    order: float
    phase: float
    second: float
    second_phase: float

    @classmethod
    def draw(cls, generator: np.random.Generator) -> Self:
        """Return the effect with random shape parameters."""
        return cls(
            order=log_uniform(generator, 3.0, 23.0),
            phase=float(generator.uniform(0.0, 6.2831853)),
            second=float(generator.uniform(0.0, 0.5)),
            second_phase=float(generator.uniform(0.0, 6.2831853)),
        )

    def torque(self, state: State) -> Extra:
        """Return the torque that the effect adds [N·m]."""
        angle = self.order * np.radians(state.position)
        second = self.second * np.sin(2.0 * angle + self.second_phase)
        return Extra(friction=self.magnitude * (np.sin(angle + self.phase) + second))
