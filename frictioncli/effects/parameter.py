"""A parameter of an effect of the catalogue: its unit, its physical bounds, its grid."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from frictioncli.arrays import Array
from frictioncli.wording import in_words

Search = Literal["linear", "logarithmic"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameter:
    """A shape parameter or coefficient of an effect, with its physical bounds.

    Attributes
    ----------
    name, symbol, unit : str
        Its name, its symbol in the equation and its unit; ``torque`` stands for the torque unit.
    lower, upper : float
        Physical bounds, in its unit.
    description : str
        What it means.
    search : {"linear", "logarithmic"}
        Spacing of the grid over a shape parameter.
    points : int
        Number of values of the grid, enough not to miss the effect.
    of_load : bool
        Whether the torque in its unit is one of the load though the effect shows in the friction:
        a load channel may have another unit.
    within : str
        Name of another coefficient of the same effect, which is at least as large in amount; may be
        empty.
    of_square_load : bool
        Whether it is that of a torque that grows with the square of the load: on a joint with less
        load more of it is possible.
    noun : str
        What it is called in a sentence; its name if empty.
    """

    name: str
    symbol: str
    unit: str
    lower: float
    upper: float
    description: str
    search: Search = "linear"
    points: int = 10
    of_load: bool = False
    within: str = ""
    of_square_load: bool = False
    noun: str = ""

    def __post_init__(self) -> None:
        if not self.lower < self.upper:
            raise ValueError(f"{self.name}: bounds {self.lower} to {self.upper}")
        if self.search == "logarithmic" and not self.lower > 0:
            raise ValueError(f"{self.name}: a logarithmic search cannot start at {self.lower}")

    @property
    def in_words(self) -> str:
        """What it is called in a sentence."""
        return self.noun or in_words(self.name)

    def grid(self) -> Array:
        """Return the values of the grid from bound to bound, shape (points,)."""
        if self.search == "logarithmic":
            return np.geomspace(self.lower, self.upper, self.points)
        return np.linspace(self.lower, self.upper, self.points)

    def at(self, share: float) -> float:
        """Return the value at a share of the range, on the scale of the search."""
        if self.search == "logarithmic":
            return float(self.lower * (self.upper / self.lower) ** share)
        return float(self.lower + share * (self.upper - self.lower))

    def share(self, value: float) -> float:
        """Return the share of the range at which a value lies, the inverse of :meth:`at`."""
        if self.search == "logarithmic":
            place = np.log(value / self.lower) / np.log(self.upper / self.lower)
        else:
            place = (value - self.lower) / (self.upper - self.lower)
        return float(np.clip(place, 0.0, 1.0))
