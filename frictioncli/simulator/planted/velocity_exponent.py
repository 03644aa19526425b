"""A viscous part with another exponent of speed than one half."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from frictioncli.simulator.planted.effect import PlantedEffect, log_uniform
from frictioncli.simulator.planted.state import Extra, State


@dataclass(frozen=True, slots=True, kw_only=True)
class VelocityExponent(PlantedEffect):
    r"""Viscous friction whose exponent is not one half.

    Attributes
    ----------
    magnitude : float
        Viscous torque at the crossing and 40 °C. [N·m]
    exponent : float
        Exponent p in place of 1/2. [-]
    crossing : float
        Speed at which both laws agree. [deg/s]
    floor : float
        Share of the viscous torque that does not thin. [-]
    thinning : float
        Rate at which the rest thins with motor temperature. [1/K]

    Notes
    -----
    .. math:: m \left(f + (1 - f) e^{-d (T_m - 40)}\right) \left((|v|/v_c)^p - \sqrt{|v|/v_c}\right)

    Ranges: exponent 0.3 to 0.4 or 0.65 to 0.95, crossing 15 to 50 deg/s, thinning 0.02 to 0.06 1/K.
    It is the exact difference of two powers, not a derivative with respect to the exponent.
    """

    name: ClassVar[str] = "velocity_exponent"
    equation: ClassVar[str] = (
        "m (f + (1 - f) exp(-d (Tmotor - 40))) ((|v| / vc)^p - (|v| / vc)^0.5)"
    )

    exponent: float
    crossing: float
    floor: float
    thinning: float

    @classmethod
    def draw(cls, generator: np.random.Generator) -> Self:
        """Return the effect with random shape parameters."""
        return cls(
            exponent=float(
                generator.choice((generator.uniform(0.3, 0.4), generator.uniform(0.65, 0.95)))
            ),
            crossing=log_uniform(generator, 15.0, 50.0),
            floor=float(generator.uniform(0.3, 0.7)),
            thinning=float(generator.uniform(0.02, 0.06)),
        )

    def torque(self, state: State) -> Extra:
        """Return the torque that the effect adds [N·m]."""
        ratio = state.speed / self.crossing
        thin = np.exp(-self.thinning * (state.motor - 40.0))
        viscous = self.floor + (1.0 - self.floor) * thin
        return Extra(friction=self.magnitude * viscous * (ratio**self.exponent - np.sqrt(ratio)))
