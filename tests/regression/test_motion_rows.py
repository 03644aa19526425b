"""Rows of a joint's motion: every sample counted, however the log comes."""

import numpy as np
import pytest

from frictioncli.regression.motion_rows import JUMP, motion_rows
from tests.moves import move_sequence
from tests.regression import programmes


def log(period=0.01, seed=3, duration=60):
    motion = programmes.sines(duration, np.random.default_rng(seed), period=period)
    return motion, programmes.samples(motion, programmes.torque(motion))


def rows_of(table, batch=None):
    (motion,) = motion_rows(table.to_batches(max_chunksize=batch)).values()
    return motion, motion.rows()


def test_rows_do_not_depend_on_the_batches():
    _, table = log()
    whole, parts = rows_of(table)[1], rows_of(table, 701)[1]
    for name in ("time", "acceleration", "torque", "move", "number", "travel"):
        np.testing.assert_array_equal(getattr(whole, name), getattr(parts, name))


def test_every_sample_is_in_a_row_or_counted():
    _, table = log()
    motion, rows = rows_of(table)
    assert rows.samples.sum() + sum(motion.dropped.values()) == motion.samples == len(table)


def test_rows_hold_what_the_motion_was():
    motion, table = log()
    _, rows = rows_of(table)
    for found, exact, size in (
        (rows.position, motion[1], 0.1),
        (rows.velocity, motion[2], 0.1),
        (rows.position_slope, motion[2], 0.1),
        (rows.acceleration, motion[3], 0.2),
        (rows.velocity_slope, motion[3], 0.2),
    ):
        assert np.abs(found - np.interp(rows.time, motion[0], exact)).max() < size


def test_uneven_times_are_not_taken_for_even_ones():
    """Every other step is 8 ms, the others 12 ms: taken for even, the acceleration is far off."""
    motion, _ = log(period=0.002)
    steps = np.cumsum(np.tile([4, 6], len(motion[0]) // 10))[:-1]
    uneven = tuple(channel[steps] for channel in motion)
    found, rows = rows_of(programmes.samples(uneven, programmes.torque(uneven)))
    exact = np.interp(rows.time, motion[0], motion[3])
    assert np.sqrt(np.mean(np.square(rows.acceleration - exact))) < 0.05 * np.std(exact)
    assert rows.samples.sum() + sum(found.dropped.values()) == len(steps)


def test_a_jump_of_the_position_is_no_motion():
    motion, _ = log()
    jumped = (motion[0], motion[1] + 720.0 * (motion[0] > 30), *motion[2:])
    found, rows = rows_of(programmes.samples(jumped, programmes.torque(motion)))
    assert found.dropped[JUMP] > 0
    assert np.abs(rows.acceleration).max() < 2 * np.abs(motion[3]).max()


def test_no_row_reaches_across_a_reversal():
    motion, table = log()
    _, rows = rows_of(table)
    reversals = motion[0][1:][np.diff(np.sign(motion[2])) != 0]
    nearest = np.abs(rows.time[:, np.newaxis] - reversals).min(axis=1)
    assert nearest.min() >= 0.05 - 1e-9


@pytest.mark.parametrize("period", [0.004, 0.02, 0.1])
def test_any_rate_has_rows(period):
    _, table = log(period=period)
    motion, rows = rows_of(table)
    assert rows.samples.sum() > 0.7 * motion.samples


def test_no_row_holds_samples_of_a_rest():
    """Moves with rests between: friction is zero there, and would be averaged with motion."""
    motion = move_sequence([0, 60, 0, 60], [90.0, 30.0, 60.0], period=0.01)
    parts = tuple(motion[name].to_numpy() for name in motion)
    _, rows = rows_of(programmes.samples(parts, np.abs(parts[2]) > 0))
    np.testing.assert_allclose(rows.torque, 1.0)
