"""Each planted effect against its equation, worked out by hand at one state."""

from dataclasses import replace
from math import cos, cosh, exp, hypot, log, pi, radians, sin, sqrt, tanh

import numpy as np
import pytest

from frictioncli.simulator import default_joint
from frictioncli.simulator.plain_joint import plain_joint
from frictioncli.simulator.planted.catalogue import EFFECTS
from frictioncli.simulator.planted.listed_speed_and_load import gear_minus_motor
from frictioncli.simulator.planted.operating_history import EarlierRuns, OperatingHistory
from frictioncli.simulator.planted.state import State

# q 30 deg, v -50 deg/s, motor 60, gear 50, housing 45 degC, load 80 and friction 40 N·m,
# 2 h into a run of 4 h that follows a run of 4 h, 36000 deg turned in it and 36000 before.
ARM = default_joint.joint(payload=2.0, motor_heat_share=0.5).arm
JOINT = plain_joint(arm=ARM, servo=default_joint.SERVO, motor_heat_share=0.5)
GRID = np.arange(0.0, 14401.0, 10.0)
OPERATION = OperatingHistory(
    earlier=EarlierRuns(operated=14400.0, travelled=36000.0, total=28800.0),
    angles=(0.0, 180.0),
    times=GRID,
    temperatures={name: np.full(GRID.shape, 60.0) for name in ("motor sensor", "gear", "housing")},
    ambient=np.full(GRID.shape, 20.0),
    heat=np.full(GRID.shape, 100.0),
    edges=np.array([0.0, 7200.0, 14400.0]),
    travel=np.array([0.0, 36000.0, 36000.0]),
    rest_ends=np.array([0.0, 7000.0]),
    rests=np.array([43200.0, 600.0]),
)


def one(value: float) -> np.ndarray:
    return np.array([value])


STATE = State(
    joint=JOINT,
    operation=OPERATION,
    time=one(7200.0),
    position=one(30.0),
    velocity=one(-50.0),
    acceleration=one(10.0),
    since_reversal=one(3.0),
    temperatures={"motor sensor": one(60.0), "gear": one(50.0), "housing": one(45.0)},
    load=one(80.0),
    friction=one(40.0),
    inertial=one(2.0),
)
GRAVITY = 9.81 * (0.8 * cos(pi / 6) - 0.1 * sin(pi / 6))
HOT = 60.0 - 40.0
LOST = 0.001 * 40.0 * (1 + 0.002 * 40.0)

UNUSED = {"stretch": 0.2, "noon": 0.5}

CASES = {
    "stribeck": (
        {"velocity": 20.0, "exponent": 1.4, "shift": 0.01},
        2 / (1 + (2.5 * exp(-0.1)) ** 1.4),
        0.0,
    ),
    "velocity_exponent": (
        {"exponent": 0.8, "bend": 0.02, "crossing": 25.0, "floor": 0.4, "thinning": 0.05},
        2 * (0.4 + 0.6 * exp(-0.05 * HOT)) * (2.0 ** (0.8 + 0.02 * log(2.0)) - sqrt(2.0)),
        0.0,
    ),
    "linear_viscous": ({"rounding": 3.0}, 2 * (hypot(50.0, 3.0) - 3.0) / 100.0, 0.0),
    "quadratic_drag": (
        {"exponent": 2.1, "thinning": 0.008},
        2 * 0.5**2.1 * exp(-0.08),
        0.0,
    ),
    "coulomb_temperature": (
        {"rate": 0.01, "reference": 35.0},
        2 * (exp(-0.25) - 1.0),
        0.0,
    ),
    "load_linear": ({"rounding": 4.0}, 2 * (hypot(80.0, 4.0) - 4.0) / 50.0, 0.0),
    "load_velocity": ({"load_exponent": 1.8, "speed_exponent": 0.6}, 2 * 1.6**1.8, 0.0),
    "load_temperature": (
        {"reference": 45.0, "width": 30.0},
        -2 * 1.6**2 * tanh(0.5),
        0.0,
    ),
    "drift": ({"time_constant": 12.0, "way": -1.0}, -2 * log(1.5), 0.0),
    "run_in": ({"turns": 400.0, "exponent": 0.8}, 2 * exp(-(0.5**0.8)), 0.0),
    "rest_recovery": (
        {"recovery": 300.0, "travel": 500.0},
        2 * (1 - exp(-2.0)) * exp(-1000.0 / 500.0),
        0.0,
    ),
    "step_change": (
        {"moment": 0.7, "duration": 1000.0, "way": 1.0, **UNUSED},
        2 * (0.5 + 0.5 * tanh((21600.0 - 20160.0) / 1000.0)),
        0.0,
    ),
    "direction_asymmetry": (
        {"constant": 0.3, "exponent": 1.2, "thinning": 0.04, "way": 1.0},
        -2 * (0.3 + 0.7 * exp(-0.8)),
        0.0,
    ),
    "payload_change": (
        {"moment": 0.5, "along": 0.8, "across": 0.1, "way": 1.0, **UNUSED},
        0.0014 * ((80.0 + 2 * GRAVITY) ** 2 - 80.0**2),
        2 * (GRAVITY + 0.65 * radians(10.0)),
    ),
    "dress_pack": (
        {"rest": 120.0, "slack": 0.4, "stiffening": 1.6},
        0.0,
        2 * (-1.0 - 1.6 * 0.6**1.5),
    ),
    "position_ripple": (
        {
            "order": 7.3,
            "phase": 0.4,
            "second": 0.2,
            "second_phase": 1.1,
            "third": 0.06,
            "modulation": 0.05,
        },
        2
        * (1 + 0.05 * cos(pi / 6 + 1.1))
        * (
            sin(7.3 * pi / 6 + 0.4)
            + 0.2 * sin(14.6 * pi / 6 + 1.1)
            + 0.06 * sin(21.9 * pi / 6 + 1.2)
        ),
        0.0,
    ),
    "inertia": (
        {"settling": 1.5},
        0.0,
        2 * radians(10.0 - 50.0 / 1.5 * exp(-2.0)),
    ),
    "reversal_transient": (
        {"travel": 100.0, "exponent": 3.5},
        -2 / 2.5**3.5,
        0.0,
    ),
    "speed_resonance": (
        {"centre": 40.0, "width": 0.3},
        2 * exp(-((log(1.25) / 0.3) ** 2) / 2),
        0.0,
    ),
    "stroke_bump": ({"centre": 40.0, "width": 8.0}, 2 * exp(-(1.25**2) / 2), 0.0),
    "cooling_fan": (
        {"period": 900.0, "phase": 0.5, "flattening": 2.0},
        2 * tanh(2 * sin(2 * pi * 24 + 0.5)) / tanh(2.0),
        0.0,
    ),
    "position_temperature": (
        {"angle": 75.0, "reference": 50.0},
        2 * cos(pi / 2) * 0.5,
        0.0,
    ),
    "lifting_loss": ({"exponent": 1.7}, -2 * 1.6**1.7, 0.0),
    "temperature_band": ({"centre": 54.0, "width": 3.0}, 2 / cosh(2.0), 0.0),
    "moving_resonance": (
        {"centre": 40.0, "width": 0.4, "shift": 0.02},
        2 / (1 + ((log(1.25) - 0.3) / 0.4) ** 2),
        0.0,
    ),
    "position_speed": (
        {"angle": 0.0, "crossing": 25.0},
        2 * sin(pi / 3) * tanh(log(2.0)),
        0.0,
    ),
    "load_band": ({"centre": 60.0, "width": 10.0}, 2 * exp(-2.0), 0.0),
}


def torque(name: str, state: State = STATE, **parameters: float) -> tuple[float, float]:
    added = EFFECTS[name].law(state, **parameters)
    return float(np.sum(added.friction)), float(np.sum(added.load))


@pytest.mark.parametrize("name", CASES)
def test_torque_is_that_of_the_equation(name):
    parameters, friction, load = CASES[name]
    assert torque(name, magnitude=2.0, **parameters) == pytest.approx((friction, load), abs=1e-9)


@pytest.mark.parametrize("name", CASES)
def test_torque_at_rest_is_a_number(name):
    """At a reversal the velocity passes through zero."""
    found = torque(name, replace(STATE, velocity=one(0.0)), magnitude=2.0, **CASES[name][0])
    assert np.isfinite(found).all()


@pytest.mark.parametrize("name", ["step_change", "payload_change"])
def test_a_change_lasts_or_vanishes_or_recurs(name):
    others = {"duration": 1.0} if name == "step_change" else {"along": 0.8, "across": 0.1}
    # the state is at 3/4 of all operation, and in the middle of its run
    for history, moment, stretch, noon, there in (
        ("lasting", 0.7, 0.01, 0.9, True),
        ("lasting", 0.8, 0.01, 0.1, False),
        ("vanishing", 0.7, 0.1, 0.9, True),
        ("vanishing", 0.5, 0.2, 0.1, False),
        ("recurring", 0.9, 0.1, 0.4, True),
        ("recurring", 0.1, 0.9, 0.6, False),
    ):
        parameters = {"moment": moment, "stretch": stretch, "noon": noon, "way": 1.0, **others}
        added = EFFECTS[name].law(STATE, magnitude=2.0, history=history, **parameters)
        assert (abs(float(np.sum(added.friction))) > 1.0) is there


def test_weak_magnet_multiplies_the_whole_torque():
    factor = 1 / (1 - LOST) - 1
    expected = (factor * 40.0, factor * 82.0)
    found = torque("torque_constant", magnitude=0.001, reference=20.0, curvature=0.002)
    assert found == pytest.approx(expected)


def test_gear_that_lags_keeps_the_motor_s_old_temperature():
    # The motor rises by 0.01 K/s; after long the gear is 0.01 K/s times 300 s behind.
    ramp = replace(OPERATION, temperatures={"motor sensor": 20.0 + 0.01 * GRID})
    gear = {"magnitude": 5.0, "heating": 0.0, "loss": 1e12, "stirring": 0.0}
    assert gear_minus_motor(ramp, **gear)[720] == pytest.approx(-3.0, abs=0.01)
    viscous = 15.66 * (exp(-0.056 * 57.0) - exp(-0.056 * 60.0)) * sqrt(50.0)
    lagging = torque("thermal_lag", replace(STATE, operation=ramp), **gear)
    assert lagging[0] == pytest.approx(viscous, rel=0.01)


def test_gear_that_is_heated_is_warmer_than_its_motor():
    # 0.1 K/kJ times 100 W is 0.01 K/s, in equilibrium with a difference of 3 K over 300 s.
    heated = {"magnitude": 5.0, "heating": 0.1, "loss": 1e12, "stirring": 0.0}
    assert gear_minus_motor(OPERATION, **heated)[720] == pytest.approx(3.0, abs=0.01)
    assert torque("thermal_lag", **heated)[0] < 0.0
    # stirred, the same heat flows at a smaller difference
    stirred = heated | {"stirring": 0.5}
    assert gear_minus_motor(OPERATION, **stirred)[720] == pytest.approx(2.0, abs=0.01)
    cooled = {"magnitude": 5.0, "heating": 0.0, "loss": 45.0, "stirring": 0.0}
    # A tenth of the conductance leads to an ambient that is 40 K colder.
    assert gear_minus_motor(OPERATION, **cooled)[720] == pytest.approx(-4.0, abs=0.01)


def test_plain_joint_is_equation_16_with_the_published_numbers():
    for load, speed, warmth in ((0.0, 101.2, 25.0), (-80.0, 2.3, 65.0), (120.0, 39.4, 40.0)):
        at = dict.fromkeys(("motor sensor", "gear", "housing"), warmth)
        found = JOINT.friction(load=load, speed=speed, temperatures=at)
        viscous = (3.48 + 15.66 * exp(-0.056 * warmth)) * sqrt(speed)
        assert float(found) == pytest.approx(10.57 + 0.0014 * load**2 + viscous, rel=1e-12)


def test_every_effect_is_worked_out_here():
    assert {*CASES, "torque_constant", "thermal_lag"} == set(EFFECTS)


@pytest.mark.parametrize("name", EFFECTS)
def test_shapes_differ_from_seed_to_seed_and_repeat(name):
    draws = [EFFECTS[name].draw(np.random.default_rng(seed)) for seed in (1, 2, 1)]
    assert draws[0] == draws[2] != draws[1]
    assert draws[0].magnitude == 1.0
    assert draws[0].scaled(2.0).magnitude == 2.0


def test_catalogue_has_the_contract_s_names_and_more():
    listed = [name for name, effect in EFFECTS.items() if effect.listed]
    assert len(listed) == 20
    assert len(EFFECTS) - len(listed) >= 8
    known = {"speed", "position", "time", "temperature", "load"}
    for effect in EFFECTS.values():
        assert bool(effect.axes) is not effect.listed
        assert set(effect.axes) <= known
    assert {"thermal_lag", "position_ripple", "reversal_transient"} <= set(listed)
    assert all(
        effect.name == name and effect.equation and effect.source
        for name, effect in EFFECTS.items()
    )
