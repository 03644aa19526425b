"""The ramps of moves come out in bins and signs that can be calculated by hand."""

import numpy as np
import pytest

from frictioncli import schemas, tables
from frictioncli.pairs.ramps import EDGES, slope, window_mean
from frictioncli.provenance import Provenance
from tests.found import ramps as found_ramps
from tests.moves import move_sequence, samples


def ramps(motion, **columns):
    return found_ramps(samples(motion, friction=10.0, **columns))


def part(table, move, name):
    return table[(table["move"] == move) & (table["part"] == name)].set_index("bin")


def test_a_ramp_in_bins_of_distance():
    """At 400 deg/s² the joint is d deg on its way after sqrt(d / 200) s, 50 deg/s after 0.125 s."""
    table = ramps(move_sequence([0, 180, 0], [50, 50], period=0.001))
    begins = part(table, 0, "accelerating")
    assert begins.index.tolist() == list(range(12))
    low, high = np.sqrt(EDGES[:6] / 200), np.sqrt(EDGES[1:7] / 200)  # ends at 1.73 deg: still fast
    np.testing.assert_allclose(begins["samples"][:6], 1000 * (high - low), atol=1.01)
    # the move is seen to begin when the mean over 0.1 s exceeds 0.2 deg/s: 40 ms early
    np.testing.assert_allclose(begins["elapsed"][:6] - 0.04, (low + high) / 2, atol=0.003)
    np.testing.assert_allclose(begins["velocity"][:6], 200 * (low + high), rtol=0.02)
    np.testing.assert_allclose(begins["acceleration"][:5], 400.0, rtol=0.001)
    np.testing.assert_allclose(begins["acceleration"][8:], 0.0, atol=1e-9)
    # 50 deg/s cross the last bin, 18.65 to 30 deg, in 227 ms
    assert begins["samples"][11] == pytest.approx((EDGES[12] - EDGES[11]) / 50 * 1000, abs=1)
    assert begins["distance"][11] == pytest.approx((EDGES[12] + EDGES[11]) / 2, abs=0.05)


def test_signs_in_both_directions():
    """Torque of 90 cos q + 10 sign(v) + 6 kg·m² times acceleration, whichever way."""
    table = ramps(move_sequence([0, 180, 0], [50, 50], period=0.002))
    expected = {
        (0, "accelerating"): (1, 400.0, 0.0),
        (0, "braking"): (1, -400.0, 180.0),
        (1, "accelerating"): (-1, -400.0, 180.0),
        (1, "braking"): (-1, 400.0, 0.0),
    }
    for (move, name), (direction, steep, turn) in expected.items():
        rows = part(table, move, name)
        assert (rows["direction"] == direction).all()
        assert (rows["velocity"] * direction > 0).all()
        assert rows["acceleration"][3] == pytest.approx(steep, rel=0.01)
        np.testing.assert_allclose(rows["distance"], np.abs(rows["position"] - turn), atol=0.01)
        torque = 90 * np.cos(np.radians(rows["position"])) + 10 * direction
        torque += 6 * np.radians(steep) * (rows.index < 5)
        clear = [1, 2, 3, 9, 10, 11]
        np.testing.assert_allclose(rows["torque"][clear], torque[clear], atol=0.5)


def test_acceleration_earlier_and_later():
    """Where braking begins, two samples later it has begun already."""
    table = ramps(move_sequence([0, 180], [40], period=0.012))
    rows = part(table, 0, "braking")
    assert rows["acceleration_2_before"].sum() > rows["acceleration"].sum() + 100
    assert rows["acceleration"].sum() > rows["acceleration_2_after"].sum() - 1
    np.testing.assert_allclose(rows["acceleration_before"][8:], 0.0, atol=1e-9)


def test_acceleration_is_exact_on_a_ramp_with_uneven_samples():
    generator = np.random.default_rng(0)
    time = np.cumsum(generator.uniform(0.002, 0.008, 200))
    found = slope(time, 3.0 + 250.0 * time, 3)
    np.testing.assert_allclose(found, 250.0, rtol=1e-9)


def test_the_mean_over_the_window_is_the_slope_of_the_integral():
    generator = np.random.default_rng(1)
    time = np.cumsum(generator.uniform(0.002, 0.008, 200))
    values = generator.normal(size=200)
    area = np.diff(time) * (values[1:] + values[:-1]) / 2
    integral = np.concatenate([[0.0], np.cumsum(area)])
    np.testing.assert_allclose(window_mean(time, values, 3), slope(time, integral, 3), atol=1e-9)


def test_a_move_on_in_the_same_direction_is_no_reversal():
    table = ramps(move_sequence([0, 60, 120, 0, 60], [40] * 4))
    assert table.groupby("move")["reversal"].first().tolist() == [True, False, True, True]


def test_a_joint_that_rings_after_it_stopped_is_still_known_to_reverse():
    motion = move_sequence([0, 90, 0], [40, 40], rest=0.5)
    stopped = motion["position"].sub(90).abs() < 1e-9
    since = motion["time"] - motion["time"][stopped].iloc[0]
    ring = np.where(stopped, np.exp(-since / 0.1) * np.sin(40 * since), 0.0)
    table = ramps(motion.assign(velocity=motion["velocity"] - 8 * ring))
    assert table.groupby("move")["reversal"].first().tolist() == [True, True]


def test_a_move_cut_off_by_the_recording_has_no_ramp_there():
    motion = move_sequence([0, 180, 0], [50, 50])
    motion = motion[motion["time"] > 1.0].reset_index(drop=True)
    table = ramps(motion)
    assert part(table, 0, "accelerating").empty
    assert len(part(table, 0, "braking")) > 8


def test_slow_sampling_gives_a_table_that_can_be_written(tmp_path):
    table = ramps(move_sequence([-100, 100, -100], [50, 50], period=0.5, rest=2.0))
    path = tmp_path / "ramps.parquet"
    tables.write(path, table, schemas.RAMPS, Provenance("pair", {}, {}))
    assert len(tables.read(path, schemas.RAMPS)) == len(table)
