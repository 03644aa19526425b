"""Every row is kept or rejected with line, reason and text; nothing disappears."""

import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from frictioncli import schemas, tables
from frictioncli.errors import FrictionError
from frictioncli.logs.ingest import IngestSettings, ingest

from .logs import kuka_columns, text_of, write

DAMAGE = st.sampled_from(
    [
        lambda line: line.replace("0", "O", 1),
        lambda line: line[: len(line) // 2],
        lambda line: line + ";7;8",
        lambda line: ";;;",
        lambda line: '"' + line,
        lambda line: line.replace(";", ",", 1),
        lambda line: "0.000;" + line.partition(";")[2],
        lambda line: line.partition(";")[0] + ";nan;1;2",
        lambda line: line.partition(";")[0] + ";inf;1;2",
        lambda line: line.partition(";")[0] + ";1.2.3;1;2",
        lambda line: "99999.0;" + line.partition(";")[2],
        lambda line: "\x00\x01\ufffd",
        lambda line: "# comment",
        lambda line: line + "\n" + line,
        lambda line: " ",
        lambda line: "",
    ]
)


def rows_of(text):
    return [line for line in text.split("\n")[1:] if line.strip(" ")]


@settings(max_examples=40)
@given(
    where=st.lists(st.tuples(st.integers(1, 250), DAMAGE), max_size=12),
    size=st.sampled_from([300, 1 << 22]),
)
def test_kept_and_rejected_are_what_was_read(where, size):
    lines = text_of(kuka_columns(3.0)).rstrip("\n").split("\n")
    for index, damage in where:
        lines[index] = damage(lines[index])
    text = "\n".join(lines)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "log.csv").write_text(text, encoding="utf-8")
        summary = ingest([folder / "log.csv"], folder / "work", IngestSettings(batch_bytes=size))
        samples = tables.read(folder / "work" / "samples.parquet", schemas.SAMPLES)
        rejected = tables.read(folder / "work" / "rejected.parquet", schemas.REJECTED)
    assert summary.rows_read == len(rows_of(text))
    assert len(samples) + len(rejected) == summary.rows_read
    assert summary.rows_kept == len(samples)
    assert (np.diff(samples["time"]) > 0).all()
    physical = text.split("\n")
    for row, found in zip(rejected["row"], rejected["text"], strict=True):
        assert physical[int(row) - 1][:200] == found


@pytest.mark.parametrize(
    ("cells", "reason"),
    [
        ("0.600;abc;0;1", "not_a_number"),
        ("0.600;1;0", "wrong_field_count"),
        ("0.600;;0;1", "missing_value"),
        ("0.600;9.9e34;0;1", "missing_value"),
        ("0.600;inf;0;1", "not_a_number"),
        ("0.100;1;0;1", "time_not_increasing"),
        ("0.588;1;0;1", "duplicate_time"),
        ("77.00;1;0;1", "time_not_increasing"),
    ],
)
def test_a_bad_row_is_named(tmp_path, cells, reason):
    lines = text_of(kuka_columns(), digits=3).split("\n")
    lines[51] = cells
    (tmp_path / "log.csv").write_text("\n".join(lines), encoding="utf-8")
    summary = ingest([tmp_path / "log.csv"], tmp_path / "work")
    rejected = tables.read(tmp_path / "work" / "rejected.parquet", schemas.REJECTED)
    assert rejected[["row", "reason", "text"]].to_numpy().tolist() == [[52, reason, cells]]
    assert summary.rows_rejected == {reason: 1}


def test_stale_first_rows_are_dropped(tmp_path):
    columns = kuka_columns()
    columns["AxisPos_Act2[°]"][:2] += 30.0
    write(tmp_path / "log.csv", columns)
    ingest([tmp_path / "log.csv"], tmp_path / "work")
    rejected = tables.read(tmp_path / "work" / "rejected.parquet", schemas.REJECTED)
    assert rejected["row"].tolist() == [2, 3]
    assert set(rejected["reason"]) == {"stale_first_rows"}
    assert tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)["time"][0] == 0


def test_a_log_that_starts_in_motion_keeps_its_first_rows(tmp_path):
    columns = {name: values[100:] for name, values in kuka_columns().items()}
    summary = ingest([write(tmp_path / "log.csv", columns)], tmp_path / "work")
    assert summary.rows_rejected == {}


def test_missing_temperatures_cost_no_rows(tmp_path):
    columns = kuka_columns()
    columns["Motortemperatur2[°C]"] = np.full(len(columns["Zeit[sec]"]), 31.25)
    columns["Motortemperatur2[°C]"][[5, 9]] = np.nan
    ingest([write(tmp_path / "log.csv", columns)], tmp_path / "work")
    found = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    assert np.flatnonzero(found["motor_temperature"].isna()).tolist() == [5, 9]
    assert set(found["motor_temperature"].dropna()) == {31.25}


def test_a_log_with_mostly_bad_rows_is_rejected_as_a_whole(tmp_path):
    lines = text_of(kuka_columns()).split("\n")
    for index in range(100, 400):
        lines[index] += ";extra"
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "bad.csv").write_text("\n".join(lines), encoding="utf-8")
    write(tmp_path / "run" / "good.csv", kuka_columns())
    summary = ingest([tmp_path / "run"], tmp_path / "work")
    rejected = tables.read(tmp_path / "work" / "rejected.parquet", schemas.REJECTED)
    assert len(rejected) == 1
    assert rejected["row"].isna().all()
    assert rejected["reason"][0] == "wrong_field_count"
    assert "line 101" in rejected["text"][0]
    assert [file.file for file in summary.files_rejected] == ["bad.csv"]
    with pytest.raises(FrictionError, match="300 of 500 rows"):
        ingest([tmp_path / "run" / "bad.csv"], tmp_path / "other")
    assert not (tmp_path / "other").exists()


def test_damaged_positions_change_no_belief(tmp_path):
    columns = kuka_columns(24.0, speed=10.0)
    columns["AxisPos_Act2[°]"] = np.radians(columns["AxisPos_Act2[°]"])
    columns["AxisPos_Act2[°]"][[700, 1500]] = 99999.0
    summary = ingest([write(tmp_path / "log.csv", columns)], tmp_path / "work")
    assert summary.rows_rejected == {"implausible_position": 2}
    table = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    assert table["position"].min() == pytest.approx(-50, abs=1e-6)
