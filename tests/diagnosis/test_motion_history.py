"""What a joint has been through, by hand."""

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from frictioncli.diagnosis.data.motion_history import (
    clock_of,
    distance_of_pairs,
    pauses_of,
    series,
    travel_of,
    unrecorded_motion,
)
from frictioncli.diagnosis.data.pair_layout import PairLayout

INF = np.inf


def pairs(time, run=0):
    """Return the layout of pairs of a row each."""
    count = len(time)
    return PairLayout.of(
        row_pair=np.arange(count),
        run=np.broadcast_to(run, count).copy(),
        time=np.array(time, dtype=float),
        speed=np.full(count, 20.0),
        position=np.zeros(count),
    )


def rests(time, warm=40.0, run=0):
    layout = pairs(time, run)
    pause = pauses_of(layout, np.zeros(len(time)))
    moved = unrecorded_motion(layout, pause, np.broadcast_to(warm, len(time)).astype(float))[0]
    rest, order = series(layout, pause, moved)
    return rest.tolist(), order.tolist()


def test_a_pause_of_more_than_two_minutes_is_a_rest():
    rest, order = rests([0, 60, 180, 301, 401, 1001])
    assert rest == [INF, INF, INF, 121, 121, 600]
    assert order == [0, 1, 2, 0, 1, 0]


def test_the_time_that_slow_pairs_take_is_no_rest():
    """At 20 deg/s pairs of 2400 deg take 120 s: of 200 s between two middles 80 are a pause."""
    layout = pairs([0, 200, 460])
    pause = pauses_of(layout, np.full(3, 2400.0))
    assert pause.tolist() == [80, 140]
    assert series(layout, pause, np.zeros(2))[0].tolist() == [INF, INF, 140]


@pytest.mark.parametrize(
    ("after", "rest"), [(30.0, 500.0), (40.0, 500.0), (40.1, 500.0), (40.3, 0.0), (np.nan, 500.0)]
)
def test_a_pause_in_which_the_motor_warmed_is_no_rest(after, rest):
    """It begins a new series all the same."""
    found = rests([0, 60, 560, 620], [40.0, 40.0, after, after])
    assert found == ([INF, INF, rest, rest], [0, 1, 0, 1])


def test_a_motor_that_warms_from_pair_to_pair_changes_nothing_in_a_series():
    assert rests([0, 60, 120], [40.0, 45.0, 50.0]) == ([INF] * 3, [0, 1, 2])


def test_a_run_begins_after_a_rest_of_unknown_length():
    """Whatever its clock and its motor's temperature."""
    found = rests([0, 60, 5000, 5060, 10], [40.0, 40.0, 20.0, 20.0, 60.0], [0, 0, 1, 1, 2])
    assert found == ([INF] * 5, [0, 1, 0, 1, 0])


@given(
    st.lists(st.tuples(st.floats(1, 1000), st.floats(-5, 5)), min_size=1, max_size=30),
    st.integers(1, 3),
)
@settings(max_examples=60)
def test_rests_are_alike_within_a_series_and_places_count_up(steps, runs):
    time = np.cumsum([step for step, _ in steps])
    warm = 40 + np.cumsum([change for _, change in steps])
    run = np.sort(np.arange(len(steps)) % runs)
    layout = pairs(time, run)
    pause = pauses_of(layout, np.zeros(len(time)))
    rest, order = series(layout, pause, unrecorded_motion(layout, pause, warm)[0])
    for i in range(1, len(time)):
        if order[i] > 0:
            assert (rest[i], order[i]) == (rest[i - 1], order[i - 1] + 1)
    heads = order == 0
    assert heads[0]
    known = np.isfinite(rest)
    length = np.append(INF, pause)[heads][np.cumsum(heads) - 1]
    assert ((rest[known] >= 0) & (rest[known] <= length[known])).all()
    for number in np.unique(run):
        assert rest[run == number][0] == INF


def test_runs_follow_each_other_on_the_clock():
    layout = pairs([10, 50, 5, 30, 7], [0, 0, 1, 1, 2])
    assert clock_of(layout).tolist() == [10, 50, 55, 80, 87]
    assert layout.time.tolist() == [10, 50, 5, 30, 7]


ROWS = pd.DataFrame(
    {
        "run": ["a"] * 6 + ["b"] * 3,
        "joint": 2,
        "pair": [0, 0, 0, 1, 1, 2, 0, 0, 1],
        "speed": 20.0,
        "position": [10.0, 40.0, 25.0, 20.0, 30.0, 5.0, 0.0, 90.0, 0.0],
    }
)


def travelled(layout, temperature):
    distance = distance_of_pairs(ROWS)
    pause = pauses_of(layout, distance)
    return travel_of(layout, distance, pause, unrecorded_motion(layout, pause, temperature)[0])


def test_a_pair_travels_its_angles_twice():
    """Before the third pair of a run: there and back over 30 and over 10 deg."""
    layout = pairs([0, 10, 20, 0, 10], [0, 0, 0, 1, 1])
    assert travelled(layout, np.full(5, 40.0)).tolist() == [0, 60, 80, 0, 180]


@pytest.mark.parametrize(
    ("warm", "way"),
    [
        ((30.0, 34.0, 34.0), [0, 60 + 300 * 20, 80 + 300 * 20]),
        ((30.0, 30.1, 33.0), [0, 60, 80]),
        ((30.0, 26.0, 34.0), [0, 60, 80]),
        ((np.nan, np.nan, np.nan), [0, 60, 80]),
    ],
)
def test_a_motor_that_warms_in_a_pause_tells_of_way_at_the_highest_speed(warm, way):
    """Half of both pairs takes 2 s of the 302 at 20 deg/s; a pause of 8 s tells nothing."""
    layout = pairs([0, 302, 312, 0, 10], [0, 0, 0, 1, 1])
    found = travelled(layout, np.array([*warm, 20.0, 20.0]))
    assert found.tolist() == [*way, 0, 180]


COOLING = 1 / 2400.0
"""Rate at which the motor of the joint below loses its excess over ambient. [1/s]"""

HEATED, RESTING, HALF = [1.0] * 20, [0.0] * 16, [0.5] * 16


def worked(share, *, pause=400.0, ambient=22.0, hottest=36.0):
    """Return estimated and true travel, relative to 1 h at 20 deg/s, of a joint that works so.

    Its motor follows dT/dt = k (share * hottest - (T - ambient)); pairs take next to no time.
    """
    above = [0.0]
    for one in share:
        above.append(one * hottest + (above[-1] - one * hottest) * np.exp(-COOLING * pause))
    count = len(above)
    layout = pairs(pause * np.arange(count))
    between = pauses_of(layout, np.zeros(count))
    moved = unrecorded_motion(layout, between, ambient + np.array(above))[0]
    found = travel_of(layout, np.zeros(count), between, moved)
    return found / 72_000.0, np.append(0.0, np.cumsum(share)) * pause / 3600.0


@pytest.mark.parametrize(
    ("share", "error"),
    [
        (HEATED + RESTING, 0.05),
        (HEATED + HALF + RESTING, 0.1),
        (HEATED + RESTING[:8] + HEATED + RESTING, 0.05),
        (HEATED * 2, 0.05),
        (HEATED[:3] + RESTING * 2, 0.05),
    ],
)
def test_a_motor_that_stays_warm_moves(share, error):
    """It must be heated against its cooling, at the rate at which it cools at rest."""
    found, true = worked(share)
    assert found == pytest.approx(true, abs=error * true[-1])


def test_half_the_work_from_the_start_is_taken_for_motion_throughout():
    """Temperature tells relative heat only: travel then keeps its form, at another scale."""
    found, true = worked(HALF + RESTING)
    assert found == pytest.approx(2 * true, abs=0.1 * true[-1])


@pytest.mark.parametrize("ambient", [-10.0, 5.0, 30.0])
def test_where_it_is_warm_does_not_matter(ambient):
    at_home, _ = worked(HEATED + HALF + RESTING)
    assert worked(HEATED + HALF + RESTING, ambient=ambient)[0] == pytest.approx(at_home)


def test_a_motor_that_cools_all_day_has_not_moved():
    above = 30.0 * np.exp(-COOLING * 400.0 * np.arange(21))
    layout = pairs(400.0 * np.arange(21))
    assert not unrecorded_motion(layout, pauses_of(layout, np.zeros(21)), above)[0].any()


def test_a_joint_that_was_heated_stands_for_the_rest_of_the_pause():
    """Every third pause has 300 s of motion, then 600 s of rest: its motor is less warm for it."""
    time, above = [0.0], [0.0]
    for one in range(12):
        rest = 600.0 if one % 3 == 2 else 0.0
        heated = 36.0 + (above[-1] - 36.0) * np.exp(-COOLING * 300.0)
        time.append(time[-1] + 300.0 + rest)
        above.append(heated * np.exp(-COOLING * rest))
    for _ in range(8):
        time.append(time[-1] + 900.0)
        above.append(above[-1] * np.exp(-COOLING * 900.0))
    rest, _ = rests(time, 22.0 + np.array(above))
    paused = np.arange(3, 13, 3)
    assert np.array(rest)[paused] == pytest.approx(600.0, rel=0.15)
    assert np.array(rest)[[1, 2, 4, 5, 7, 8, 10, 11]] == pytest.approx(0.0, abs=45.0)
    assert rest[13:] == [900.0] * 8
