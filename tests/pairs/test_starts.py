"""Samples around the starts of moves: whole windows, evenly spaced ones of many."""

import numpy as np
import pandas as pd
import pyarrow as pa
import pytest

from frictioncli import schemas, tables
from frictioncli.pairs import starts
from frictioncli.pairs.pair_tables import start_rows
from frictioncli.provenance import Provenance
from tests.found import NO_MANIFEST, segments
from tests.moves import move_sequence, samples


def rows_of(frame, rows=100_000):
    with segments(frame, rows) as found:
        tables = list(start_rows(found, NO_MANIFEST["payload"]))
    return pa.concat_tables(tables).to_pandas()


def log(count, **columns):
    moves = move_sequence([0, 40] * count, [30.0] * (2 * count - 1))
    return samples(moves, friction=8.0, **columns)


def test_a_window_reaches_from_before_the_start_into_the_move(tmp_path):
    frame = log(3)
    found = rows_of(frame)
    assert found["move"].nunique() == 5
    merged = found.merge(frame, on="time", suffixes=("", "_logged"))
    for name in ("position", "torque", "motor_temperature"):
        np.testing.assert_array_equal(merged[name], merged[f"{name}_logged"])
    span = found.groupby("move")["since"].agg(["min", "max"])
    assert span["min"].to_numpy() == pytest.approx(-0.25, abs=0.013)
    assert span["max"].to_numpy() == pytest.approx(0.6, abs=0.013)
    # it stands before, and moves at 0.1 s
    at = found.set_index("since")
    before = found[found["since"] < -0.05]
    assert before.groupby("move")["position"].agg(np.ptp).max() < 0.01
    assert at["speed"].unique() == pytest.approx([30.0])
    assert set(found["direction"]) == {1, -1}
    path = tmp_path / "starts.parquet"
    tables.write(path, found, schemas.STARTS, Provenance("pair", {}, {}))
    assert len(tables.read(path, schemas.STARTS)) == len(found)


@pytest.mark.parametrize("rows", [50, 331, 5000])
def test_batches_make_no_difference(rows, monkeypatch):
    monkeypatch.setattr(starts, "MOST", 4)
    frame = log(10)
    pd.testing.assert_frame_equal(rows_of(frame, rows), rows_of(frame))


def test_of_many_starts_evenly_spaced_ones_are_kept(monkeypatch):
    monkeypatch.setattr(starts, "MOST", 4)
    # 19 moves: every eighth, as every fourth would be 5
    assert rows_of(log(10))["move"].unique().tolist() == [0, 8, 16]
    assert rows_of(log(8))["move"].unique().tolist() == [0, 4, 8, 12]


def test_starts_during_which_another_joint_moves_are_left_out():
    frame = log(6)
    other = 5.0 * (frame["time"] < 4.0)
    found = rows_of(frame.assign(other_speed=other))
    everything = rows_of(frame)
    assert 0 < found["move"].nunique() < everything["move"].nunique()
    assert found["time"].min() > 4.0


def test_a_slowly_sampled_log_has_none():
    frame = samples(move_sequence([0, 40] * 3, [30.0] * 5, period=0.1), friction=8.0)
    assert rows_of(frame).empty


def test_a_window_does_not_reach_across_a_gap_of_the_log():
    """A pause that was not logged lasts minutes, of which a window would hold every sample."""
    frame = log(4)
    start = np.flatnonzero(np.diff((frame["velocity"].abs() > 1.0).astype(int)) == 1)[3]
    late = frame["time"] + 180.0 * (np.arange(len(frame)) > start - 8)
    found = rows_of(frame.assign(time=late))
    assert found["since"].between(-0.27, 0.62).all()
    assert found["move"].nunique() >= 6
