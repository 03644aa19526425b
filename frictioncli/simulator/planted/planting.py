"""Drawing planted effects from a seed and scaling them to the requested size."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from frictioncli.simulator.nuisances.definition import NO_NUISANCES, Nuisances
from frictioncli.simulator.nuisances.disturbances import disturbances_of
from frictioncli.simulator.planted.catalogue import EFFECTS, RequestedEffect
from frictioncli.simulator.planted.sizes import SizedEffect, added_torque, scaled_to_size
from frictioncli.simulator.planted.state import AddedTorque, State

SIZES = (0.5, 2.0)
"""Range from which a size is drawn [N·m]."""

_STREAM = 1_000_000
"""Keeps the random numbers of the effects apart from those of the runs."""


@dataclass(frozen=True, slots=True)
class PlantedEffects:
    """All that adds torque in a synthesis.

    Attributes
    ----------
    effects : tuple of SizedEffect
        Effects that were asked for.
    disturbances : tuple of SizedEffect
        Weak disturbances among the nuisances.
    """

    effects: tuple[SizedEffect, ...] = ()
    disturbances: tuple[SizedEffect, ...] = ()

    def __bool__(self) -> bool:
        return bool(self.effects or self.disturbances)

    def torque(self, state: State) -> AddedTorque:
        """Return the torque that all of them add together [N·m]."""
        return added_torque((one.effect for one in (*self.disturbances, *self.effects)), state)


def plant(
    requests: Sequence[RequestedEffect],
    seed: int,
    states: Sequence[State],
    sign: int,
    nuisances: Nuisances = NO_NUISANCES,
) -> PlantedEffects:
    """Draw the requested effects and scale them to their sizes.

    Parameters
    ----------
    requests : sequence of RequestedEffect
        Names and sizes.
    seed : int
        Source of shapes, and of sizes not given.
    states : sequence of State
        For each run, the state in the cells over which sizes are taken. The first axis of every
        array is averaged, the others are cells.
    sign : {+1, -1}
        Sign convention of the log.
    nuisances : Nuisances, optional
        Weak disturbances beside the effects.

    Returns
    -------
    PlantedEffects
        The effects, those that scale the torque last, and the disturbances.

    Raises
    ------
    OptionError
        If the motion cannot show an effect, or not in that size.
    """
    planted: list[SizedEffect] = []
    for request in sorted(requests, key=lambda one: EFFECTS[one.name].scales_torque):
        key = (_STREAM, list(EFFECTS).index(request.name))
        generator = np.random.Generator(
            np.random.PCG64(np.random.SeedSequence(seed, spawn_key=key))
        )
        drawn_size = float(generator.uniform(*SIZES))
        effect = EFFECTS[request.name].draw(generator)
        if request.history:
            effect = replace(effect, history=request.history)
        before = [other.effect for other in planted]
        size = drawn_size if request.size is None else request.size
        planted.append(scaled_to_size(effect, before, states, sign, size))
    return PlantedEffects(tuple(planted), disturbances_of(nuisances, states, sign))
