"""The table of samples: order, discarded recordings, interpolated temperatures."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from frictioncli import schemas, tables
from frictioncli.logs.samples import sample_writer
from frictioncli.logs.samples.log_rows import LogRows
from frictioncli.logs.samples.quantized_temperature import Knots
from frictioncli.logs.samples.sample_writer import SampleWriter
from frictioncli.provenance import Provenance


def log_rows(first, n, joints):
    """Return n rows; every value tells its joint and row."""
    row = np.arange(first, first + n, dtype=float)
    columns = {
        (joint, name): 1000.0 * joint + row
        for joint in joints
        for name in ("position", "velocity", "torque")
    }
    columns |= {(joint, "motor_temperature"): np.full(n, 20.0) for joint in joints}
    return LogRows(row.astype(np.int64), row, columns)


def finished(writer, folder, temperatures):
    target = folder / "table" / "samples.parquet"
    target.parent.mkdir(exist_ok=True)
    writer.finish(target, temperatures, Provenance("ingest"), {"torque_unit": "A"})
    assert tables.facts(target) == {"torque_unit": "A"}
    return tables.read(target, schemas.SAMPLES)


@settings(max_examples=20)
@given(st.lists(st.integers(1, 5), min_size=1, max_size=4))
def test_samples_are_ordered_by_run_joint_and_time(tmp_path_factory, sizes):
    """Two runs of two recordings each, all with joints 2 and 1, added in small chunks."""
    folder = Path(tmp_path_factory.mktemp("writer"))
    with SampleWriter(folder) as writer:
        for run in ("a", "b"):
            for recording, start in (("one", 0.0), ("two", 100.0)):
                writer.begin_recording(run, recording, [2, 1], start)
                first = 0
                for n in sizes:
                    chunk = log_rows(first, n, [2, 1])
                    writer.add(chunk, chunk.time)
                    first += n
        none = {(run, joint): (None, None) for run in ("a", "b") for joint in (1, 2)}
        table = finished(writer, folder, none)
    rows = np.arange(sum(sizes), dtype=float)
    expected = pd.DataFrame(
        [
            (run, recording, joint, row + start, 1000 * joint + row)
            for run in ("a", "b")
            for joint in (1, 2)
            for recording, start in (("one", 0.0), ("two", 100.0))
            for row in rows
        ],
        columns=["run", "recording", "joint", "time", "position"],
    )
    pd.testing.assert_frame_equal(
        table[list(expected)].astype({"joint": int}), expected, check_dtype=False
    )


def test_a_discarded_recording_leaves_no_sample_and_temperatures_are_rebuilt(tmp_path):
    with SampleWriter(tmp_path) as writer:
        for name in ("good", "discarded", "last"):
            writer.begin_recording("run", name, [3], 0.0)
            chunk = log_rows(0, 5, [3])
            writer.add(chunk, chunk.time)
            if name == "discarded":
                writer.discard_recording([3])
        rising = Knots(np.array([-1.0, 9.0]), np.array([19.7, 20.7]), 1.0, 2)
        table = finished(writer, tmp_path, {("run", 3): (rising, None)})
    assert list(table["recording"]) == ["good"] * 5 + ["last"] * 5
    rebuilt = table["motor_temperature"].to_numpy()
    assert rebuilt[:5] == pytest.approx([19.8, 19.9, 20.0, 20.1, 20.2])
    assert list(rebuilt[5:]) == [20.0] * 5
    assert set(table["motor_temperature_reading"]) == {20.0}


def test_short_recordings_of_different_channels_share_a_table(tmp_path):
    with SampleWriter(tmp_path) as writer:
        for name, n, channels in (("warm", 4, 3), ("bare", 2, 2), ("again", 3, 3)):
            chunk = log_rows(0, n, [1])
            if channels == 2:
                columns = {key: chunk.columns[key] for key in chunk.columns if "temp" not in key[1]}
                chunk = LogRows(chunk.lines, chunk.time, columns)
            writer.begin_recording("run", name, [1], 0.0)
            writer.add(chunk, chunk.time)
        table = finished(writer, tmp_path, {("run", 1): (None, None, None)})
    assert list(table["recording"]) == ["warm"] * 4 + ["bare"] * 2 + ["again"] * 3
    assert list(table["motor_temperature"].isna()) == [False] * 4 + [True] * 2 + [False] * 3
    assert list(table["position"]) == [1000 + i for i in (0, 1, 2, 3, 0, 1, 0, 1, 2)]


def test_few_tiny_recordings_wait(tmp_path, monkeypatch):
    monkeypatch.setattr(sample_writer, "_TABLE_PIECES", 4)
    with SampleWriter(tmp_path) as writer:
        for number in range(10):
            writer.begin_recording("run", f"log {number}", [1], 10.0 * number)
            chunk = log_rows(0, 3, [1])
            writer.add(chunk, chunk.time)
            assert len(writer._files[1].waiting) < 4
        table = finished(writer, tmp_path, {("run", 1): (None,) * 10})
    assert list(table["recording"]) == [f"log {n}" for n in range(10) for _ in range(3)]
    assert list(table["position"]) == [1000 + i for _ in range(10) for i in range(3)]
