"""Planted effects that no entry of the catalogue describes.

A diagnosis must report them as unexplained, and tell on which axes they show: those that each
definition states. The laws are assumed for this purpose.
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
    axes=("speed",),
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
    axes=("position",),
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
    axes=("time",),
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
    axes=("position", "temperature"),
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
    axes=("load",),
)


def _temperature_band(
    state: State, *, magnitude: float, centre: float, width: float
) -> AddedTorque:
    """Friction that is higher at one temperature, as where a thickener softens."""
    distance = (state.motor - centre) / width
    return AddedTorque(friction=magnitude / np.cosh(distance))


TEMPERATURE_BAND = EffectDefinition(
    name="temperature_band",
    equation="m / cosh((Tmotor - T0) / w)",
    magnitude="torque at the peak [N·m]",
    parameters=(
        Range("centre", uniform(38.0, 52.0), "°C", "temperature T0 of the peak"),
        Range("width", uniform(1.5, 4.0), "K", "width w"),
    ),
    law=_temperature_band,
    source=ASSUMED,
    listed=False,
    axes=("temperature",),
)


def _moving_resonance(
    state: State, *, magnitude: float, centre: float, width: float, shift: float
) -> AddedTorque:
    """Peak of friction at a speed that grows as the lubricant thins."""
    speed = np.maximum(state.speed, 1e-3)
    distance = (np.log(speed / centre) - shift * (state.motor - 45.0)) / width
    return AddedTorque(friction=magnitude / (1.0 + np.square(distance)))


MOVING_RESONANCE = EffectDefinition(
    name="moving_resonance",
    equation="m / (1 + ((ln(|v| / v0) - c (Tmotor - 45)) / w)^2)",
    magnitude="torque at the peak [N·m]",
    parameters=(
        Range("centre", log_uniform(30.0, 60.0), "deg/s", "speed v0 of the peak at 45 °C"),
        Range("width", uniform(0.25, 0.5), "-", "width w in the logarithm of speed"),
        Range("shift", uniform(0.03, 0.06), "1/K", "shift c with the temperature"),
    ),
    law=_moving_resonance,
    source=ASSUMED,
    listed=False,
    axes=("speed", "temperature"),
)


def _position_speed(
    state: State, *, magnitude: float, angle: float, crossing: float
) -> AddedTorque:
    """Friction by angle that turns over with speed, as of grease that is thrown about."""
    wave = np.sin(2.0 * np.radians(state.position - angle))
    turned = np.tanh(np.log(np.maximum(state.speed, 1e-3) / crossing))
    return AddedTorque(friction=magnitude * wave * turned)


POSITION_SPEED = EffectDefinition(
    name="position_speed",
    equation="m sin(2 (q - q0)) tanh(ln(|v| / vc))",
    magnitude="amplitude at high speed [N·m]",
    parameters=(
        Range("angle", uniform(0.0, 360.0), "deg", "angle q0 without change"),
        Range("crossing", log_uniform(25.0, 60.0), "deg/s", "speed vc without change"),
    ),
    law=_position_speed,
    source=ASSUMED,
    listed=False,
    axes=("position", "speed"),
)


def _load_band(state: State, *, magnitude: float, centre: float, width: float) -> AddedTorque:
    """Friction that is higher at one amount of load, as where a bearing's clearance closes."""
    distance = (np.abs(state.load) - centre) / width
    return AddedTorque(friction=magnitude * np.exp(-np.square(distance) / 2.0))


LOAD_BAND = EffectDefinition(
    name="load_band",
    equation="m exp(-((|L| - L0) / w)^2 / 2)",
    magnitude="torque at the peak [N·m]",
    parameters=(
        Range("centre", uniform(25.0, 60.0), "N·m", "load L0 of the peak"),
        Range("width", uniform(5.0, 12.0), "N·m", "width w"),
    ),
    law=_load_band,
    source=ASSUMED,
    listed=False,
    axes=("load",),
)

UNLISTED_EFFECTS = (
    SPEED_RESONANCE,
    STROKE_BUMP,
    COOLING_FAN,
    POSITION_TEMPERATURE,
    LIFTING_LOSS,
    TEMPERATURE_BAND,
    MOVING_RESONANCE,
    POSITION_SPEED,
    LOAD_BAND,
)
"""Definitions in the order of :data:`frictioncli.simulator.planted.catalogue.EFFECTS`."""
