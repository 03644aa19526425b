"""What is planted is the law: pair by pair, and sample by sample, by formulas of the tests' own."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from frictioncli.challenge.log_state import log_states
from frictioncli.challenge.logged_run import logged_runs, strokes_of
from frictioncli.challenge.planting import LogTiming, planted_samples
from frictioncli.challenge.shapes import drawn_effect, log_scale
from frictioncli.model.friction import FrictionParameters
from frictioncli.simulator.planted.catalogue import EFFECTS
from tests.found import pairs
from tests.moves import move_sequence, samples

PARAMETERS = FrictionParameters(tau_c=5.0, alpha=0.001, beta=2.0, gamma=3.0, delta=0.03)
TURNS = [0, 170, 0, 170, 0, 150, 20, 150]
SPEEDS = [20, 20, 50, 50, 90, 90, 90]


def friction_at(motion, temperature):
    speed = motion["velocity"].abs()
    return 5.0 + (2.0 + 3.0 * np.exp(-0.03 * temperature)) * np.sqrt(speed)


def log(*, sign=1, name="day1", start=30.0, **columns):
    """A log whose motor warms by 3 °C, with the columns that a table of samples has."""
    motion = move_sequence(TURNS, SPEEDS)
    temperature = start + 3.0 * motion["time"] / motion["time"].iloc[-1]
    frame = samples(
        motion,
        friction_at(motion, temperature),
        sign=sign,
        run=name,
        motor_temperature=temperature,
        **columns,
    )
    empty = ("housing_temperature", "payload", "pose", "other_speed", "other_joints")
    return frame.assign(**{one: np.nan for one in empty if one not in frame}).assign(
        load=frame.get("load", np.nan)
    )


def separated(frame, sign=1):
    """Pairs with friction and load torque by equation (8), as the tests compute it."""
    found = pairs(frame.drop(columns=["other_speed", "other_joints", "pose"])).pairs
    half = sign * (found["torque_forward"] - found["torque_reverse"]) / 2
    mean = (found["torque_forward"] + found["torque_reverse"]) / 2
    return found.assign(friction_torque=half, load_torque=mean)


def states_of(frame, sign=1, unit="N·m"):
    model = SimpleNamespace(friction=PARAMETERS, sign=sign, torque_unit=unit)
    return log_states(logged_runs(frame), separated(frame, sign), model)


def planted(name, frame, magnitude=2.0, *, seed=1, sign=1, **shape):
    """Samples with an effect, and the effect."""
    states = states_of(frame, sign)
    effect = drawn_effect(name, log_scale(separated(frame, sign), states, ["day1"]), seed)
    effect = replace(effect, parameters={**effect.parameters, **shape}).scaled(magnitude)
    return planted_samples(frame, states, effect, sign), effect


def gained(before, after):
    return (after["torque"] - before["torque"]).to_numpy()


def test_the_run_that_is_held_out_comes_last():
    """Of two runs of equal length, the diagnosis learns from the first half of all the time."""
    frame = pd.concat([log(name="day10"), log(name="day9")], ignore_index=True)
    states = states_of(frame)
    assert [state.run.name for state in states] == ["day9", "day10"]
    scale = log_scale(separated(frame), states, ["day9"])
    assert scale.seen == pytest.approx(0.5)


@pytest.mark.parametrize("sign", [1, -1])
def test_friction_of_speed_is_the_law_in_every_pair(sign):
    frame = log(sign=sign)
    after, effect = planted("linear_viscous", frame, sign=sign)
    before, found = separated(frame, sign), separated(after, sign)
    more = found["friction_torque"] - before["friction_torque"]
    rounding = effect.parameters["rounding"]
    law = 2.0 * (np.hypot(before["speed"], rounding) - rounding) / 100
    np.testing.assert_allclose(more, law, rtol=1e-6)
    np.testing.assert_allclose(found["load_torque"], before["load_torque"], atol=1e-9)


def test_friction_of_one_direction_appears_in_the_load():
    frame = log()
    after, effect = planted("direction_asymmetry", frame, constant=1.0)
    before, found = separated(frame), separated(after)
    way = effect.parameters["way"]
    np.testing.assert_allclose(found["load_torque"] - before["load_torque"], 2.0 * way, rtol=1e-9)
    np.testing.assert_allclose(found["friction_torque"], before["friction_torque"], atol=1e-9)


def test_a_spring_on_the_load_is_the_law_at_the_angle_of_the_bin():
    frame = log()
    after, effect = planted("dress_pack", frame, stiffening=0.0)
    before, found = separated(frame), separated(after)
    law = 2.0 * (before["position"] - effect.parameters["rest"]) / 90
    more = found["load_torque"] - before["load_torque"]
    # samples are not spread evenly over a bin
    np.testing.assert_allclose(more, law, atol=0.01)


def test_a_weaker_magnet_scales_the_logged_torque():
    frame = log()
    after, effect = planted("torque_constant", frame, 0.001, curvature=0.0)
    moving = frame["velocity"].abs() > 5.0
    lost = 0.001 * (frame["motor_temperature"] - effect.parameters["reference"])
    np.testing.assert_allclose(
        after["torque"][moving], (frame["torque"] / (1 - lost))[moving], rtol=1e-9
    )


def test_a_current_with_a_load_channel_gets_load_and_friction_apart():
    frame = log()
    load = 90 * np.cos(np.radians(frame["position"]))
    frame = frame.assign(torque=frame["torque"] - load, load=load)
    after, effect = planted("dress_pack", frame, stiffening=0.0)
    law = 2.0 * (frame["position"] - effect.parameters["rest"]) / 90
    np.testing.assert_allclose(after["load"] - frame["load"], law, atol=1e-9)
    np.testing.assert_array_equal(after["torque"], frame["torque"])


def test_planted_torque_is_as_late_as_the_log():
    frame = log()
    states = states_of(frame)
    effect = drawn_effect("stroke_bump", log_scale(separated(frame), states, ["day1"]), 1)
    late = gained(frame, planted_samples(frame, states, effect, 1, LogTiming(delay=0.024)))
    prompt = gained(frame, planted_samples(frame, states, effect, 1))
    # two samples of 12 ms
    np.testing.assert_allclose(late[2:], prompt[:-2], atol=1e-9)


def test_a_filter_keeps_the_mean_and_shifts_by_its_time_constant():
    frame = log()
    states = states_of(frame)
    effect = drawn_effect("stroke_bump", log_scale(separated(frame), states, ["day1"]), 1)
    timing = LogTiming(time_constant=0.04)
    late = gained(frame, planted_samples(frame, states, effect, 1, timing))
    prompt = gained(frame, planted_samples(frame, states, effect, 1))
    stroke = slice(0, 700)  # the first one, forward
    time = frame["time"].to_numpy()[stroke]
    centres = [np.average(time, weights=one[stroke]) for one in (prompt, late)]
    assert late[stroke].sum() == pytest.approx(prompt[stroke].sum(), rel=1e-3)
    assert 0.03 < centres[1] - centres[0] < 0.05


def test_strokes_begin_where_the_joint_starts_and_turn_where_it_comes_back():
    run = logged_runs(log())[0]
    strokes = strokes_of(run, standing=1.0)
    end = np.searchsorted(run.time, 9.0) - 1
    moving = np.abs(run.velocity) > 1.0
    first = np.flatnonzero(moving)[0]
    assert strokes.since_start[first] == 0.0
    middle = np.flatnonzero(moving & (run.time < 9.0))
    np.testing.assert_allclose(
        strokes.since_turn[middle], run.position[middle] - run.position[first], atol=0.1
    )
    back = np.flatnonzero((run.velocity < -1.0) & (run.time < 18.0))
    np.testing.assert_allclose(strokes.since_turn[back], 170 - run.position[back], atol=0.1)
    assert strokes.since_turn[end] > 160


def test_operation_counts_travel_rests_and_motion_that_is_not_logged():
    frame = log()
    # a rest of ten minutes in which the motor cools, and one in which it warms by motion
    parts = [frame, frame, frame]
    length = frame["time"].iloc[-1]
    shifts = [0.0, length + 600.0, 2 * (length + 600.0)]
    warmth = [0.0, -10.5, -8.5]
    together = pd.concat(
        [
            one.assign(
                time=one["time"] + shift,
                recording=f"log{number}",
                motor_temperature=one["motor_temperature"] + warm,
            )
            for number, (one, shift, warm) in enumerate(zip(parts, shifts, warmth, strict=True))
        ],
        ignore_index=True,
    )
    operation = states_of(together)[0].operation
    way = float(np.abs(np.diff(TURNS)).sum())
    unlogged = 600.0 * 90.0
    # the motor is cooler after the first gap, and warmer after none
    assert operation.travel[-1] == pytest.approx(3 * way, rel=1e-2)
    np.testing.assert_allclose(operation.rests[1:], 600.0, atol=2.0)
    together.loc[together["recording"] == "log2", "motor_temperature"] += 20.0
    operation = states_of(together)[0].operation
    assert operation.travel[-1] == pytest.approx(3 * way + unlogged, rel=1e-2)
    assert len(operation.rests) == 2


@pytest.mark.parametrize("name", list(EFFECTS))
def test_every_law_has_a_torque_on_a_log(name):
    frame = log()
    after, _ = planted(name, frame, 0.01)
    more = gained(frame, after)
    assert np.all(np.isfinite(more))
    assert np.any(more != 0.0)


def test_shapes_follow_from_the_log():
    frame = log()
    scale = log_scale(separated(frame), states_of(frame), ["day1"])
    assert scale.speed == pytest.approx(np.sqrt(20 * 90), rel=1e-3)
    assert scale.temperature == pytest.approx((30.0, 33.0))
    small = replace(scale, angle=(0.0, 30.0))
    for seed in range(20):
        assert 0.0 < drawn_effect("stroke_bump", small, seed).parameters["centre"] < 30.0
        order = drawn_effect("position_ripple", small, seed).parameters["order"]
        assert order * 30.0 / 360.0 >= 2.0
    assert (
        drawn_effect("stribeck", scale, 1).parameters
        == drawn_effect("stribeck", scale, 1).parameters
    )
