"""Grease that flows back at rest and is pushed aside again by motion."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from frictioncli.simulator.planted.effect import PlantedEffect, log_uniform
from frictioncli.simulator.planted.state import Extra, State


@dataclass(frozen=True, slots=True, kw_only=True)
class RestRecovery(PlantedEffect):
    r"""More friction after a rest, that fades with travel.

    Attributes
    ----------
    magnitude : float
        Torque after a long rest. [N·m]
    recovery : float
        Time constant of the rest. [s]
    travel : float
        Travel constant of the fading. [deg]

    Notes
    -----
    .. math:: m \left(1 - e^{-r/t_r}\right) e^{-s/s_0}

    Ranges: recovery 200 to 2400 s, travel 300 to 2500 deg. Its size follows the length of each
    rest; a textbook column counts measurements after a pause.
    """

    name: ClassVar[str] = "rest_recovery"
    equation: ClassVar[str] = "m (1 - exp(-rest / tr)) exp(-s / s0), s travel since the rest"

    recovery: float
    travel: float

    @classmethod
    def draw(cls, generator: np.random.Generator) -> Self:
        """Return the effect with random shape parameters."""
        return cls(
            recovery=log_uniform(generator, 200.0, 2400.0),
            travel=log_uniform(generator, 300.0, 2500.0),
        )

    def torque(self, state: State) -> Extra:
        """Return the torque that the effect adds [N·m]."""
        rest, since = state.journey.last_rest(state.time)
        gained = -np.expm1(-rest / self.recovery)
        return Extra(friction=self.magnitude * gained * np.exp(-since / self.travel))
