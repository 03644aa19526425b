"""Only the segment at constant speed is kept."""

from typing import NamedTuple

import numpy as np
import pytest

from frictioncli.errors import OptionError
from frictioncli.pairs import constant_speed
from frictioncli.pairs.constant_speed import constant_speed_segments
from frictioncli.pairs.moves import (
    SMOOTHING,
    directions,
    half_window,
    moves,
    running_sum,
    samples_in,
)
from frictioncli.pairs.settings import SteadySettings
from tests.moves import move_sequence, trapezoid


class Segment(NamedTuple):
    start: int
    stop: int
    speed: float


def segments_of(motion, **settings):
    """Segments of a whole recording, and samples dropped from its moves by reason."""
    chosen = SteadySettings(**settings)
    time, velocity = motion["time"].to_numpy(), motion["velocity"].to_numpy()
    period = float(np.median(np.diff(time)))
    total = running_sum(velocity)
    direction = directions(total, samples_in(SMOOTHING, period), chosen)
    start, stop = moves(direction, time, period)
    found = constant_speed_segments(time, velocity, total, start, stop, chosen)
    dropped = found.dropped | {"standing": len(time) - int(np.sum(stop - start))}
    return list(map(Segment, found.start, found.stop, found.speed)), dropped


@pytest.mark.parametrize("speed", [2.3, 19.1, 67.5, 101.2, 290.0])
def test_plateau_of_a_trapezoid_holds_no_acceleration(speed):
    motion = trapezoid(0, 180, speed, acceleration=2000.0)
    (segment,), _ = segments_of(motion)
    inside = motion.iloc[segment.start : segment.stop]
    assert (inside["acceleration"] == 0).all()
    assert segment.speed == pytest.approx(speed, rel=1e-9)
    # the constant speed lasts 180/v - v/a seconds, of which at most a quarter settles
    cruise = 180 / speed - speed / 2000
    assert inside["time"].iloc[-1] - inside["time"].iloc[0] > 0.6 * min(cruise, cruise - 0.25)


def test_smoothed_speed_is_the_mean_of_neighbours_within_the_move():
    """Three moves of unlike sampling, one too short for any neighbour, two back to back."""
    velocity = np.random.default_rng(2).integers(-40, 40, 60).astype(float)
    first, last = np.array([0, 18, 31]), np.array([18, 20, 60])
    time = np.concatenate([0.01 * np.arange(30), 1 + 0.02 * np.arange(30)])
    widths, halves = np.array([0.031, 0.05, 0.1]), [3, 0, 5]
    assert half_window(time, first, last, widths).tolist() == halves
    expected = []
    for move, half in zip(map(slice, first, last), halves, strict=True):
        own = velocity[move]
        for sample in range(len(own)):
            expected.append(abs(own[max(sample - half, 0) : sample + half + 1].mean()))
    found = constant_speed._smoothed_speed(time, running_sum(velocity), first, last, widths)
    np.testing.assert_allclose(found, expected, rtol=1e-12)


def test_direction_is_in_the_sign_of_the_speed():
    segments, _ = segments_of(move_sequence([0, 180, 0], [50, 50]))
    assert [np.sign(segment.speed) for segment in segments] == [1, -1]


def test_settling_is_dropped():
    motion = trapezoid(0, 180, 50.0)
    begun = motion.loc[motion["velocity"] == 50.0, "time"].iloc[0]
    (segment,), _ = segments_of(motion, settling=0.5)
    assert motion["time"].iloc[segment.start] >= begun + 0.5 - 0.02


def test_a_move_that_never_holds_its_speed_is_dropped():
    motion = trapezoid(0, 60, 1000.0)
    segments, dropped = segments_of(motion)
    assert segments == []
    assert sum(dropped.values()) == len(motion)


def test_stop_and_go_without_rest_gives_two_segments():
    """The joint slows down to 2 % of its speed and goes on in the same direction."""
    motion = move_sequence([0, 90, 180], [60, 60], rest=0.0)
    motion["velocity"] = np.maximum(motion["velocity"], 1.2)
    segments, _ = segments_of(motion)
    assert len(segments) == 2


@pytest.mark.parametrize("speed", [2.3, 20.0, 100.0])
def test_noise_on_the_velocity_does_not_hide_the_plateau(speed):
    generator = np.random.default_rng(3)
    motion = trapezoid(0, 180, speed)
    motion["velocity"] += generator.normal(0, 0.02 * speed, len(motion))
    (segment,), _ = segments_of(motion)
    inside = motion.iloc[segment.start : segment.stop]
    assert (inside["acceleration"] == 0).mean() > 0.98
    cruise = 180 / speed - speed / 400
    assert inside["time"].iloc[-1] - inside["time"].iloc[0] > 0.5 * cruise


def test_slow_sampling_keeps_a_plateau_of_a_few_samples():
    """2 Hz, 50 deg/s over 200 deg: about seven samples at full speed."""
    motion = trapezoid(-100, 100, 50.0, period=0.5, rest=2.0)
    (segment,), _ = segments_of(motion)
    assert segment.stop - segment.start >= 4
    assert segment.speed == pytest.approx(50.0)


def test_every_sample_is_in_a_segment_or_counted():
    motion = move_sequence([0, 180, 20, 150], [19.1, 67.5, 400.0])
    segments, dropped = segments_of(motion)
    assert sum(segment.stop - segment.start for segment in segments) + sum(dropped.values()) == len(
        motion
    )
    # 0.3 s before and behind each move, less half of the moving mean
    assert dropped["standing"] == pytest.approx(3 * (0.6 - 2 * SMOOTHING) / 0.012, abs=12)


@pytest.mark.parametrize(
    "wrong", [{"min_speed": 0.0}, {"speed_tolerance": 0.6}, {"settling": -1.0}, {"min_samples": 1}]
)
def test_senseless_settings_are_refused(wrong):
    with pytest.raises(OptionError, match="expected"):
        SteadySettings(**wrong)
