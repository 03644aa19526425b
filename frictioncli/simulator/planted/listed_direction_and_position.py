"""Planted effects of direction and position that have a counterpart in the catalogue.

No law equals the counterpart's: the physics is the same, the formula another.
``tests/simulator/test_planted_laws.py`` measures by how much they differ.
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
from frictioncli.simulator.planted.history_of_change import (
    HISTORIES,
    HISTORY_EQUATION,
    HISTORY_PARAMETERS,
    LASTING,
    change_share,
)
from frictioncli.simulator.planted.listed_speed_and_load import NEVMERZHITSKIY
from frictioncli.simulator.planted.state import AddedTorque, State

_FERRITE = 0.002
"""Temperature coefficient of ferrite, greater than that of other permanent magnets. [1/K]"""


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
    ratio = (state.speed / 50.0) ** exponent
    viscous = 2.0 * ratio / (1.0 + ratio) * thin
    law = constant + (1.0 - constant) * viscous
    return AddedTorque(friction=way * magnitude * state.direction * law)


DIRECTION_ASYMMETRY = EffectDefinition(
    name="direction_asymmetry",
    equation="s m sign(v) (w + (1 - w) 2 x / (1 + x) exp(-d (Tmotor - 40))), x = (|v| / 50)^p",
    magnitude="torque at 50 deg/s and 40 °C [N·m]",
    parameters=(
        Range("constant", uniform(0.0, 0.5), "-", "share w independent of speed"),
        Range("exponent", uniform(0.8, 1.1), "-", "exponent p of the rest"),
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
    most=_FERRITE,
)


def _payload_change(
    state: State,
    *,
    magnitude: float,
    moment: float,
    along: float,
    across: float,
    way: float,
    stretch: float,
    noon: float,
    history: str = LASTING,
) -> AddedTorque:
    """Mass that is put on or taken off."""
    mass = way * magnitude * change_share(state, history, moment=moment, stretch=stretch, noon=noon)
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
    equation=(
        "M (g (x cos q - y sin q) + (x^2 + y^2) dv/dt), f(L + dL) - f(L), M = s m h(t),"
        f" {HISTORY_EQUATION}"
    ),
    magnitude="mass [kg]",
    parameters=(
        Range("moment", uniform(0.2, 0.8), "-", "t0 as a share of all operation"),
        Range("along", uniform(0.6, 1.0), "m", "distance x from the axis along the link"),
        Range("across", uniform(-0.1, 0.1), "m", "offset y square to the link"),
        Range("way", random_sign, "-", "+1: put on; -1: taken off"),
        *HISTORY_PARAMETERS,
    ),
    law=_payload_change,
    source=f"Gravity torque of a point mass; equation (3) of {NEVMERZHITSKIY}",
    histories=HISTORIES,
)


def _dress_pack(
    state: State, *, magnitude: float, rest: float, slack: float, stiffening: float
) -> AddedTorque:
    """Soft spring of hoses and cables, which stiffens where they come to lie against the arm."""
    turn = (state.position - rest) / 90.0
    beyond = np.maximum(np.abs(turn) - slack, 0.0)
    return AddedTorque(load=magnitude * (turn + stiffening * np.sign(turn) * beyond**1.5))


DRESS_PACK = EffectDefinition(
    name="dress_pack",
    equation="m (x + c sign(x) max(|x| - x0, 0)^1.5), x = (q - q0) / 90, on the load",
    magnitude="torque at 90 deg from rest, without stiffening [N·m]",
    parameters=(
        Range("rest", uniform(20.0, 160.0), "deg", "angle q0 without torque"),
        Range("slack", uniform(0.2, 0.5), "-", "turn x0 beyond which it stiffens"),
        Range("stiffening", uniform(1.2, 2.4), "-", "weight c of the stiff part"),
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
    third: float,
    modulation: float,
) -> AddedTorque:
    """Ripple of friction at a fixed order of the joint angle, as of a gear that wobbles a little.

    It is no sine, and its amplitude changes once per turn.
    """
    angle = order * np.radians(state.position)
    wave = (
        np.sin(angle + phase)
        + second * np.sin(2.0 * angle + second_phase)
        + third * np.sin(3.0 * (angle + phase))
    )
    wobble = 1.0 + modulation * np.cos(np.radians(state.position) + second_phase)
    return AddedTorque(friction=magnitude * wobble * wave)


POSITION_RIPPLE = EffectDefinition(
    name="position_ripple",
    equation=("m (1 + w cos(q + p2)) (sin(N q + p1) + r sin(2 N q + p2) + u sin(3 (N q + p1)))"),
    magnitude="amplitude of the first harmonic [N·m]",
    parameters=(
        Range("order", log_uniform(3.0, 23.0), "1/turn", "order N, not whole"),
        Range("phase", uniform(0.0, 6.2831853), "rad", "phase p1"),
        Range("second", uniform(0.0, 0.5), "-", "relative amplitude r of twice the order"),
        Range("second_phase", uniform(0.0, 6.2831853), "rad", "phase p2"),
        Range("third", uniform(0.04, 0.08), "-", "relative amplitude u of three times the order"),
        Range("modulation", uniform(0.02, 0.08), "-", "change w of the amplitude over a turn"),
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
    return AddedTorque(friction=-magnitude / (1.0 + ratio) ** exponent)


REVERSAL_TRANSIENT = EffectDefinition(
    name="reversal_transient",
    equation="-m / (1 + s / s0)^c, s angle since the reversal",
    magnitude="torque that is missing right after the reversal [N·m]",
    parameters=(
        Range("travel", log_uniform(10.0, 40.0), "deg", "angle s0 over which friction returns"),
        Range("exponent", uniform(3.0, 5.0), "-", "exponent c"),
    ),
    law=_reversal_transient,
    source=(
        "Presliding, build-up by Dahl's equation with an exponent of 1 + 1/c; survey:"
        " Armstrong-Hélouvry et al. 1994, doi:10.1016/0005-1098(94)90209-7"
    ),
    at_reversal=True,
)

DIRECTION_AND_POSITION_EFFECTS = (
    DIRECTION_ASYMMETRY,
    TORQUE_CONSTANT,
    PAYLOAD_CHANGE,
    DRESS_PACK,
    POSITION_RIPPLE,
    INERTIA,
    REVERSAL_TRANSIENT,
)
"""Definitions in the order of :data:`frictioncli.simulator.planted.catalogue.EFFECTS`."""
