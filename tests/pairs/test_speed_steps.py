"""Moves that go from speed to speed without a stop give one segment per speed."""

import numpy as np
import pandas as pd
import pytest

from tests.pairs.test_constant_speed import segments_of


def staircase(speeds, *, hold=1.0, acceleration=120.0, period=0.02, noise=0.0, seed=0):
    """Speeds held one after the other, with ramps between, from rest to rest."""
    knots, levels, clock, last = [0.0, 0.5], [0.0, 0.0], 0.5, 0.0
    for speed in (*speeds, 0.0):
        clock += abs(speed - last) / acceleration
        knots += [clock, clock + hold]
        levels += [speed, speed]
        clock, last = clock + hold, speed
    time = np.arange(0.0, clock, period)
    velocity = np.interp(time, knots, levels)
    exact = np.cumsum(velocity) * period
    velocity = velocity + np.random.default_rng(seed).normal(0, noise, len(time))
    return pd.DataFrame({"time": time, "position": exact, "velocity": velocity})


@pytest.mark.parametrize("noise", [0.0, 1.0])
@pytest.mark.parametrize("hold", [1.0, 3.0])
def test_each_hold_of_a_staircase_is_a_segment(hold, noise):
    speeds = [57.0, 115.0, 229.0, 344.0, 458.0, 229.0, 57.0]
    motion = staircase(speeds, hold=hold, noise=noise)
    segments, dropped = segments_of(motion)
    assert [segment.speed for segment in segments] == pytest.approx(speeds, rel=0.02)
    for segment in segments:
        assert 0.5 * hold < (segment.stop - segment.start) * 0.02 < 1.05 * hold
    assert sum(s.stop - s.start for s in segments) + sum(dropped.values()) == len(motion)


def test_the_way_back_is_found_too():
    motion = staircase([50.0, 100.0, 200.0])
    motion["velocity"] *= -1
    segments, _ = segments_of(motion)
    assert [segment.speed for segment in segments] == pytest.approx([-50.0, -100.0, -200.0])


@pytest.mark.parametrize("period", [4.0, 20.0, 100.0])
def test_a_sine_holds_no_speed(period):
    time = np.arange(0.0, 3 * period, 0.01)
    motion = pd.DataFrame({"time": time, "velocity": 50 * np.sin(2 * np.pi * time / period)})
    segments, _ = segments_of(motion)
    assert segments == []


@pytest.mark.parametrize("seconds", [5.0, 60.0])
def test_a_slow_ramp_holds_no_speed(seconds):
    time = np.arange(0.0, seconds, 0.01)
    motion = pd.DataFrame({"time": time, "velocity": 100 * time / seconds})
    segments, _ = segments_of(motion)
    assert segments == []
