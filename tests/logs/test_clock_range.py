"""A clock that is a counter of 16 or 32 bits begins anew at the end of its range."""

import gzip

import numpy as np
import pytest

from frictioncli import schemas, tables
from frictioncli.inspection.inspect import inspect
from frictioncli.logs.formats.continuous_clock import continued
from frictioncli.logs.ingest import IngestSettings, ingest

from .logs import back_and_forth, text_of

TIME, POSITION, VELOCITY, TORQUE = back_and_forth(seconds=150.0, speed=2.0)


def counts(unit, bits, start, signed):
    """Return what a counter of so many bits shows, in numpy's own arithmetic of integers."""
    ticks = np.round(TIME * unit).astype(np.int64) + start
    return ticks.astype(f"{'int' if signed else 'uint'}{bits}").astype(float)


def written(path, clock, name):
    columns = {name: clock, "position [deg]": POSITION, "torque [Nm]": TORQUE}
    lines = text_of(columns, delimiter=",", digits=6).split("\n")
    lines[1:] = [line.replace(".000000", "", 1) for line in lines[1:]]
    path.write_text("\n".join(lines))
    return path


@pytest.mark.parametrize(
    ("name", "unit", "bits", "start", "signed"),
    [
        ("time [us]", 1e6, 32, 2**32 - 60_000_000, False),
        ("time [us]", 1e6, 32, 2**31 - 60_000_000, True),
        ("time [ms]", 1e3, 32, 2**32 - 1200, False),
        ("time [ms]", 1e3, 16, 0, False),
        ("time [ms]", 1e3, 16, 65_000, False),
        ("time [ms]", 1e3, 16, 12, True),
    ],
)
def test_time_goes_on(tmp_path, name, unit, bits, start, signed):
    path = written(tmp_path / "log.csv", counts(unit, bits, start, signed), name)
    summary = ingest([path], tmp_path / "work", IngestSettings(batch_bytes=20_000))
    assert summary.rows_kept == len(TIME)
    samples = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    np.testing.assert_allclose(samples["time"], TIME, atol=1e-6)
    assert any(f"counts to 2^{bits} and begins anew" in note for note in summary.notes)
    (file,) = inspect([path]).files
    assert file.sampling.duration_s == pytest.approx(TIME[-1], abs=1e-6)


def test_a_compressed_log(tmp_path):
    path = written(tmp_path / "log.csv", counts(1e3, 16, 60_000, False), "time [ms]")
    packed = tmp_path / "packed" / "log.csv.gz"
    packed.parent.mkdir()
    packed.write_bytes(gzip.compress(path.read_bytes()))
    assert ingest([packed], tmp_path / "work").rows_kept == len(TIME)


@pytest.mark.parametrize("back", [50_000, 65_536 + 1_200])
def test_a_clock_that_is_set_back_otherwise_is_not_continued(tmp_path, back):
    clock = np.round(TIME * 1000) + 10_000
    clock[len(TIME) // 2 :] -= back
    summary = ingest([written(tmp_path / "log.csv", clock, "time [ms]")], tmp_path / "work")
    lost = summary.rows_rejected["time_not_increasing"]
    assert lost > 1000
    assert not any("begins anew" in note for note in summary.notes)
    (warning,) = (one for one in summary.warnings if "set back" in one)
    assert f"{lost:,} rows" in warning
    assert "divide the file" in warning


@pytest.mark.parametrize("damaged", [0, 1.5, 65_535, 70_000, 2**62, -(2**62)])
@pytest.mark.parametrize("row", [50, 127, 128, 129])
def test_a_damaged_time_does_not_hide_the_turn(tmp_path, damaged, row):
    """The clock begins anew in row 128; a damaged time costs its row, and one beside at most."""
    clock = counts(1e3, 16, 64_000, signed=False)
    assert clock[127] > clock[128]
    clock[row] = damaged
    summary = ingest([written(tmp_path / "log.csv", clock, "time [ms]")], tmp_path / "work")
    assert summary.rows_kept >= len(TIME) - 2
    samples = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    assert samples["time"].iloc[-1] == pytest.approx(TIME[-1], abs=1e-6)


def test_a_damaged_time_is_no_turn():
    time = np.array([1.0, 2.0, 65_000.0, 4.0, 5.0])
    found, last, turns = continued(time, 65_536.0)
    np.testing.assert_array_equal(found[[0, 1, 3, 4]], time[[0, 1, 3, 4]])
    assert (last, turns) == (5.0, 0)
