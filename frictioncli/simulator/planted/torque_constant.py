"""A magnet that weakens when warm, so that the logged torque is too large."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from frictioncli.simulator.planted.effect import PlantedEffect
from frictioncli.simulator.planted.state import Extra, State


@dataclass(frozen=True, slots=True, kw_only=True)
class TorqueConstant(PlantedEffect):
    r"""Torque that is logged with the torque constant of a cold magnet.

    Attributes
    ----------
    magnitude : float
        Loss of the torque constant per kelvin. [1/K]
    reference : float
        Temperature at which the log is right. [°C]
    curvature : float
        Growth of the loss with temperature. [1/K]

    Notes
    -----
    .. math:: \frac{u}{1 - m (T_m - T_0)(1 + c (T_m - T_0))} - u

    Ranges: reference 18 to 30 °C, curvature 0 to 0.004 1/K. It multiplies the whole torque, gravity
    and acceleration too; a textbook column is linear in temperature.
    """

    name: ClassVar[str] = "torque_constant"
    equation: ClassVar[str] = "u / (1 - m (Tmotor - T0) (1 + c (Tmotor - T0))) - u"
    scales_torque: ClassVar[bool] = True

    reference: float
    curvature: float

    @classmethod
    def draw(cls, generator: np.random.Generator) -> Self:
        """Return the effect with random shape parameters."""
        return cls(
            reference=float(generator.uniform(18.0, 30.0)),
            curvature=float(generator.uniform(0.0, 0.004)),
        )

    def torque(self, state: State) -> Extra:
        """Return the torque that the effect adds [N·m]."""
        warmth = state.motor - self.reference
        lost = self.magnitude * warmth * (1.0 + self.curvature * warmth)
        factor = 1.0 / np.maximum(1.0 - lost, 0.05) - 1.0
        return Extra(friction=factor * state.friction, load=factor * (state.load + state.inertial))
