"""Durations, payload changes, limits and blocks, by other routes."""

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from frictioncli.design.blocks import Block, all_blocks
from frictioncli.design.limits import Limits, limits_of
from frictioncli.design.selection import chosen, seconds_of, steps_of
from frictioncli.design.settings import PlanSettings
from frictioncli.design.steps import (
    ACCELERATION,
    DWELL,
    MOUNTING,
    HeatStep,
    RestStep,
    SeriesStep,
    mountings,
    round_trip,
)
from frictioncli.errors import OptionError


def torques(*, low=-40.0, high=80.0, speeds=(5.0, 50.0), warm=30.0):
    centres = np.arange(low + 2.5, high, 5.0)
    return pd.DataFrame(
        [
            {"position": centre, "speed": speed, "motor_temperature": warm}
            for speed in speeds
            for centre in centres
        ]
    )


@given(speed=st.floats(1.0, 300.0), stroke=st.floats(5.0, 360.0))
def test_a_round_trip_lasts_as_long_as_its_speed_profile(speed, stroke):
    """Integrated in small steps: accelerate, hold, brake so that the end is reached standing."""
    step, at, velocity, elapsed = 2e-4 * stroke / min(speed, 20.0), 0.0, 0.0, 0.0
    while at < stroke * (1 - 1e-6):
        braking = np.sqrt(2 * ACCELERATION * (stroke - at))
        velocity = min(velocity + ACCELERATION * step, speed, braking)
        at += velocity * step
        elapsed += step
        if elapsed > 2 * stroke / speed + 20.0:
            break
    assert round_trip(speed, stroke) / 2 - DWELL == pytest.approx(elapsed, rel=0.03, abs=0.03)


def test_payload_changes_are_where_the_payload_changes():
    def series(payload):
        return SeriesStep(speeds=(10.0,), low=0.0, high=50.0, payload=payload)

    steps = [series(None), series(5.0), RestStep(10.0), series(5.0), series(0.0), series(None)]
    assert list(mountings(steps, 0.0)) == [False, True, False, False, True, False]


def test_limits_are_those_of_the_data():
    found = limits_of(torques(), PlanSettings())
    assert (found.low, found.high) == (-40.0, 80.0)
    assert found.fastest == 50.0
    assert found.slowest == pytest.approx(50.0 / 60)  # slower moves endanger nothing
    assert found.hottest == 65.0
    assert limits_of(torques(warm=71.0), PlanSettings()).hottest == 71.0
    assert not found.beyond


def test_limits_beyond_the_data_are_said():
    asked = PlanSettings(low=-60.0, high=80.0, max_speed=75.0)
    found = limits_of(torques(), asked)
    assert (found.low, found.fastest) == (-60.0, 75.0)
    assert [text.split()[0] for text in found.beyond] == ["--from", "--max-speed"]


@pytest.mark.parametrize(
    "asked",
    [
        {"low": 50.0, "high": 50.0},
        {"low": 10.0, "high": -10.0},
        {"low": -361.0},
        {"high": 400.0},
        {"max_speed": 0.0},
        {"max_speed": 361.0},
        {"max_temperature": 120.0},
        {"minutes": 1.0},
        {"minutes": float("nan")},
        {"payload": (-1.0,)},
        {"to": "gcode"},
        {"to": "krl"},
        {"joint": 7},
    ],
)
def test_unsafe_or_senseless_options_are_refused(asked):
    with pytest.raises(OptionError):
        PlanSettings(**asked)


@pytest.mark.parametrize(
    "asked",
    [
        {"low": 75.0},  # five degrees are left
        {"rated_speed": 40.0},  # 50 deg/s were measured
    ],
)
def test_limits_that_contradict_the_data(asked):
    with pytest.raises(OptionError):
        limits_of(torques(), PlanSettings(**asked))


def test_the_highest_speed_may_be_below_all_that_were_measured():
    found = limits_of(torques(), PlanSettings(max_speed=2.0))
    assert found.slowest < found.fastest == 2.0


def test_the_fastest_of_a_series_has_room_to_hold_its_speed():
    """By hand: 90 deg at 200 deg/s² leave a third of the way at sqrt(200 * 60) = 109.5 deg/s."""
    limits = Limits(low=0.0, high=90.0, slowest=3.0, fastest=180.0, hottest=60.0)
    speeds = limits.speeds(4, slowest=9.0)
    assert len(speeds) == 4
    assert speeds[0] == pytest.approx(9.0, rel=0.01)
    assert speeds[-1] == pytest.approx(109.5, rel=0.01)
    assert np.diff(np.log(speeds)) == pytest.approx(np.log(109.5 / 9.0) / 3, rel=0.02)


@given(
    low=st.floats(-180.0, 0.0),
    stroke=st.floats(15.0, 180.0),
    fastest=st.floats(5.0, 300.0),
    share=st.floats(0.01, 1.0),
    rated=st.one_of(st.none(), st.floats(100.0, 400.0)),
)
def test_no_block_ever_leaves_its_limits(low, stroke, fastest, share, rated):
    step = None if rated is None else rated / 100
    if step is not None and fastest < step:
        return
    limits = Limits(
        low=low,
        high=low + stroke,
        slowest=fastest * share,
        fastest=fastest,
        hottest=60.0,
        payloads=(3.0,),
        speed_step=step,
    )
    for block in all_blocks(limits, 0):
        for one in block.steps:
            if isinstance(one, RestStep):
                continue
            assert limits.low - 1e-9 <= one.low < one.high <= limits.high + 1e-9
            speeds = one.speeds if isinstance(one, SeriesStep) else (one.speed,)
            assert all(0 < speed <= fastest * (1 + 1e-9) for speed in speeds)
            if isinstance(one, HeatStep):
                assert one.until == 60.0


def _named(name, seconds):
    return Block(name=name, reason="", steps=(RestStep(seconds),))


def test_the_choice_finds_the_best_programme_of_all():
    """Against all sequences: what counts is the number of distinct rests, and their total."""
    candidates = [_named("a", 100.0), _named("b", 170.0), _named("c", 230.0), _named("d", 60.0)]

    def worth(steps):
        return 100.0 * len({step.seconds for step in steps}) + sum(s.seconds for s in steps)

    budget = 500.0
    best, sequences = 0.0, [()]
    while sequences:
        grown = []
        for one in sequences:
            best = max(best, worth(steps_of(one)))
            grown += [
                (*one, block)
                for block in candidates
                if one.count(block) < 4 and seconds_of((*one, block), None) <= budget
            ]
        sequences = grown
    found = chosen(candidates, worth, budget, None, 0)
    assert seconds_of(found, None) <= budget
    assert worth(steps_of(found)) == pytest.approx(best)


def test_a_payload_costs_the_time_to_mount_it():
    block = Block(
        name="p",
        reason="",
        steps=(SeriesStep(speeds=(50.0,), low=0.0, high=100.0, payload=5.0),),
    )
    assert seconds_of([block, block], 0.0) == pytest.approx(2 * block.seconds + MOUNTING)
    assert seconds_of([block], 5.0) == pytest.approx(block.seconds)
