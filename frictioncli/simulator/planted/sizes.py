"""Size of a planted effect: the root mean square of the torque that it adds."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from frictioncli.arrays import Array
from frictioncli.errors import OptionError
from frictioncli.simulator.planted.effect import PlantedEffect
from frictioncli.simulator.planted.state import AddedTorque, State

REVERSAL = 20.0
"""Angle after a reversal within which the size of some effects is taken [deg]."""

_SIZE_TOLERANCE = 1e-4
"""Relative error at which an effect has the requested size."""


@dataclass(frozen=True, slots=True)
class SizedEffect:
    """An effect with its final magnitude.

    Attributes
    ----------
    effect : PlantedEffect
        The effect.
    rms : float
        Root mean square of its torque over the cells in which sizes are taken. [N·m]
    """

    effect: PlantedEffect
    rms: float

    def truth(self) -> dict[str, Any]:
        """Return the true description of the effect, ready for JSON."""
        return self.effect.truth() | {
            "rms": round(self.rms, 6),
            "rms_over": f"first {REVERSAL:g} deg after a reversal"
            if self.effect.definition.at_reversal
            else "all constant velocity",
        }


def added_torque(effects: Iterable[PlantedEffect], state: State) -> AddedTorque:
    """Return the torque that effects add together [N·m].

    An effect that scales the torque acts on the effects before it, too.
    """
    friction, load = np.zeros(state.position.shape), np.zeros(state.position.shape)
    for effect in effects:
        seen = state
        if effect.definition.scales_torque:
            seen = replace(state, friction=state.friction + friction, load=state.load + load)
        added = effect.torque(seen)
        friction, load = friction + added.friction, load + added.load
    return AddedTorque(friction, load)


def scaled_to_size(
    effect: PlantedEffect,
    before: Sequence[PlantedEffect],
    states: Sequence[State],
    sign: int,
    size: float,
) -> SizedEffect:
    """Scale ``effect`` until the root mean square of its torque is ``size``."""
    if effect.definition.scales_torque:
        torques = [added_torque(before, state) for state in states]
        states = [
            replace(state, friction=state.friction + added.friction, load=state.load + added.load)
            for state, added in zip(states, torques, strict=True)
        ]
    for _ in range(100):
        rms = _rms(effect, states, sign)
        if not rms > 0.0:
            raise OptionError(f"effect {effect.name}: the motion of this protocol cannot show it")
        if abs(rms / size - 1.0) < _SIZE_TOLERANCE:
            return SizedEffect(effect, rms)
        effect = effect.scaled(float(np.clip(size / rms, 0.1, 10.0)))
    raise OptionError(
        f"effect {effect.name}: {size:g} N·m is out of its reach in this protocol, "
        f"{rms:.2g} N·m was; choose another size or seed"
    )


def _rms(effect: PlantedEffect, states: Sequence[State], sign: int) -> float:
    squares: list[Array] = []
    for state in states:
        added = effect.torque(state)
        torque = np.mean(added.load + sign * state.direction * added.friction, axis=0)
        if effect.definition.at_reversal:
            torque = torque[np.mean(state.since_turn, axis=0) <= REVERSAL]
        squares.append(np.ravel(torque) ** 2)
    together = np.concatenate(squares)
    return float(np.sqrt(np.mean(together))) if together.size else 0.0
