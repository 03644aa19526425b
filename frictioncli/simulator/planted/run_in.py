"""Friction of a new joint that falls with the angle it has turned."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from frictioncli.simulator.planted.effect import PlantedEffect, log_uniform
from frictioncli.simulator.planted.state import Extra, State


@dataclass(frozen=True, slots=True, kw_only=True)
class RunIn(PlantedEffect):
    r"""Running-in: friction that falls with travel, not with time.

    Attributes
    ----------
    magnitude : float
        Torque at the start. [N·m]
    turns : float
        Travel constant. [turns]
    exponent : float
        Exponent c: below 1 the fall begins fast and ends slowly. [-]

    Notes
    -----
    .. math:: m\,e^{-(s/s_0)^c}

    Ranges: travel 100 to 900 turns, exponent 0.7 to 1.2. Travel counts unrecorded heating moves,
    and a textbook column is a plain exponential.
    """

    name: ClassVar[str] = "run_in"
    equation: ClassVar[str] = "m exp(-(s / s0)^c), s travel in turns"

    turns: float
    exponent: float

    @classmethod
    def draw(cls, generator: np.random.Generator) -> Self:
        """Return the effect with random shape parameters."""
        return cls(
            turns=log_uniform(generator, 100.0, 900.0),
            exponent=float(generator.uniform(0.7, 1.2)),
        )

    def torque(self, state: State) -> Extra:
        """Return the torque that the effect adds [N·m]."""
        ratio = state.travelled / 360.0 / self.turns
        return Extra(friction=self.magnitude * np.exp(-(ratio**self.exponent)))
