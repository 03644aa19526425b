"""A header that is the last of some comments, as KUKA's data recorder and numpy write it."""

import numpy as np
import pytest

from frictioncli import schemas, tables
from frictioncli.errors import LogError
from frictioncli.logs.ingest import ingest

from .logs import back_and_forth

TIME, POSITION, VELOCITY, TORQUE = back_and_forth()
NAMES = ("time", "position", "velocity", "torque")


def written(path, above, delimiter=" ", rows=()):
    cells = zip(TIME, POSITION, VELOCITY, TORQUE, strict=True)
    lines = [delimiter.join(f"{value:.6f}" for value in row) for row in cells]
    path.write_text("\n".join([*above, *rows, *lines]) + "\n")
    return path


def samples(path, work):
    summary = ingest([path], work)
    assert summary.rows_rejected == {}
    assert summary.rows_kept == len(TIME)
    return tables.read(work / "samples.parquet", schemas.SAMPLES)


@pytest.mark.parametrize("mark", ["%", "#", "%%", " #"])
@pytest.mark.parametrize(
    "above",
    [
        ["{} time position[deg] velocity[deg/s] torque[Nm]"],
        ["{} a test of 4 joints", "{} time position[deg] velocity[deg/s] torque[Nm]"],
        # as many words as there are columns
        ["{} robot in cell 4", "{} time position[deg] velocity[deg/s] torque[Nm]"],
        ["{} robot in cell 4", "time position[deg] velocity[deg/s] torque[Nm]"],
        ["{} time position velocity torque", "{} [s] [deg] [deg/s] [Nm]"],
    ],
)
def test_the_last_comment_names_the_columns(tmp_path, mark, above):
    path = written(tmp_path / "log.txt", [line.format(mark) for line in above])
    table = samples(path, tmp_path / "work")
    np.testing.assert_allclose(table["time"], TIME, atol=1e-6)
    np.testing.assert_allclose(table["position"], POSITION, atol=1e-6)
    np.testing.assert_allclose(table["torque"], TORQUE, atol=1e-6)


def test_a_comment_between_delimiters(tmp_path):
    above = ["# started, by hand, in, cell 4", "# time;position [deg];velocity [deg/s];torque [Nm]"]
    table = samples(written(tmp_path / "log.csv", above, ";"), tmp_path / "work")
    np.testing.assert_allclose(table["position"], POSITION, atol=1e-6)


def test_a_kuka_data_recorder(tmp_path):
    """The clock of seconds and nanoseconds, and a comment with fewer words than columns."""
    ticks = np.round(TIME * 1e9).astype(int) + 123456789
    clock = [f"{1500000000 + t // 10**9} {t % 10**9}" for t in ticks]
    header = "% ZeitInSec ZeitInNanoSec q_2[rad] tau_2[Nm]"
    rows = zip(clock, np.radians(POSITION), TORQUE, strict=True)
    lines = ["% LBR iiwa", header, *(f"{t} {p:.9f} {u:.6f}" for t, p, u in rows)]
    (tmp_path / "DataRecorder_1.log").write_text("\n".join(lines))
    table = samples(tmp_path / "DataRecorder_1.log", tmp_path / "work")
    assert set(table["joint"]) == {2}
    np.testing.assert_allclose(table["time"], TIME, atol=1e-6)
    np.testing.assert_allclose(table["position"], POSITION, atol=1e-6)


def test_a_decimal_comma_is_blamed_where_there_are_commas_only(tmp_path):
    with pytest.raises(LogError, match="header names 3 columns but the rows have 4 fields") as told:
        ingest([written(tmp_path / "log.txt", ["time position torque"])], tmp_path / "work")
    assert "decimal comma" not in str(told.value)
    assert "give each field a name in one header line" in str(told.value)
