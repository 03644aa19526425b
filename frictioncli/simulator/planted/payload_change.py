"""A mass on the flange that changes at one moment."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from frictioncli.simulator.arm import GRAVITY
from frictioncli.simulator.planted.effect import PlantedEffect, sign
from frictioncli.simulator.planted.state import Extra, State


@dataclass(frozen=True, slots=True, kw_only=True)
class PayloadChange(PlantedEffect):
    r"""A mass that is put on or taken off at one moment.

    Attributes
    ----------
    magnitude : float
        Mass. [kg]
    moment : float
        Share of all operation at which it happens. [-]
    along : float
        Distance from the axis along the link. [m]
    across : float
        Offset square to the link. [m]
    way : float
        +1: put on; -1: taken off. [-]

    Notes
    -----
    .. math:: s\,m \left(g (x \cos q - y \sin q) + (x^2 + y^2) \ddot q\right)

    Ranges: moment at 20 to 80 % of all operation, distance 0.6 to 1 m, offset -0.1 to 0.1 m, either
    sign. Gravity, friction by load and inertia all follow; a textbook column is gravity alone.
    """

    name: ClassVar[str] = "payload_change"
    equation: ClassVar[str] = (
        "from t0 on: s m (g (x cos q - y sin q) + (x^2 + y^2) dv/dt), f(L + dL) - f(L)"
    )

    moment: float
    along: float
    across: float
    way: float

    @classmethod
    def draw(cls, generator: np.random.Generator) -> Self:
        """Return the effect with random shape parameters."""
        return cls(
            moment=float(generator.uniform(0.2, 0.8)),
            along=float(generator.uniform(0.6, 1.0)),
            across=float(generator.uniform(-0.1, 0.1)),
            way=sign(generator),
        )

    def torque(self, state: State) -> Extra:
        """Return the torque that the effect adds [N·m]."""
        mass = np.where(state.progress >= self.moment, self.way * self.magnitude, 0.0)
        angle = np.radians(state.position)
        arm = self.along * np.cos(angle) - self.across * np.sin(angle)
        gravity = GRAVITY * mass * arm
        inertia = mass * (self.along**2 + self.across**2)
        friction = state.joint.friction(
            load=state.load + gravity, speed=state.speed, temperatures=state.temperatures
        )
        base = state.joint.friction(
            load=state.load, speed=state.speed, temperatures=state.temperatures
        )
        return Extra(
            friction=friction - base, load=gravity + inertia * np.radians(state.acceleration)
        )
