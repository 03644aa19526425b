"""Counter-directed motion is matched by speed, temperature and angle, and nothing gets lost."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from frictioncli.errors import NotEnoughData, OptionError
from frictioncli.pairs.settings import PairingSettings
from tests.found import pairs as paired
from tests.moves import move_sequence, samples

GRAVITY = 90.0


def halves(pairs):
    forward, reverse = pairs["torque_forward"], pairs["torque_reverse"]
    return (forward - reverse) / 2, (forward + reverse) / 2


def test_full_strokes_give_friction_and_gravity_at_the_bin_centres():
    frame = samples(move_sequence([0, 180, 0, 180, 0], [20, 20, 60, 60]), friction=12.0)
    result = paired(frame)
    friction, load = halves(result.pairs)
    np.testing.assert_allclose(friction, 12.0, atol=0.02)
    gravity = GRAVITY * np.cos(np.radians(result.pairs["position"]))
    np.testing.assert_allclose(load, gravity, atol=0.15)
    assert result.pairs.groupby("pair")["speed"].first().round(6).tolist() == [20.0, 60.0]


def test_random_turn_angles_pair_as_well_as_full_strokes():
    generator = np.random.default_rng(5)
    turns = np.concatenate(
        [[0.0], np.where(np.arange(20) % 2, -1, 1) * generator.uniform(40, 100, 20)]
    )
    frame = samples(move_sequence(turns, [30.0] * 20), friction=8.0)
    result = paired(frame)
    friction, load = halves(result.pairs)
    np.testing.assert_allclose(friction, 8.0, atol=0.05)
    np.testing.assert_allclose(
        load, GRAVITY * np.cos(np.radians(result.pairs["position"])), atol=0.3
    )
    steady = result.samples - sum(
        result.dropped[name] for name in ("standing", "accelerating", "settling")
    )
    kept = result.pairs["n_forward"].sum() + result.pairs["n_reverse"].sum()
    assert kept > 0.8 * steady


def test_strokes_that_creep_forward_find_partners_on_the_way_back():
    """Out in overlapping steps, home in one move: bins that neighbours miss are matched later."""
    turns = [0, 60, 40, 120, 100, 180, 0]
    frame = samples(move_sequence(turns, [30.0] * 6), friction=8.0)
    covered = set(paired(frame).pairs["position"])
    assert {22.5, 32.5, 72.5, 82.5, 132.5, 152.5} <= covered


@settings(max_examples=20)
@given(seed=st.integers(0, 10**6))
def test_every_sample_is_kept_or_counted_as_dropped(seed):
    generator = np.random.default_rng(seed)
    turns = np.concatenate([[0.0], generator.uniform(-150, 150, 8)])
    speeds = generator.choice([15.0, 40.0, 300.0, 301.0], 8)
    frame = samples(
        move_sequence([*turns, 0.0, 90.0, 0.0], [*speeds, 30.0, 30.0, 30.0]), friction=5.0
    )
    result = paired(frame)
    kept = int(result.pairs["n_forward"].sum() + result.pairs["n_reverse"].sum())
    assert kept + sum(result.dropped.values()) == result.samples == len(frame)


def test_different_speeds_are_no_pair():
    frame = samples(move_sequence([0, 180, 0], [40, 44]), friction=5.0)
    with pytest.raises(NotEnoughData, match="no pair of counter-directed"):
        paired(frame)


def test_different_temperatures_are_no_pair():
    motion = move_sequence([0, 180, 0], [40, 40])
    warm = np.where(motion["velocity"] < 0, 45.0, 40.0)
    with pytest.raises(NotEnoughData):
        paired(samples(motion, friction=5.0, motor_temperature=warm))


def test_a_long_pause_parts_the_partners():
    motion = move_sequence([0, 180, 0], [40, 40])
    motion.loc[motion["velocity"] < 0, "time"] += 1000.0
    back = motion["velocity"].lt(0).idxmax()
    motion.loc[back:, "time"] = (
        motion.loc[back:, "time"].max() + np.arange(len(motion) - back) * 0.012
    )
    with pytest.raises(NotEnoughData):
        paired(samples(motion, friction=5.0))
    assert len(paired(samples(motion, friction=5.0), longest_pause=5000.0).pairs)


def test_one_direction_only_says_so():
    motion = move_sequence([0, 180, 0, 180], [40, 300, 40])
    with pytest.raises(NotEnoughData, match=r"2 constant-velocity parts forward at 40 to 40 deg/s"):
        paired(samples(motion, friction=5.0))


def test_no_constant_speed_says_so():
    with pytest.raises(NotEnoughData, match="no constant-velocity motion"):
        paired(samples(move_sequence([0, 50, 0], [1000, 1000]), friction=5.0))


def test_slow_logs_get_wider_bins():
    motion = move_sequence([-100, 100, -100], [50, 50], period=0.5, rest=2.0)
    assert paired(samples(motion, friction=5.0)).bin_width == 25.0


def test_senseless_settings_are_refused():
    with pytest.raises(OptionError, match="bin width"):
        PairingSettings(bin_width=0.0)
