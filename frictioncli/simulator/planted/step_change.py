"""A sudden lasting change of friction, as of a seal that moved."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from frictioncli.simulator.planted.effect import PlantedEffect, log_uniform, sign
from frictioncli.simulator.planted.state import Extra, State


@dataclass(frozen=True, slots=True, kw_only=True)
class StepChange(PlantedEffect):
    r"""A change at one moment that stays.

    Attributes
    ----------
    magnitude : float
        Torque gained or lost. [N·m]
    moment : float
        Share of all operation at which it happens. [-]
    duration : float
        Width of the change. [s]
    way : float
        +1: friction grows; -1: it falls. [-]

    Notes
    -----
    .. math:: s\,m \left(1 + \tanh((t - t_0)/w)\right) / 2

    Ranges: moment at 20 to 80 % of all operation, duration 1 to 120 s, either sign. A textbook
    column is a step with no width.
    """

    name: ClassVar[str] = "step_change"
    equation: ClassVar[str] = "s m (1 + tanh((t - t0) / w)) / 2"

    moment: float
    duration: float
    way: float

    @classmethod
    def draw(cls, generator: np.random.Generator) -> Self:
        """Return the effect with random shape parameters."""
        return cls(
            moment=float(generator.uniform(0.2, 0.8)),
            duration=log_uniform(generator, 1.0, 120.0),
            way=sign(generator),
        )

    def torque(self, state: State) -> Extra:
        """Return the torque that the effect adds [N·m]."""
        late = (state.progress - self.moment) * state.journey.before.total
        done = 0.5 + 0.5 * np.tanh(late / self.duration)
        return Extra(friction=self.way * self.magnitude * done)
