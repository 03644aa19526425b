"""A place of the stroke where the joint turns with more effort."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from frictioncli.simulator.planted.effect import PlantedEffect
from frictioncli.simulator.planted.state import Extra, State


@dataclass(frozen=True, slots=True, kw_only=True)
class StrokeBump(PlantedEffect):
    r"""A bump of friction at one angle.

    Attributes
    ----------
    magnitude : float
        Torque at the top. [N·m]
    centre : float
        Angle of the top. [deg]
    width : float
        Width. [deg]

    Notes
    -----
    .. math:: m\,e^{-((q - q_0)/w)^2/2}

    Ranges: angle 50 to 130 deg, width 6 to 20 deg. It comes once per stroke: no ripple has this
    form.
    """

    name: ClassVar[str] = "stroke_bump"
    equation: ClassVar[str] = "m exp(-((q - q0) / w)^2 / 2)"
    listed: ClassVar[bool] = False

    centre: float
    width: float

    @classmethod
    def draw(cls, generator: np.random.Generator) -> Self:
        """Return the effect with random shape parameters."""
        return cls(
            centre=float(generator.uniform(50.0, 130.0)),
            width=float(generator.uniform(6.0, 20.0)),
        )

    def torque(self, state: State) -> Extra:
        """Return the torque that the effect adds [N·m]."""
        distance = (state.position - self.centre) / self.width
        return Extra(friction=self.magnitude * np.exp(-np.square(distance) / 2.0))
