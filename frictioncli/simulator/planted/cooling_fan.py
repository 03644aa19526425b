"""Friction that swings slowly with time, as with a fan that goes on and off."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from frictioncli.simulator.planted.effect import PlantedEffect
from frictioncli.simulator.planted.state import Extra, State


@dataclass(frozen=True, slots=True, kw_only=True)
class CoolingFan(PlantedEffect):
    r"""A slow swing of friction in time.

    Attributes
    ----------
    magnitude : float
        Amplitude. [N·m]
    period : float
        Period. [s]
    phase : float
        Phase. [rad]
    flattening : float
        How flat the tops are. [-]

    Notes
    -----
    .. math:: m \tanh(c \sin(2 \pi t/P + p)) / \tanh c

    Ranges: period 11 to 37 min, any phase, flattening 0.5 to 3. No catalogue entry has this form.
    """

    name: ClassVar[str] = "cooling_fan"
    equation: ClassVar[str] = "m tanh(c sin(2 pi t / P + p)) / tanh(c)"
    listed: ClassVar[bool] = False

    period: float
    phase: float
    flattening: float

    @classmethod
    def draw(cls, generator: np.random.Generator) -> Self:
        """Return the effect with random shape parameters."""
        return cls(
            period=float(generator.uniform(660.0, 2220.0)),
            phase=float(generator.uniform(0.0, 6.2831853)),
            flattening=float(generator.uniform(0.5, 3.0)),
        )

    def torque(self, state: State) -> Extra:
        """Return the torque that the effect adds [N·m]."""
        swing = np.sin(2.0 * np.pi * state.operated / self.period + self.phase)
        flat = np.tanh(self.flattening * swing) / np.tanh(self.flattening)
        return Extra(friction=self.magnitude * flat)
