"""Cells that hold lists, as scripts write the arrays of messages."""

from array import array

import numpy as np
import pytest

from frictioncli import schemas, tables
from frictioncli.logs.formats import open_log
from frictioncli.logs.ingest import IngestSettings, ingest
from frictioncli.logs.log_source import CsvHints, Refusal

from .logs import back_and_forth

TIME, POSITION, VELOCITY, TORQUE = back_and_forth()
JOINTS = ["pan", "lift", "elbow"]


class Blanks(list):
    """A list with blanks instead of commas, as NumPy writes its arrays."""

    def __repr__(self):
        return f"[{' '.join(f'{value: .17g}' for value in self)}]"


def cells(kind):
    """Return the lists of each row as Python itself writes them."""
    for row in zip(TIME, POSITION, VELOCITY, TORQUE, strict=True):
        time, *values = row
        lists = [[float(value), 0.0, float(value) / 2] for value in values]
        yield [f"{time:.6f}", repr(JOINTS), *(repr(kind(one)) for one in lists)]


def written(path, kind, delimiter=",", quote='"'):
    rows = [
        [cell if i == 0 else quote + cell + quote for i, cell in enumerate(r)] for r in cells(kind)
    ]
    header = ["time", "name", "position [deg]", "velocity [deg/s]", "effort [Nm]"]
    path.write_text("\n".join(delimiter.join(row) for row in [header, *rows]) + "\n")
    return path


@pytest.mark.parametrize("kind", [list, tuple, lambda values: array("d", values), Blanks])
@pytest.mark.parametrize(("delimiter", "quote"), [(",", '"'), (";", '"'), (";", ""), ("\t", "")])
def test_each_member_is_a_column(tmp_path, kind, delimiter, quote):
    path = written(tmp_path / "log.csv", kind, delimiter, quote)
    summary = ingest([path], tmp_path / "work", IngestSettings(batch_bytes=20_000))
    assert summary.rows_read == summary.rows_kept == len(TIME)
    samples = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    for joint, part in ((1, 1.0), (3, 0.5)):
        found = samples[samples["joint"] == joint]
        np.testing.assert_allclose(found["time"], TIME, atol=1e-6)
        np.testing.assert_allclose(found["position"], POSITION * part)
        np.testing.assert_allclose(found["torque"], TORQUE * part)
    assert any("number 1 is pan, 2 is lift, 3 is elbow" in note for note in summary.notes)


def test_a_date_beside_lists_keeps_its_blank(tmp_path):
    rows = [
        f"2024-03-14 11:58:{10 + t:06.3f},[{p} 0.5],[{u} 0.0]"
        for t, p, u in zip(TIME, POSITION, TORQUE, strict=True)
    ]
    path = tmp_path / "log.csv"
    path.write_text("\n".join(["time,position [deg],torque [Nm]", *rows, ""]))
    summary = ingest([path], tmp_path / "work", IngestSettings(joints=(1,)))
    assert summary.rows_kept == len(TIME)
    samples = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    np.testing.assert_allclose(samples["time"], TIME, atol=1e-3)
    np.testing.assert_allclose(samples["position"], POSITION)


def test_names_of_the_members(tmp_path):
    source = open_log(written(tmp_path / "log.csv", list), CsvHints())
    assert source.columns[:5] == ("time", "name_0", "name_1", "name_2", "position_0 [deg]")


def test_lists_of_another_length_and_torn_rows_are_counted(tmp_path):
    path = written(tmp_path / "log.csv", list)
    lines = path.read_text().splitlines()
    lines[50] = lines[50].replace("[", "[0.5, ", 1)
    lines[60] = lines[60][:40]
    lines[70] = lines[70].replace(", 0.0,", ", abc,")
    path.write_text("\n".join(lines))
    summary = ingest([path], tmp_path / "work")
    assert summary.rows_read == len(TIME)
    assert summary.rows_rejected == {"wrong_field_count": 2, "not_a_number": 1}
    rejected = tables.read(tmp_path / "work" / "rejected.parquet", schemas.REJECTED)
    assert list(rejected["row"]) == [51, 61, 71]
    assert rejected["text"][1] == lines[60]


def test_lists_without_a_usual_length_are_told(tmp_path):
    path = written(tmp_path / "log.csv", list)
    lines = path.read_text().splitlines()
    lines[1:] = [
        line.replace('"[-', '"[' + "0.5, " * (i % 5) + "-") for i, line in enumerate(lines[1:])
    ]
    path.write_text("\n".join(lines))
    found = open_log(path, CsvHints())
    assert isinstance(found, Refusal)
    assert "the lists in position [deg] have 3 to 7 members; expected as many" in found.text


def test_lists_beside_columns_of_numbers_are_passed_over(tmp_path):
    rows = [
        f"{t:.6f};{p:.6f};{u};[{', '.join('1' * (1 + i % 4))}]"
        for i, (t, p, u) in enumerate(zip(TIME, POSITION, TORQUE, strict=True))
    ]
    header = "time [s];position [deg];torque [Nm];contacts"
    (tmp_path / "log.csv").write_text("\n".join([header, *rows]) + "\n")
    assert ingest([tmp_path / "log.csv"], tmp_path / "work").rows_kept == len(TIME)
