"""Planted effects of time, direction and position that have a counterpart in the catalogue.

No law equals the counterpart's: time is continuous, and changes have a width.
"""

import numpy as np

from frictioncli.simulator.arm import GRAVITY
from frictioncli.simulator.planted.effect import (
    EffectDefinition,
    Range,
    log_uniform,
    random_sign,
    uniform,
)
from frictioncli.simulator.planted.listed_speed_and_load import NEVMERZHITSKIY
from frictioncli.simulator.planted.state import AddedTorque, State


def _drift(state: State, *, magnitude: float, time_constant: float, way: float) -> AddedTorque:
    """Slow drift of friction over the hours of operation, kept overnight."""
    hours = state.operated / 3600.0
    return AddedTorque(friction=-way * magnitude * np.expm1(-hours / time_constant))


DRIFT = EffectDefinition(
    name="drift",
    equation="s m (1 - exp(-t / tau)), t of operation",
    magnitude="torque gained or lost in the end [N·m]",
    parameters=(
        Range("time_constant", log_uniform(3.0, 40.0), "h", "time constant tau"),
        Range("way", random_sign, "-", "+1: friction grows; -1: it falls"),
    ),
    law=_drift,
    source="Ageing of grease over hours of operation, saturating",
)


def _run_in(state: State, *, magnitude: float, turns: float, exponent: float) -> AddedTorque:
    """Running-in: friction that falls with travel, not with time."""
    ratio = state.travelled / 360.0 / turns
    return AddedTorque(friction=magnitude * np.exp(-(ratio**exponent)))


RUN_IN = EffectDefinition(
    name="run_in",
    equation="m exp(-(s / s0)^c), s travel in turns",
    magnitude="torque at the start [N·m]",
    parameters=(
        Range("turns", log_uniform(100.0, 900.0), "turns", "travel constant s0"),
        Range("exponent", uniform(0.7, 1.2), "-", "c; below 1 the fall begins fast"),
    ),
    law=_run_in,
    source="Running-in of lubricated contacts with the angle turned, unrecorded moves included",
)


def _rest_recovery(
    state: State, *, magnitude: float, recovery: float, travel: float
) -> AddedTorque:
    """Friction that is higher after a rest and decays with travel."""
    rest, since = state.operation.last_rest(state.time)
    gained = -np.expm1(-rest / recovery)
    return AddedTorque(friction=magnitude * gained * np.exp(-since / travel))


REST_RECOVERY = EffectDefinition(
    name="rest_recovery",
    equation="m (1 - exp(-rest / tr)) exp(-s / s0), s travel since the rest",
    magnitude="torque after a long rest [N·m]",
    parameters=(
        Range("recovery", log_uniform(200.0, 2400.0), "s", "time constant tr of the rest"),
        Range("travel", log_uniform(300.0, 2500.0), "deg", "travel constant s0 of the decay"),
    ),
    law=_rest_recovery,
    source="Redistribution of grease at rest",
)


def _step_change(
    state: State, *, magnitude: float, moment: float, duration: float, way: float
) -> AddedTorque:
    """Sudden lasting change of friction."""
    since = (state.progress - moment) * state.operation.earlier.total
    done = 0.5 + 0.5 * np.tanh(since / duration)
    return AddedTorque(friction=way * magnitude * done)


STEP_CHANGE = EffectDefinition(
    name="step_change",
    equation="s m (1 + tanh((t - t0) / w)) / 2",
    magnitude="torque gained or lost [N·m]",
    parameters=(
        Range("moment", uniform(0.2, 0.8), "-", "t0 as a share of all operation"),
        Range("duration", log_uniform(1.0, 120.0), "s", "width w of the change"),
        Range("way", random_sign, "-", "+1: friction grows; -1: it falls"),
    ),
    law=_step_change,
    source="Step at an unknown moment, as of a seal that shifts",
)


def _direction_asymmetry(
    state: State,
    *,
    magnitude: float,
    constant: float,
    exponent: float,
    thinning: float,
    way: float,
) -> AddedTorque:
    """Friction that is higher in one direction."""
    thin = np.exp(-thinning * (state.motor - 40.0))
    viscous = (state.speed / 50.0) ** exponent * thin
    law = constant + (1.0 - constant) * viscous
    return AddedTorque(friction=way * magnitude * state.direction * law)


DIRECTION_ASYMMETRY = EffectDefinition(
    name="direction_asymmetry",
    equation="s m sign(v) (w + (1 - w) (|v| / 50)^p exp(-d (Tmotor - 40)))",
    magnitude="torque at 50 deg/s and 40 °C [N·m]",
    parameters=(
        Range("constant", uniform(0.0, 1.0), "-", "share w independent of speed"),
        Range("exponent", uniform(0.3, 0.7), "-", "exponent p of the rest"),
        Range("thinning", uniform(0.02, 0.06), "1/K", "fall of the rest with temperature"),
        Range("way", random_sign, "-", "+1: more friction forward; -1: more backward"),
    ),
    law=_direction_asymmetry,
    source=f"Odd part of equation (8) of {NEVMERZHITSKIY}",
)


def _torque_constant(
    state: State, *, magnitude: float, reference: float, curvature: float
) -> AddedTorque:
    """Torque that is logged with the torque constant of a cold magnet."""
    warmth = state.motor - reference
    lost = magnitude * warmth * (1.0 + curvature * warmth)
    factor = 1.0 / np.maximum(1.0 - lost, 0.05) - 1.0
    return AddedTorque(
        friction=factor * state.friction, load=factor * (state.load + state.inertial)
    )


TORQUE_CONSTANT = EffectDefinition(
    name="torque_constant",
    equation="u / (1 - m (Tmotor - T0) (1 + c (Tmotor - T0))) - u",
    magnitude="loss of the torque constant per kelvin [1/K]",
    parameters=(
        Range("reference", uniform(18.0, 30.0), "°C", "T0, at which the log is right"),
        Range("curvature", uniform(0.0, 0.004), "1/K", "growth c of the loss"),
    ),
    law=_torque_constant,
    source="Reversible temperature coefficient of permanent magnets",
    scales_torque=True,
)


def _payload_change(
    state: State, *, magnitude: float, moment: float, along: float, across: float, way: float
) -> AddedTorque:
    """Mass that is put on or taken off at one moment."""
    mass = np.where(state.progress >= moment, way * magnitude, 0.0)
    angle = np.radians(state.position)
    arm = along * np.cos(angle) - across * np.sin(angle)
    gravity = GRAVITY * mass * arm
    inertia = mass * (along**2 + across**2)
    friction = state.joint.friction(
        load=state.load + gravity, speed=state.speed, temperatures=state.temperatures
    )
    before = state.joint.friction(
        load=state.load, speed=state.speed, temperatures=state.temperatures
    )
    return AddedTorque(
        friction=friction - before, load=gravity + inertia * np.radians(state.acceleration)
    )


PAYLOAD_CHANGE = EffectDefinition(
    name="payload_change",
    equation="from t0 on: s m (g (x cos q - y sin q) + (x^2 + y^2) dv/dt), f(L + dL) - f(L)",
    magnitude="mass [kg]",
    parameters=(
        Range("moment", uniform(0.2, 0.8), "-", "t0 as a share of all operation"),
        Range("along", uniform(0.6, 1.0), "m", "distance x from the axis along the link"),
        Range("across", uniform(-0.1, 0.1), "m", "offset y square to the link"),
        Range("way", random_sign, "-", "+1: put on; -1: taken off"),
    ),
    law=_payload_change,
    source=f"Gravity torque of a point mass; equation (3) of {NEVMERZHITSKIY}",
)


def _dress_pack(state: State, *, magnitude: float, rest: float, stiffening: float) -> AddedTorque:
    """Stiffening spring of hoses and cables."""
    turn = (state.position - rest) / 90.0
    return AddedTorque(load=magnitude * (turn + stiffening * turn**3))


DRESS_PACK = EffectDefinition(
    name="dress_pack",
    equation="m (x + c x^3), x = (q - q0) / 90, on the load",
    magnitude="torque at 90 deg from rest, without stiffening [N·m]",
    parameters=(
        Range("rest", uniform(20.0, 160.0), "deg", "angle q0 without torque"),
        Range("stiffening", uniform(0.1, 1.5), "-", "weight c of the cubic term"),
    ),
    law=_dress_pack,
    source="Stiffening spring of hoses and cables in parallel to the joint",
)


def _position_ripple(
    state: State,
    *,
    magnitude: float,
    order: float,
    phase: float,
    second: float,
    second_phase: float,
) -> AddedTorque:
    """Ripple of friction at a fixed order of the joint angle, with one harmonic."""
    angle = order * np.radians(state.position)
    second_harmonic = second * np.sin(2.0 * angle + second_phase)
    return AddedTorque(friction=magnitude * (np.sin(angle + phase) + second_harmonic))


POSITION_RIPPLE = EffectDefinition(
    name="position_ripple",
    equation="m (sin(N q + p1) + r sin(2 N q + p2))",
    magnitude="amplitude of the first harmonic [N·m]",
    parameters=(
        Range("order", log_uniform(3.0, 23.0), "1/turn", "order N, not whole"),
        Range("phase", uniform(0.0, 6.2831853), "rad", "phase p1"),
        Range("second", uniform(0.0, 0.5), "-", "relative amplitude r of twice the order"),
        Range("second_phase", uniform(0.0, 6.2831853), "rad", "phase p2"),
    ),
    law=_position_ripple,
    source="Angle-periodic friction of gears and bearings",
)


def _inertia(state: State, *, magnitude: float, settling: float) -> AddedTorque:
    """Inertia that is not in the model, and a speed that settles slowly."""
    decay = np.exp(-state.since_reversal / settling)
    settling_acceleration = state.velocity / settling * decay
    return AddedTorque(load=magnitude * np.radians(state.acceleration + settling_acceleration))


INERTIA = EffectDefinition(
    name="inertia",
    equation="m (dv/dt + v / tau exp(-t / tau)) pi / 180, t since the reversal, on the load",
    magnitude="inertia [kg·m²]",
    parameters=(Range("settling", log_uniform(0.15, 0.6), "s", "time constant tau of settling"),),
    law=_inertia,
    source=f"Inertial term of equation (1) of {NEVMERZHITSKIY}, of a speed that settles slowly",
    at_reversal=True,
)


def _reversal_transient(
    state: State, *, magnitude: float, travel: float, exponent: float
) -> AddedTorque:
    """Presliding: friction that has not built up yet after a reversal."""
    ratio = state.since_turn / travel
    return AddedTorque(friction=-magnitude * np.exp(-(ratio**exponent)))


REVERSAL_TRANSIENT = EffectDefinition(
    name="reversal_transient",
    equation="-m exp(-(s / s0)^c), s angle since the reversal",
    magnitude="torque that is missing right after the reversal [N·m]",
    parameters=(
        Range("travel", log_uniform(4.0, 15.0), "deg", "angle s0 over which friction returns"),
        Range("exponent", uniform(0.8, 1.3), "-", "exponent c"),
    ),
    law=_reversal_transient,
    source=(
        "Presliding, build-up after Dahl; survey: Armstrong-Hélouvry et al. 1994,"
        " doi:10.1016/0005-1098(94)90209-7"
    ),
    at_reversal=True,
)

TIME_AND_POSITION_EFFECTS = (
    DRIFT,
    RUN_IN,
    REST_RECOVERY,
    STEP_CHANGE,
    DIRECTION_ASYMMETRY,
    TORQUE_CONSTANT,
    PAYLOAD_CHANGE,
    DRESS_PACK,
    POSITION_RIPPLE,
    INERTIA,
    REVERSAL_TRANSIENT,
)
"""Definitions in the order of :data:`frictioncli.simulator.planted.catalogue.EFFECTS`."""
