"""A servo of second order that follows a ramp of speed, by its step response in closed form."""

import numpy as np
import pandas as pd
import pytest

from frictioncli.pairs.ringing import ringing_ends
from frictioncli.pairs.settings import SteadySettings
from tests.moves import move_sequence
from tests.pairs.test_constant_speed import segments_of

PERIOD = 0.004


def rung(speed, *, acceleration, frequency, damping, noise=0.02, stroke=360.0, moves=1, seed=0):
    """Return a move to a stroke's end behind a servo: convolved with its impulse response."""
    turns = [0.0] + [stroke if number % 2 == 0 else 0.0 for number in range(moves)]
    motion = move_sequence(
        turns, [speed] * moves, acceleration=acceleration, period=PERIOD, rest=0.8
    )
    omega = 2 * np.pi * frequency
    own = omega * np.sqrt(1 - damping**2)
    ago = PERIOD * np.arange(int(1.5 / PERIOD))
    response = omega**2 / own * np.exp(-damping * omega * ago) * np.sin(own * ago)
    response /= response.sum()
    followed = np.convolve(motion["velocity"], response)[: len(motion)]
    generator = np.random.default_rng(seed)
    return pd.DataFrame(
        {
            "time": motion["time"],
            "velocity": followed + noise * generator.normal(size=len(motion)),
            "acceleration": np.gradient(followed, PERIOD),
        }
    )


def inside(motion, segment):
    return np.abs(motion["acceleration"].to_numpy()[segment.start : segment.stop])


@pytest.mark.parametrize("seed", range(3))
def test_a_weakly_damped_servo_rings_before_its_segment_not_in_it(seed):
    """At 290 deg/s, 3 Hz and a damping of 0.2, beside the ramp's 1500 deg/s²."""
    motion = rung(290.0, acceleration=1500.0, frequency=3.0, damping=0.2, stroke=900.0, seed=seed)
    (segment,), dropped = segments_of(motion)
    assert dropped["ringing"] > 0
    first = inside(motion, segment)[: int(0.3 / PERIOD)]
    assert first.max() < 0.05 * 1500
    (longer,), _ = segments_of(motion, settling=0.0)
    assert inside(motion, longer)[: int(0.3 / PERIOD)].max() > first.max()


@pytest.mark.parametrize("speed", [19.1, 39.4, 67.5, 101.2])
@pytest.mark.parametrize("noise", [0.0, 0.02, 0.5])
def test_a_servo_that_settles_in_time_loses_nothing(speed, noise):
    """The sample joint's servo and ramp: 6 Hz, 0.45, 400 deg/s²; also where the speed is noisy."""
    lost = []
    for seed in range(4):
        motion = rung(
            speed, acceleration=400.0, frequency=6.0, damping=0.45, noise=noise, seed=seed
        )
        _, dropped = segments_of(motion)
        lost.append(dropped["ringing"])
    assert lost == [0] * 4


def test_every_sample_is_counted_where_the_servo_rings():
    motion = rung(290.0, acceleration=1500.0, frequency=3.0, damping=0.2, stroke=900.0, moves=2)
    segments, dropped = segments_of(motion)
    assert len(segments) == 2
    kept = sum(segment.stop - segment.start for segment in segments)
    assert kept + sum(dropped.values()) == len(motion)


def test_a_ripple_that_goes_on_is_no_ringing():
    """The speed of a joint with a worn gear goes up and down all the way; nothing to wait for."""
    sample = np.arange(500)
    speed = 100.0 + 1.5 * np.sin(sample / 8)
    bounds = np.array([0]), np.array([500]), np.array([40])
    assert ringing_ends(speed, *bounds, acceleration=np.array([400.0])).tolist() == [0]


def test_each_plateau_is_judged_by_itself():
    sample = np.arange(400)
    still, ringing = np.full(400, 50.0), 50 + 2.0 * np.exp(-sample / 40) * np.cos(sample / 4)
    speed = np.concatenate([ringing, np.zeros(7), still, np.zeros(5), ringing])
    begin, hold = np.array([0, 407, 812]), np.array([30, 30, 30])
    found = ringing_ends(speed, begin, begin + 400, hold, np.full(3, 200.0))
    alone = ringing_ends(ringing, begin[:1], begin[:1] + 400, hold[:1], np.full(1, 200.0))
    assert found.tolist() == [alone[0], 407, 812 + alone[0]]
    # exp(-t/40) of 2 deg/s falls below 0.32 deg/s, 5 % of the ramp at 5 Hz, after 74 samples
    assert alone[0] == pytest.approx(74, abs=13)


@pytest.mark.parametrize(("settling", "share"), [(0.1, 0.25), (0.2, 0.25), (0.4, 0.5), (2.0, 1.0)])
def test_who_demands_more_settling_gets_more_of_a_short_segment(settling, share):
    """A link that rings behind a stiff servo shows in the torque alone: the user must tell."""
    assert SteadySettings(settling=settling).settling_share == pytest.approx(share)
    motion = rung(140.0, acceleration=800.0, frequency=12.0, damping=0.9, stroke=80.0)
    held = motion["time"][motion["velocity"] > 0.98 * 140.0]
    segments, _ = segments_of(motion, settling=settling)
    dropped = [motion["time"].iloc[one.start] - held.iloc[0] for one in segments]
    expected = min(settling, share * float(np.ptp(held)))
    if share < 1.0:
        assert dropped == pytest.approx([expected], abs=0.03)
    else:
        assert dropped == []
