"""Definition of a nuisance, and the nuisances of a simulated joint with their true sizes."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from frictioncli.simulator.planted.effect import Draw, Range


@dataclass(frozen=True, slots=True, kw_only=True)
class Nuisance:
    """A kind of nuisance.

    Attributes
    ----------
    name : str
        Its name.
    unit : str
        Unit of its size.
    lowest, highest : float
        Sizes that can be asked for; 0 is none of it.
    draw : callable
        Draws an ordinary size from a random number generator.
    description : str
        What it is, in one line, as the truth document prints it.
    parameters : tuple of Range
        Further values in the order in which they are drawn.
    """

    name: str
    unit: str
    lowest: float
    highest: float
    draw: Draw
    description: str
    parameters: tuple[Range, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class PresentNuisance:
    """A nuisance of a simulated joint or log.

    Attributes
    ----------
    definition : Nuisance
        Its kind.
    size : float
        Its true size, in the unit of the definition.
    parameters : mapping of str to float
        True values of its further parameters.
    """

    definition: Nuisance
    size: float
    parameters: Mapping[str, float] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Its name."""
        return self.definition.name

    def truth(self) -> dict[str, Any]:
        """Return name, unit and true values, ready for JSON."""
        return {
            "name": self.name,
            "description": self.definition.description,
            "size": float(f"{self.size:.9g}"),
            "unit": self.definition.unit,
            "parameters": {name: float(f"{one:.9g}") for name, one in self.parameters.items()},
        }


@dataclass(frozen=True, slots=True, kw_only=True)
class Nuisances:
    """All nuisances of a simulated joint and its logs; false where there are none.

    Attributes
    ----------
    present : tuple of PresentNuisance
        Those whose size is not 0.
    seed : int
        Seed of what differs from recording to recording.
    """

    present: tuple[PresentNuisance, ...] = ()
    seed: int = 0

    def __bool__(self) -> bool:
        return bool(self.present)

    def size(self, name: str) -> float:
        """Return the true size of a nuisance, 0 where it is not present."""
        return next((one.size for one in self.present if one.name == name), 0.0)

    def parameter(self, name: str, parameter: str) -> float:
        """Return a parameter of a nuisance that is present."""
        return next(one.parameters[parameter] for one in self.present if one.name == name)

    def without(self, name: str) -> "Nuisances":
        """Return all but one."""
        return replace(self, present=tuple(one for one in self.present if one.name != name))

    def truth(self) -> list[dict[str, Any]]:
        """Return the true values of all, ready for JSON."""
        return [one.truth() for one in self.present]


NO_NUISANCES = Nuisances()
"""An ideal joint and an ideal log."""
