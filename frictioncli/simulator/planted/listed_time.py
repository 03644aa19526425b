"""Planted effects of time and travel that have a counterpart in the catalogue.

No law equals the counterpart's: the physics is the same, the formula another.
``tests/simulator/test_planted_laws.py`` measures by how much they differ.
"""

import numpy as np

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
from frictioncli.simulator.planted.state import AddedTorque, State


def _drift(state: State, *, magnitude: float, time_constant: float, way: float) -> AddedTorque:
    """Slow drift of friction over the hours of operation, kept overnight."""
    hours = state.operated / 3600.0
    return AddedTorque(friction=way * magnitude * np.log1p(hours / time_constant))


DRIFT = EffectDefinition(
    name="drift",
    equation="s m ln(1 + t / tau), t of operation",
    magnitude="torque gained or lost after 1.7 tau [N·m]",
    parameters=(
        Range("time_constant", log_uniform(0.3, 1.2), "h", "time tau of the fastest change"),
        Range("way", random_sign, "-", "+1: friction grows; -1: it falls"),
    ),
    law=_drift,
    source="Ageing over hours of operation, logarithmic as of creep and of starved grease",
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
        Range("exponent", uniform(0.4, 0.7), "-", "c; the fall begins fast and ends slowly"),
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
    state: State,
    *,
    magnitude: float,
    moment: float,
    duration: float,
    way: float,
    stretch: float,
    noon: float,
    history: str = LASTING,
) -> AddedTorque:
    """Sudden change of friction."""
    done = change_share(
        state, history, moment=moment, stretch=stretch, noon=noon, duration=duration
    )
    return AddedTorque(friction=way * magnitude * done)


STEP_CHANGE = EffectDefinition(
    name="step_change",
    equation=f"s m h(t), {HISTORY_EQUATION}",
    magnitude="torque gained or lost [N·m]",
    parameters=(
        Range("moment", uniform(0.2, 0.8), "-", "t0 as a share of all operation"),
        Range("duration", log_uniform(1.0, 120.0), "s", "width w of the change"),
        Range("way", random_sign, "-", "+1: friction grows; -1: it falls"),
        *HISTORY_PARAMETERS,
    ),
    law=_step_change,
    source="Step at an unknown moment, as of a seal that shifts",
    histories=HISTORIES,
)

TIME_EFFECTS = (
    DRIFT,
    RUN_IN,
    REST_RECOVERY,
    STEP_CHANGE,
)
"""Definitions in the order of :data:`frictioncli.simulator.planted.catalogue.EFFECTS`."""
