"""Weak disturbances of torque that no entry of the catalogue describes.

Their size is a share of the mean friction; real joints have several of them at once.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from frictioncli.simulator.nuisances.definition import Nuisances
from frictioncli.simulator.planted.effect import (
    EffectDefinition,
    PlantedEffect,
    Range,
    log_uniform,
    uniform,
)
from frictioncli.simulator.planted.sizes import SizedEffect, scaled_to_size
from frictioncli.simulator.planted.state import AddedTorque, State

ASSUMED = "Assumed; no catalogue entry has this form"

_TURN = 2.0 * math.pi


def _tooth_mesh(
    state: State, *, magnitude: float, order: float, phase: float, second: float
) -> AddedTorque:
    """Friction by meshing teeth, far finer than an angle bin."""
    angle = order * np.radians(state.position) + phase
    return AddedTorque(friction=magnitude * (np.sin(angle) + second * np.sin(2.0 * angle)))


def _ambient_breathing(
    state: State, *, magnitude: float, period: float, phase: float, share: float
) -> AddedTorque:
    """Friction that breathes with the ambient temperature and with the hours."""
    ambient = state.operation.at(state.time, state.operation.ambient)
    warmth = ambient - state.operation.ambient[0]
    slow = np.sin(2.0 * np.pi * state.time / (3600.0 * period) + phase)
    return AddedTorque(friction=magnitude * ((1.0 - share) * slow - share * warmth))


def _speed_offset(
    state: State, *, magnitude: float, exponent: float, crossing: float
) -> AddedTorque:
    """Offset of the torque sensor that changes with the speed, the same in both directions."""
    ratio = (state.speed / crossing) ** exponent
    return AddedTorque(load=magnitude * ratio / (1.0 + ratio))


def _stroke_side(state: State, *, magnitude: float, middle: float, width: float) -> AddedTorque:
    """Friction that is higher on one side of the stroke."""
    return AddedTorque(friction=magnitude * np.tanh((state.position - middle) / width))


def _angle_bump(state: State, *, magnitude: float, centre: float, width: float) -> AddedTorque:
    """Smooth rise of friction around one angle."""
    distance = (state.position - centre) / width
    return AddedTorque(friction=magnitude / (1.0 + distance**4))


def _grease_wave(
    state: State, *, magnitude: float, turns: float, phase: float, second: float
) -> AddedTorque:
    """Friction that comes and goes with the angle turned, as grease moves in the gear."""
    angle = state.travelled / 360.0 / turns + phase
    return AddedTorque(friction=magnitude * (np.sin(angle) + second * np.sin(1.618 * angle)))


def _weak(
    name: str,
    equation: str,
    law: object,
    axes: tuple[str, ...],
    parameters: tuple[Range, ...],
) -> EffectDefinition:
    assert callable(law)
    return EffectDefinition(
        name=name,
        equation=equation,
        magnitude="torque [N·m]",
        parameters=parameters,
        law=law,
        source=ASSUMED,
        listed=False,
        axes=axes,
    )


DISTURBANCES = (
    _weak(
        "tooth_mesh",
        "m (sin(N q + p) + r sin(2 (N q + p))), N high",
        _tooth_mesh,
        ("position",),
        (
            Range("order", uniform(60.0, 180.0), "1/turn", "order N"),
            Range("phase", uniform(0.0, _TURN), "rad", "phase p"),
            Range("second", uniform(0.2, 0.6), "-", "weight r of twice the order"),
        ),
    ),
    _weak(
        "ambient_breathing",
        "m ((1 - w) sin(2 pi t / P + p) - w (Tambient - Tambient(0)))",
        _ambient_breathing,
        ("time",),
        (
            Range("period", uniform(3.0, 9.0), "h", "period P"),
            Range("phase", uniform(0.0, _TURN), "rad", "phase p"),
            Range("share", uniform(0.2, 0.8), "1/K", "weight w of the ambient"),
        ),
    ),
    _weak(
        "speed_offset",
        "m (|v| / vc)^k / (1 + (|v| / vc)^k), on the load",
        _speed_offset,
        ("speed",),
        (
            Range("exponent", uniform(0.8, 1.6), "-", "exponent k"),
            Range("crossing", log_uniform(20.0, 60.0), "deg/s", "speed vc at half the offset"),
        ),
    ),
    _weak(
        "stroke_side",
        "m tanh((q - q0) / w)",
        _stroke_side,
        ("position",),
        (
            Range("middle", uniform(60.0, 120.0), "deg", "angle q0 between the sides"),
            Range("width", uniform(10.0, 40.0), "deg", "width w of the change"),
        ),
    ),
    _weak(
        "angle_bump",
        "m / (1 + ((q - q0) / w)^4)",
        _angle_bump,
        ("position",),
        (
            Range("centre", uniform(40.0, 140.0), "deg", "angle q0"),
            Range("width", uniform(10.0, 30.0), "deg", "width w"),
        ),
    ),
    _weak(
        "grease_wave",
        "m (sin(s / s0 + p) + r sin(1.618 (s / s0 + p))), s travel in turns",
        _grease_wave,
        ("time",),
        (
            Range("turns", log_uniform(20.0, 200.0), "turns", "travel s0 per radian"),
            Range("phase", uniform(0.0, _TURN), "rad", "phase p"),
            Range("second", uniform(0.3, 0.8), "-", "weight r of the second wave"),
        ),
    ),
)
"""Definitions of the weak disturbances."""


def disturbances_of(
    nuisances: Nuisances, states: Sequence[State], sign: int
) -> tuple[SizedEffect, ...]:
    """Return the weak disturbances of a joint, scaled to their shares of its mean friction.

    Parameters
    ----------
    nuisances : Nuisances
        What the joint has.
    states : sequence of State
        The state in the cells over which sizes are taken; the first axis of every array is
        averaged.
    sign : {+1, -1}
        Sign convention of the log.
    """
    present = {one.name: one for one in nuisances.present}
    kinds = [kind for kind in DISTURBANCES if kind.name in present]
    if not kinds:
        return ()
    # as loud in a bin as between bins: the share is that of the torque itself, not of a bin's mean
    samples = [_pointwise(state) for state in states]
    mean = float(np.mean(np.concatenate([np.ravel(state.friction) for state in samples])))
    return tuple(
        scaled_to_size(
            PlantedEffect(kind, 1.0, present[kind.name].parameters),
            (),
            samples,
            sign,
            present[kind.name].size / 100.0 * mean,
        )
        for kind in kinds
    )


def _pointwise(state: State) -> State:
    """Return the state with one leading axis of length 1, so that no points are averaged."""
    arrays = {
        name: getattr(state, name)[None]
        for name in (
            "time",
            "position",
            "velocity",
            "acceleration",
            "since_reversal",
            "load",
            "friction",
            "inertial",
        )
    }
    temperatures = {name: value[None] for name, value in state.temperatures.items()}
    return replace(state, temperatures=temperatures, **arrays)
