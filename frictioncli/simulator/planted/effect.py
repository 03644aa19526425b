"""What every planted effect is: parameters drawn from a seed, a magnitude, and its torque."""

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from frictioncli.simulator.planted.state import Extra, State


@dataclass(frozen=True, slots=True, kw_only=True)
class PlantedEffect(ABC):
    """A planted effect.

    Attributes
    ----------
    magnitude : float
        Factor that sets the effect's size; its unit is told by each effect.
    """

    name: ClassVar[str]
    equation: ClassVar[str]
    listed: ClassVar[bool] = True
    """Whether the public catalogue of effects has the name."""
    at_reversal: ClassVar[bool] = False
    """Whether its size is counted within the first 20 deg after a reversal only."""
    scales_torque: ClassVar[bool] = False
    """Whether it acts on the torque of all other effects as well."""

    magnitude: float = 1.0

    @classmethod
    @abstractmethod
    def draw(cls, generator: np.random.Generator) -> Self:
        """Return the effect with random shape parameters."""

    def scaled(self, factor: float) -> Self:
        """Return the effect with its magnitude multiplied by ``factor``."""
        return replace(self, magnitude=self.magnitude * factor)

    @abstractmethod
    def torque(self, state: State) -> Extra:
        """Return the torque that the effect adds at each sample [N·m]."""


def sign(generator: np.random.Generator) -> float:
    """Return -1 or +1 with equal probability."""
    return float(generator.choice((-1.0, 1.0)))


def log_uniform(generator: np.random.Generator, low: float, high: float) -> float:
    """Return a number between ``low`` and ``high`` whose logarithm is uniform."""
    return float(np.exp(generator.uniform(np.log(low), np.log(high))))
