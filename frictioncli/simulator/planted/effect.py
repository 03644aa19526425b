"""Definition of a planted effect, and an effect with drawn parameters."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from frictioncli.simulator.planted.state import AddedTorque, State

Draw = Callable[[np.random.Generator], float]


@dataclass(frozen=True, slots=True)
class Range:
    """A shape parameter of a planted effect.

    Attributes
    ----------
    name : str
        Name of the law's argument.
    draw : callable
        Draws a value from a random number generator.
    unit : str
        Its unit.
    description : str
        What it is.
    """

    name: str
    draw: Draw
    unit: str
    description: str


@dataclass(frozen=True, slots=True, kw_only=True)
class EffectDefinition:
    """A kind of planted effect.

    Attributes
    ----------
    name : str
        Its name.
    equation : str
        Its law in one line, as the truth document prints it.
    magnitude : str
        What the factor ``magnitude`` of the law is, with its unit in brackets.
    parameters : tuple of Range
        Shape parameters in the order in which they are drawn.
    law : callable
        Pure function of a :class:`State`, ``magnitude`` and the shape parameters that returns the
        :class:`AddedTorque`.
    source : str
        Where the law comes from.
    listed : bool
        Whether the diagnosis has an effect of this name in its catalogue.
    at_reversal : bool
        Whether its size is taken within the first 20 deg after a reversal only.
    scales_torque : bool
        Whether it acts on the torque of all other effects as well.
    axes : tuple of str
        For an unlisted effect, what its torque changes with: ``speed``, ``position``, ``time``,
        ``temperature``, ``load`` or two of them. A diagnosis that locates it names these; with a
        single payload the load is a function of the position, which is then as right.
    histories : tuple of str
        For a change, when it may be there, the default first; its law takes the argument
        ``history``.
    most : float
        Greatest magnitude that nature has, in its unit.
    """

    name: str
    equation: str
    magnitude: str
    parameters: tuple[Range, ...]
    law: Callable[..., AddedTorque]
    source: str
    listed: bool = True
    at_reversal: bool = False
    scales_torque: bool = False
    axes: tuple[str, ...] = ()
    histories: tuple[str, ...] = ()
    most: float = math.inf

    def draw(self, generator: np.random.Generator) -> "PlantedEffect":
        """Return the effect with random shape parameters and magnitude 1."""
        parameters = {one.name: one.draw(generator) for one in self.parameters}
        return PlantedEffect(self, 1.0, parameters, self.histories[0] if self.histories else "")


@dataclass(frozen=True, slots=True)
class PlantedEffect:
    """A planted effect with the values of its parameters.

    Attributes
    ----------
    definition : EffectDefinition
        Its kind.
    magnitude : float
        Factor that sets its size; the definition states its unit.
    parameters : mapping of str to float
        Values of the shape parameters.
    history : str
        When a change is there; empty for an effect that is no change.
    """

    definition: EffectDefinition
    magnitude: float = 1.0
    parameters: Mapping[str, float] = field(default_factory=dict)
    history: str = ""

    @property
    def name(self) -> str:
        """Name of the effect."""
        return self.definition.name

    def scaled(self, factor: float) -> "PlantedEffect":
        """Return the effect with its magnitude multiplied by ``factor``."""
        return replace(self, magnitude=self.magnitude * factor)

    def torque(self, state: State) -> AddedTorque:
        """Return the torque that the effect adds at each sample [N·m]."""
        history = {"history": self.history} if self.history else {}
        return self.definition.law(state, magnitude=self.magnitude, **self.parameters, **history)

    def truth(self) -> dict[str, Any]:
        """Return name, equation and parameter values, ready for JSON."""
        values = {"magnitude": self.magnitude, **self.parameters}
        return {
            "name": self.name,
            "listed": self.definition.listed,
            **({"axes": list(self.definition.axes)} if self.definition.axes else {}),
            **({"history": self.history} if self.history else {}),
            "equation": self.definition.equation,
            "parameters": {name: float(f"{value:.9g}") for name, value in values.items()},
        }


def uniform(low: float, high: float) -> Draw:
    """Return a draw from the uniform distribution between ``low`` and ``high``."""
    return lambda generator: float(generator.uniform(low, high))


def log_uniform(low: float, high: float) -> Draw:
    """Return a draw between ``low`` and ``high`` whose logarithm is uniform."""
    return lambda generator: float(np.exp(generator.uniform(np.log(low), np.log(high))))


def either(first: Draw, second: Draw) -> Draw:
    """Return a draw from one of two distributions with equal probability."""
    return lambda generator: float(generator.choice((first(generator), second(generator))))


def zero_or(other: Draw) -> Draw:
    """Return a draw that is 0 with probability one half, and else comes from ``other``."""
    return lambda generator: float(generator.integers(2)) * other(generator)


def random_sign(generator: np.random.Generator) -> float:
    """Return -1 or +1 with equal probability."""
    return float(generator.choice((-1.0, 1.0)))
