"""Planted effects that no entry of the catalogue describes.

A diagnosis must report them as unexplained. The laws are assumed for this purpose.
"""

import numpy as np

from frictioncli.simulator.planted.effect import (
    EffectDefinition,
    Range,
    log_uniform,
    uniform,
)
from frictioncli.simulator.planted.state import AddedTorque, State

ASSUMED = "Assumed; no catalogue entry has this form"


def _speed_resonance(state: State, *, magnitude: float, centre: float, width: float) -> AddedTorque:
    """Peak of friction at one speed, as at a resonance of the drive train."""
    speed = np.maximum(state.speed, 1e-3)
    distance = np.log(speed / centre) / width
    return AddedTorque(friction=magnitude * np.exp(-np.square(distance) / 2.0))


SPEED_RESONANCE = EffectDefinition(
    name="speed_resonance",
    equation="m exp(-(ln(|v| / v0) / w)^2 / 2)",
    magnitude="torque at the peak [N·m]",
    parameters=(
        Range("centre", log_uniform(15.0, 80.0), "deg/s", "speed v0 of the peak"),
        Range("width", uniform(0.15, 0.4), "-", "width w in the logarithm of speed"),
    ),
    law=_speed_resonance,
    source=ASSUMED,
    listed=False,
)


def _stroke_bump(state: State, *, magnitude: float, centre: float, width: float) -> AddedTorque:
    """Peak of friction at one angle."""
    distance = (state.position - centre) / width
    return AddedTorque(friction=magnitude * np.exp(-np.square(distance) / 2.0))


STROKE_BUMP = EffectDefinition(
    name="stroke_bump",
    equation="m exp(-((q - q0) / w)^2 / 2)",
    magnitude="torque at the peak [N·m]",
    parameters=(
        Range("centre", uniform(50.0, 130.0), "deg", "angle q0 of the peak"),
        Range("width", uniform(6.0, 20.0), "deg", "width w"),
    ),
    law=_stroke_bump,
    source=ASSUMED,
    listed=False,
)


def _cooling_fan(
    state: State, *, magnitude: float, period: float, phase: float, flattening: float
) -> AddedTorque:
    """Slow oscillation of friction in time, as of a fan that goes on and off."""
    swing = np.sin(2.0 * np.pi * state.operated / period + phase)
    flat = np.tanh(flattening * swing) / np.tanh(flattening)
    return AddedTorque(friction=magnitude * flat)


COOLING_FAN = EffectDefinition(
    name="cooling_fan",
    equation="m tanh(c sin(2 pi t / P + p)) / tanh(c)",
    magnitude="amplitude [N·m]",
    parameters=(
        Range("period", uniform(660.0, 2220.0), "s", "period P"),
        Range("phase", uniform(0.0, 6.2831853), "rad", "phase p"),
        Range("flattening", uniform(0.5, 3.0), "-", "c; the larger, the flatter the tops"),
    ),
    law=_cooling_fan,
    source=ASSUMED,
    listed=False,
)


def _position_temperature(
    state: State, *, magnitude: float, angle: float, reference: float
) -> AddedTorque:
    """Friction by angle that grows with temperature, as of a warped housing."""
    warp = np.cos(2.0 * np.radians(state.position - angle))
    return AddedTorque(friction=magnitude * warp * (state.motor - reference) / 20.0)


POSITION_TEMPERATURE = EffectDefinition(
    name="position_temperature",
    equation="m cos(2 (q - q0)) (Tmotor - T0) / 20",
    magnitude="torque at 20 K above the reference [N·m]",
    parameters=(
        Range("angle", uniform(0.0, 360.0), "deg", "angle q0 of the most friction"),
        Range("reference", uniform(35.0, 50.0), "°C", "T0, at which the housing is straight"),
    ),
    law=_position_temperature,
    source=ASSUMED,
    listed=False,
)


def _lifting_loss(state: State, *, magnitude: float, exponent: float) -> AddedTorque:
    """Friction by load that differs between lifting and lowering."""
    lifting = state.direction * np.sign(state.load)
    load = (np.abs(state.load) / 50.0) ** exponent
    return AddedTorque(friction=magnitude * lifting * load)


LIFTING_LOSS = EffectDefinition(
    name="lifting_loss",
    equation="m sign(v L) (|L| / 50)^a",
    magnitude="torque at a load of 50 N·m [N·m]",
    parameters=(
        # far from 1, so that it is not mistaken for an error of the mass
        Range("exponent", uniform(1.5, 2.5), "-", "exponent a of the load"),
    ),
    law=_lifting_loss,
    source=ASSUMED,
    listed=False,
)

UNLISTED_EFFECTS = (
    SPEED_RESONANCE,
    STROKE_BUMP,
    COOLING_FAN,
    POSITION_TEMPERATURE,
    LIFTING_LOSS,
)
"""Definitions in the order of :data:`frictioncli.simulator.planted.catalogue.EFFECTS`."""
