"""Runs: discovery of their files, manifest, order, start times, and refused files."""

import gzip
import json
import os

import numpy as np
import pytest

from frictioncli import schemas, tables
from frictioncli.errors import FrictionError, LogError, MappingError
from frictioncli.logs.ingest import ingest
from frictioncli.logs.runs.discovery import discover, natural_key
from frictioncli.logs.runs.manifest import read_manifest

from .logs import back_and_forth, kuka_columns, text_of, write


def recordings(work):
    return tables.read(work / "recordings.parquet", schemas.RECORDINGS)


def rejected(work):
    return tables.read(work / "rejected.parquet", schemas.REJECTED)


def test_natural_order():
    names = ["s10.csv", "s2.csv", "S1.csv", "a3b10", "a3b9"]
    assert sorted(names, key=natural_key) == ["a3b9", "a3b10", "S1.csv", "s2.csv", "s10.csv"]


def test_folders_are_runs_and_files_belong_to_their_folder(tmp_path):
    for name in ("a/monday/1.csv", "b/monday/1.csv", "b/tuesday/1.csv", "b/loose.csv"):
        write(tmp_path / name, kuka_columns(0.2))
    runs = discover([tmp_path / "a", tmp_path / "b" / "loose.csv", tmp_path / "b"])
    assert {run.name: [file.path.name for file in run.files] for run in runs} == {
        "a/monday": ["1.csv"],
        "b": ["loose.csv"],
        "b/monday": ["1.csv"],
        "tuesday": ["1.csv"],
    }


def test_what_does_not_exist_or_is_empty(tmp_path):
    with pytest.raises(LogError, match="no such file or folder"):
        discover([tmp_path / "nothing"])
    with pytest.raises(LogError, match="no log files found"):
        discover([tmp_path])


def test_without_manifest_recordings_follow_each_other_with_a_warning(tmp_path):
    for name in ("s10", "s2"):
        write(tmp_path / "run" / f"{name}.csv", kuka_columns(3.0))
    summary = ingest([tmp_path / "run"], tmp_path / "work")
    table = recordings(tmp_path / "work")
    assert table["recording"].tolist() == ["s2", "s10"]
    # 250 samples at 12 ms end at 2.988 s
    np.testing.assert_allclose(table["start"], [0, 3.988])
    assert not summary.time_known
    assert tables.facts(tmp_path / "work" / "samples.parquet")["time_known"] is False
    assert any("cannot be judged" in text for text in summary.warnings)


MANIFEST = """file;started_at;phase;payload;ambient
b.csv;2024-05-17T09:30:00;heat-up;3,5;21.5

a;2024-05-17T10:30:00+00:00;;;
gone.csv;2024-05-17T11:30:00;cool-down;;
"""


def test_manifest_orders_and_labels(tmp_path):
    for name in "abc":
        columns = kuka_columns(3.0)
        columns["Zeit[sec]"] += 1000.0
        write(tmp_path / "run" / f"{name}.csv", columns)
    (tmp_path / "run" / "manifest.csv").write_text(MANIFEST, encoding="utf-8-sig")
    summary = ingest([tmp_path / "run"], tmp_path / "work")
    table = recordings(tmp_path / "work")
    assert table["recording"].tolist() == ["b", "a", "c"]
    np.testing.assert_allclose(table["start"], [0, 3600, 3603.988])
    assert table["phase"][0] == "heat-up"
    assert table.loc[0, ["payload", "ambient"]].tolist() == [3.5, 21.5]
    assert table["started_at"][1] == "2024-05-17T10:30:00+00:00"
    warnings = " ".join(summary.warnings)
    assert "row 5: gone.csv is not a file in the folder" in warnings
    assert "no start time for c.csv" in warnings
    samples = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    assert samples["time"].iloc[0] == 0
    assert (np.diff(samples["time"]) > 0).all()


def test_links_to_nothing_are_told(tmp_path):
    write(tmp_path / "run" / "a.csv", kuka_columns(3.0))
    for name in ("b.csv", "c.csv"):
        (tmp_path / "run" / name).symlink_to("nowhere")
    (tmp_path / "run" / "manifest.csv").write_text(
        "file;started_at\na.csv;2024-05-17T09:30:00\nd.csv;2024-05-17T10:30:00\n"
    )
    os.mkfifo(tmp_path / "run" / "d.csv")
    summary = ingest([tmp_path / "run"], tmp_path / "work")
    assert summary.files_read == 1
    text = str(summary)
    assert "cannot be opened (No such file or directory)" in text
    assert "b.csv" in text
    assert "c.csv" in text
    assert "row 3: d.csv is not a file in the folder" in " ".join(summary.warnings)


def test_overlapping_starts_are_put_one_after_the_other(tmp_path):
    for name in "ab":
        write(tmp_path / "run" / f"{name}.csv", kuka_columns(6.0))
    (tmp_path / "run" / "manifest.csv").write_text(
        "file,started_at\na.csv,2024-05-17T09:30:00\nb.csv,2024-05-17T09:30:02\n"
    )
    summary = ingest([tmp_path / "run"], tmp_path / "work")
    samples = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    assert (np.diff(samples["time"]) > 0).all()
    assert any("b.csv starts 4 s before a.csv ends" in text for text in summary.warnings)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "empty"),
        ("name;started_at\n", "row 1: no column file"),
        ("file;started_at;phse\n", "unknown column phse.*did you mean phase"),
        ("file;started_at\na.csv;yesterday\n", "row 2: started_at is 'yesterday'"),
        ("file;started_at\na.csv\n", "row 2: started_at is ''"),
        ("file;started_at\n;2024-05-17\n", "row 2: no file name"),
        ("file;started_at;phase\na;2024-05-17;warm\n", "row 2: phase is 'warm'; expected heat-up"),
        ("file;started_at;payload\na;2024-05-17;heavy\n", "row 2: payload is 'heavy'.*kg"),
        ("file;started_at\na;2024-05-17\n\na;2024-05-18\n", "row 4: a is listed again.*row 2"),
    ],
)
def test_a_bad_manifest_says_where_and_what(tmp_path, text, message):
    write(tmp_path / "run" / "a.csv", kuka_columns(3.0))
    path = tmp_path / "run" / "manifest.csv"
    path.write_text(text)
    with pytest.raises(MappingError, match=message):
        read_manifest(path)
    with pytest.raises(MappingError):
        ingest([tmp_path / "run"], tmp_path / "work")
    assert not (tmp_path / "work").exists()


def test_what_is_no_log_is_listed_but_not_fatal(tmp_path):
    folder = tmp_path / "run"
    write(folder / "log.csv", kuka_columns())
    (folder / "log.r64").write_bytes(np.arange(5000.0).tobytes())
    (folder / "log.dat").write_text("DIAEXTENDED\n#BEGINGLOBALHEADER\n  1,DOS\n")
    (folder / "log_PROG.TXT").write_text("#BEGINHEADER\nTIME: 1\n#BEGINMOTIONINFO\n")
    (folder / "settings.json").write_text(json.dumps({"a": [1, 2, 3]}))
    (folder / "README.md").write_text("# Logs\n\nRecorded on a Monday; see below, please.\n" * 5)
    (folder / "empty.csv").write_text("")
    (folder / "header.csv").write_text("t;q_1;torque_1\n")
    (folder / "picture.png").write_bytes(b"\x89PNG\r\n\x1a\n" + bytes(100))
    (folder / "book.xlsx").write_bytes(b"PK\x03\x04" + bytes(100))
    (folder / "pipes.csv").write_text("t|q|u\n" + "1.234|2.345|3.456\n" * 50)
    (folder / "truth.json").write_text("{}")
    (folder / ".hidden.csv").write_text("x")
    tables_before = {"log.csv"}
    summary = ingest([folder], tmp_path / "work")
    assert {file.file: file.reason for file in summary.files_rejected} == {
        "log.r64": "format_not_read",
        "log.dat": "format_not_read",
        "log_PROG.TXT": "not_a_log",
        "settings.json": "not_a_log",
        "README.md": "not_a_log",
        "empty.csv": "empty_file",
        "header.csv": "too_few_rows",
        "picture.png": "not_a_log",
        "book.xlsx": "format_not_read",
        "pipes.csv": "one_column",
    }
    table = rejected(tmp_path / "work")
    assert len(table) == 10
    assert table["row"].isna().all()
    assert set(recordings(tmp_path / "work")["file"]) == {str(folder / n) for n in tables_before}
    text = str(summary)
    assert "1 log read, 10 files rejected" in text
    assert "empty.csv" in text


def test_nothing_usable_names_the_files_and_writes_nothing(tmp_path):
    folder = tmp_path / "run"
    write(folder / "a.csv", {"t": np.arange(9.0), "speed_1": np.arange(9.0)})
    (folder / "b.csv").write_text("")
    with pytest.raises(LogError) as caught:
        ingest([folder], tmp_path / "work")
    message = str(caught.value)
    assert "a.csv: no position and no torque channel" in message
    assert "columns found: t, speed_1" in message
    assert "b.csv: empty file" in message
    assert sorted(path.name for path in tmp_path.iterdir()) == ["run"]


def test_a_failed_call_leaves_the_old_tables(tmp_path):
    good = write(tmp_path / "good" / "log.csv", kuka_columns())
    bad = write(tmp_path / "bad" / "log.csv", {"t": np.arange(9.0), "x": np.arange(9.0)})
    ingest([good], tmp_path / "work")
    before = {path: path.read_bytes() for path in (tmp_path / "work").iterdir()}
    with pytest.raises(LogError):
        ingest([bad], tmp_path / "work")
    assert {path: path.read_bytes() for path in (tmp_path / "work").iterdir()} == before


def test_logs_that_differ_in_torque_unit(tmp_path):
    columns = kuka_columns()
    write(tmp_path / "run" / "a.csv", columns)
    columns["Iststrom_A2 [A]"] = columns.pop("GearTorq_Act2[Nm]")
    write(tmp_path / "run" / "b.csv", columns)
    with pytest.raises(LogError, match=r"torque unit: N·m in run/a\.csv; A in run/b\.csv"):
        ingest([tmp_path / "run"], tmp_path / "work")


def test_provenance_names_runs_and_files(tmp_path):
    log = write(tmp_path / "monday" / "log.csv", kuka_columns())
    ingest([log], tmp_path / "work")
    for name in ("samples", "recordings", "rejected"):
        document = tables.metadata(tmp_path / "work" / f"{name}.parquet")
        assert list(document["inputs"]) == ["monday/log.csv"]
        assert document["stage"] == "ingest"
        assert document["facts"]["torque_side"] == "joint"


def test_same_stem_twice_keeps_both_apart(tmp_path):
    for name in ("log.csv", "log.txt"):
        write(tmp_path / "run" / name, kuka_columns(3.0))
    ingest([tmp_path / "run"], tmp_path / "work")
    assert recordings(tmp_path / "work")["recording"].tolist() == ["log.csv", "log.txt"]


def test_start_from_the_header_beside_a_trace(tmp_path):
    for name, clock in (("a", "10:00:30"), ("b", "09:59:00")):
        write(tmp_path / "run" / f"{name}.csv", kuka_columns(3.0))
        (tmp_path / "run" / f"{name}.dat").write_bytes(
            f"DIAEXTENDED\r\n104,19.05.2021\r\n105,{clock}\r\n106,500000000\r\n".encode()
        )
    summary = ingest([tmp_path / "run"], tmp_path / "work")
    table = recordings(tmp_path / "work")
    assert table["recording"].tolist() == ["b", "a"]
    assert table["start"].tolist() == [0, 90]
    assert table["started_at"][0] == "2021-05-19T09:59:00.500000+00:00"
    assert summary.time_known


def test_a_work_folder_that_is_a_file(tmp_path):
    log = write(tmp_path / "run" / "log.csv", kuka_columns())
    with pytest.raises(FrictionError, match="choose another folder"):
        ingest([log], log)


def test_a_damaged_archive_is_rejected_by_name(tmp_path):
    packed = gzip.compress(text_of(kuka_columns(60.0)).encode())
    folder = tmp_path / "run"
    write(folder / "good.csv", kuka_columns())
    (folder / "cut.csv.gz").write_bytes(packed[: len(packed) * 3 // 4])
    (folder / "short.csv.gz").write_bytes(packed[:15])
    summary = ingest([folder], tmp_path / "work")
    assert {file.file: file.reason for file in summary.files_rejected} == {
        "cut.csv.gz": "unreadable_file",
        "short.csv.gz": "unreadable_file",
    }


@pytest.mark.parametrize("change", ["none", "crlf", "no_end", "damaged", "packed", "lone_cr"])
def test_a_log_after_one_like_it_gives_what_it_gives_alone(tmp_path, change):
    first = write(tmp_path / "both" / "a.csv", kuka_columns(3.0))
    content = first.read_bytes()
    lines = content.split(b"\n")
    changed = {
        "none": content,
        "crlf": content.replace(b"\n", b"\r\n"),
        "no_end": content.removesuffix(b"\n"),
        "damaged": b"\n".join([*lines[:90], b"broken", *lines[90:]]),
        "packed": gzip.compress(content),
        "lone_cr": lines[0] + b"\n" + b"\r".join(lines[1:]),
    }[change]
    second = tmp_path / "both" / "b.csv"
    alone = tmp_path / "alone" / "b.csv"
    alone.parent.mkdir()
    for path in (second, alone):
        path.write_bytes(changed)
    ingest([second.parent], tmp_path / "together")
    try:
        ingest([alone], tmp_path / "once")
    except LogError:
        assert "b.csv" in set(rejected(tmp_path / "together")["recording"])
        return
    for name, table in (("samples", schemas.SAMPLES), ("rejected", schemas.REJECTED)):
        found, expected = (
            tables.read(tmp_path / work / f"{name}.parquet", table) for work in ("together", "once")
        )
        found = found[found["recording"] == expected["recording"].iloc[0]] if len(expected) else []
        own = [c for c in expected.columns if c not in ("run", "time")]
        assert len(found) == len(expected)
        if len(expected):
            assert found[own].reset_index(drop=True).equals(expected[own])


def test_notes_that_differ_in_numbers_alone_are_told_once(tmp_path):
    """Seven joints without units give two notes, not fourteen."""
    time, position, velocity, torque = back_and_forth()
    columns = {"time": time}
    for joint in range(7):
        columns |= {f"pos_{joint}": position, f"torque_{joint}": torque + joint}
        columns |= {f"current_{joint}": torque / 10, f"velocity_{joint}": velocity}
    summary = ingest([write(tmp_path / "log.csv", columns)], tmp_path / "work")
    (unit,) = (note for note in summary.notes if "no unit in the header, taken as N·m" in note)
    assert unit.startswith("torque_0")
    assert unit.endswith("(and 6 like it)")
    (choice,) = (note for note in summary.notes if "not used: current" in note)
    assert choice.endswith("(joints 2, 3, 4, 5, 6, 7 alike)")
