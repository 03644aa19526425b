"""Drawing effects from a seed and scaling them to the size that is asked for."""

from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from frictioncli.arrays import Array
from frictioncli.errors import OptionError
from frictioncli.simulator.planted.catalogue import EFFECTS, Asked
from frictioncli.simulator.planted.effect import PlantedEffect
from frictioncli.simulator.planted.state import Extra, State

SIZES = (0.5, 2.0)
"""Range from which a size is drawn [N·m]."""

REVERSAL = 20.0
"""Angle after a reversal within which some effects are sized [deg]."""

_STREAM = 1_000_000
"""Keeps the effects' random numbers apart from those of the runs."""

_ENOUGH = 1e-4
"""Relative error at which an effect has its size."""


@dataclass(frozen=True, slots=True)
class Buried:
    """An effect with its final magnitude.

    Attributes
    ----------
    effect : PlantedEffect
        The effect.
    rms : float
        Root mean square of its torque over the cells that count. [N·m]
    """

    effect: PlantedEffect
    rms: float

    def truth(self) -> dict[str, Any]:
        """Return all that is true about it, ready for JSON."""
        return {
            "name": self.effect.name,
            "listed": self.effect.listed,
            "equation": self.effect.equation,
            "parameters": {
                name: float(f"{value:.9g}") for name, value in asdict(self.effect).items()
            },
            "rms": round(self.rms, 6),
            "rms_over": f"first {REVERSAL:g} deg after a reversal"
            if self.effect.at_reversal
            else "all constant velocity",
        }


@dataclass(frozen=True, slots=True)
class Planted:
    """The effects that are hidden in a synthesis."""

    buried: tuple[Buried, ...] = ()

    def extra(self, state: State) -> Extra:
        """Return what all effects add together [N·m]."""
        return added((one.effect for one in self.buried), state)


def added(effects: Iterable[PlantedEffect], state: State) -> Extra:
    """Return what effects add, each that scales the torque seeing those before it [N·m]."""
    friction, load = np.zeros(state.position.shape), np.zeros(state.position.shape)
    for effect in effects:
        seen = state
        if effect.scales_torque:
            seen = replace(state, friction=state.friction + friction, load=state.load + load)
        extra = effect.torque(seen)
        friction, load = friction + extra.friction, load + extra.load
    return Extra(friction, load)


def plant(asked: Sequence[Asked], seed: int, states: Sequence[State], sign: int) -> Planted:
    """Draw the effects that are asked for and give them their sizes.

    Parameters
    ----------
    asked : sequence of Asked
        Names and sizes.
    seed : int
        Source of shapes, and of sizes not given.
    states : sequence of State
        Of each run, the state in the cells over which sizes count; the first axis of every array is
        averaged, the others are cells.
    sign : int
        Sign convention of the log.

    Raises
    ------
    OptionError
        If the motion cannot show an effect, or not in that size.
    """
    buried: list[Buried] = []
    for one in sorted(asked, key=lambda one: EFFECTS[one.name].scales_torque):
        key = (_STREAM, list(EFFECTS).index(one.name))
        generator = np.random.Generator(
            np.random.PCG64(np.random.SeedSequence(seed, spawn_key=key))
        )
        drawn = float(generator.uniform(*SIZES))
        effect = EFFECTS[one.name].draw(generator)
        before = [other.effect for other in buried]
        buried.append(_sized(effect, before, states, sign, drawn if one.size is None else one.size))
    return Planted(tuple(buried))


def _sized(
    effect: PlantedEffect,
    before: Sequence[PlantedEffect],
    states: Sequence[State],
    sign: int,
    size: float,
) -> Buried:
    """Scale ``effect`` until its torque has root mean square ``size``."""
    if effect.scales_torque:
        extras = [added(before, state) for state in states]
        states = [
            replace(state, friction=state.friction + extra.friction, load=state.load + extra.load)
            for state, extra in zip(states, extras, strict=True)
        ]
    for _ in range(100):
        rms = _rms(effect, states, sign)
        if not rms > 0.0:
            raise OptionError(f"effect {effect.name}: the motion of this protocol cannot show it")
        if abs(rms / size - 1.0) < _ENOUGH:
            return Buried(effect, rms)
        effect = effect.scaled(float(np.clip(size / rms, 0.1, 10.0)))
    raise OptionError(
        f"effect {effect.name}: {size:g} N·m is out of its reach in this protocol, "
        f"{rms:.2g} N·m was; choose another size or seed"
    )


def _rms(effect: PlantedEffect, states: Sequence[State], sign: int) -> float:
    squares: list[Array] = []
    for state in states:
        extra = effect.torque(state)
        torque = np.mean(extra.load + sign * state.direction * extra.friction, axis=0)
        if effect.at_reversal:
            torque = torque[np.mean(state.since_turn, axis=0) <= REVERSAL]
        squares.append(np.ravel(torque) ** 2)
    together = np.concatenate(squares)
    return float(np.sqrt(np.mean(together))) if together.size else 0.0
