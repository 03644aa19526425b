"""Damaged maps, manifests, tables of contents and options: one message, no traceback."""

import itertools
import os
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from frictioncli.errors import (
    FrictionError,
    LogError,
    MappingError,
    NotEnoughData,
    OptionError,
    TableError,
)
from frictioncli.fleet.joint_logs import find_joints
from frictioncli.logs.channels.channel_map import read_map
from frictioncli.logs.ingest import IngestSettings, ingest
from frictioncli.logs.runs.discovery import natural_key
from frictioncli.logs.runs.manifest import read_manifest
from frictioncli.model.document import read_models
from frictioncli.pairs.settings import SeparationSettings
from frictioncli.stages.fit import fit
from frictioncli.stages.pair import pair
from frictioncli.stages.separate import separate
from tests.command_line import invoke
from tests.fleet.fleets import ENVIRONMENT
from tests.logs.logs import kuka_columns, write

HEADER = "Zeit[sec];AxisPos_Act2[deg];GearTorq_Act2[Nm]\n"
ROWS = "".join(f"{i * 0.012:.3f};{i * 0.1:.4f};{i % 7 * 0.3:.3f}\n" for i in range(300))


@pytest.fixture
def day(tmp_path):
    folder = tmp_path / "day"
    folder.mkdir()
    return folder


@pytest.mark.parametrize(
    "text",
    [
        "[joint]\nnumber = " + "9" * 5000,
        "[joint]\nnumber = " + "9" * 300,
        "[joint]\nnumber = 99999",
        "[joint]\ngear_ratio = " + "9" * 400,
        "[joint]\nrated_torque = " + "9" * 400,
        "[channels]\ntorque = " + "9" * 4000,
        "[units]\ntorque = " + "[" * 90 + "]" * 90,
        "a = " + "[" * 5000 + "]" * 5000,
        '[csv]\ndelimiter = ["a"]',
        "[csv]\ndelimiter = {a = 1}",
        "[csv]\ndecimal = [1]",
        "[csv]\nencoding = 3",
        '[csv]\nencoding = "a\\u0000b"',
        '[side]\nposition = ["joint"]',
        "channels = 1",
        '["' + "x" * 100_000 + '"]\na = 1',
        "# " + "x" * (1 << 20),
        *(
            f'[csv]\nencoding = "{name}"'
            for name in (
                *("rot13", "hex", "base64", "zlib", "bz2", "quopri", "uu", "idna", "punycode"),
                *("undefined", "unicode_escape", "raw_unicode_escape", "mbcs", "no such"),
            )
        ),
    ],
)
def test_a_map_that_cannot_be_followed(tmp_path, text):
    path = tmp_path / "channels.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(MappingError) as told:
        read_map(path)
    assert str(path) in str(told.value)
    assert len(str(told.value)) < 1000


@pytest.mark.parametrize("order", ["le", "be"])
@pytest.mark.parametrize("family", ["utf-16", "utf-32"])
def test_utf_16_without_a_mark_is_read_as_the_map_says(day, tmp_path, family, order):
    (day / "log.csv").write_bytes((HEADER + ROWS).encode(f"{family}-{order}"))
    path = tmp_path / "channels.toml"
    path.write_text(f'[csv]\nencoding = "{family}"\n', encoding="utf-8")
    summary = ingest([day], tmp_path / "work", IngestSettings(map_file=path))
    assert "300" in str(summary)


def test_a_byte_of_no_text_in_a_date_costs_its_row(day, tmp_path):
    times = np.datetime64("2024-05-17T09:30:00.000") + np.arange(300) * np.timedelta64(12, "ms")
    rows = [f"{time};{i * 0.1:.4f};{i % 7 * 0.3:.3f}".encode() for i, time in enumerate(times)]
    rows[150] = b"2024-05-17T09:30:\xff01.800" + rows[150][23:]
    head = b"timestamp;AxisPos_Act2[deg];GearTorq_Act2[Nm]"
    (day / "log.csv").write_bytes(b"\n".join([head, *rows, b""]))
    ingest([day], tmp_path / "work", IngestSettings())
    recordings = pq.read_table(tmp_path / "work" / "recordings.parquet").to_pylist()
    assert [(one["rows_kept"], one["rows_rejected"]) for one in recordings] == [(299, 1)]


def test_a_cell_too_long_in_a_manifest(day):
    for text in ("file;started_at\nlog.csv;" + "1" * 140_000, "a" * 140_000 + ";b\n"):
        (day / "manifest.csv").write_text(text, encoding="utf-8")
        with pytest.raises(MappingError, match="row") as told:
            read_manifest(day / "manifest.csv")
        assert len(str(told.value)) < 1000


@pytest.mark.parametrize("joints", [(0,), (99_999,), (10**30,), (-1,)])
def test_a_joint_that_the_tables_cannot_hold(joints):
    with pytest.raises(OptionError, match="32767"):
        IngestSettings(joints=joints)


@pytest.mark.parametrize("line", ["time=1,position=2,torque=3,joint=²", "joint=99999,time=1"])
def test_a_map_in_one_line_with_a_joint_that_is_none(day, tmp_path, line):
    (day / "log.csv").write_text(HEADER + ROWS, encoding="utf-8")
    with pytest.raises(MappingError, match="joint number"):
        invoke("ingest", day, "-w", tmp_path / "work", "--map", line)


def test_runs_whose_names_are_numbers_of_any_length():
    names = ["s" + "9" * 5000, "s10", "s2", "s٣", "s1" + "0" * 5000]
    assert sorted(names, key=natural_key) == ["s2", "s٣", "s10", names[0], names[4]]


CONTENTS = "robot;joint;run;path\nA;2;1;a\n"


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("2", "9" * 5000),
        ("2", "²"),
        ("2", "99999"),
        ("A", "x" * 140_000),
        ("A", "\0"),
        ("path", "path;gear_ratio"),
    ],
)
def test_a_table_of_contents_that_cannot_be_followed(tmp_path, old, new):
    path = tmp_path / "contents.csv"
    path.write_text(CONTENTS.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(FrictionError) as told:
        find_joints(path)
    assert len(str(told.value)) < 1000


def test_a_run_of_thousands_of_digits_in_a_table_of_contents(tmp_path):
    path = tmp_path / "contents.csv"
    path.write_text(CONTENTS.replace("1;a", "9" * 5000 + ";a"), encoding="utf-8")
    (joint,) = find_joints(path)
    assert list(joint.runs()) == ["9" * 5000]


def test_text_that_is_none_in_a_parquet_table_of_contents(tmp_path):
    path = tmp_path / "contents.parquet"
    bad = pa.array([b"\xff\xfe"], pa.binary()).view(pa.string())
    pq.write_table(pa.table({"robot": bad, "joint": [2], "run": ["1"], "path": ["a"]}), path)
    with pytest.raises(MappingError, match="Parquet"):
        find_joints(path)


def test_a_plan_of_no_warming_writes_nothing(tmp_path):
    limits = ("--joint", 2, "--from", -90, "--to-angle", 90, "--max-speed", 100)
    with pytest.raises(OptionError, match="26 °C"):
        invoke("plan", "--new", *limits, "-w", tmp_path / "work", "--max-temperature", 20)
    assert not list((tmp_path / "work").glob("*")) if (tmp_path / "work").exists() else True


def test_every_number_that_a_map_takes_may_be_any_of_toml(tmp_path):
    """Whatever the value: read or refused."""
    values = ("0", "-1", "1e999", "nan", "true", "[]", "{}", '""', '"x"', "1979-05-27", "0x10")
    keys = ("number", "gear_ratio", "rated_torque")
    path = tmp_path / "channels.toml"
    for key, value in itertools.product(keys, values):
        path.write_text(f"[joint]\n{key} = {value}\n", encoding="utf-8")
        with suppress(MappingError):
            assert getattr(read_map(path), key.replace("number", "joint")) in (-1, 16)


def test_a_log_of_blank_lines_only_is_refused(day, tmp_path):
    (day / "log.csv").write_text(HEADER + "\n" * 100, encoding="utf-8")
    with pytest.raises(LogError):
        ingest([day], tmp_path / "work", IngestSettings())


@pytest.mark.parametrize(
    ("scale", "reason"), [(1e-300, "no_neighbours"), (1e-9, "expected at most one per 1 µs")]
)
def test_times_of_no_clock_are_refused(day, tmp_path, scale, reason):
    rows = "".join(f"{i * 0.012 * scale};{i * 0.1:.4f};{i % 7 * 0.3:.3f}\n" for i in range(300))
    (day / "log.csv").write_text(HEADER + rows, encoding="utf-8")
    with pytest.raises(LogError, match=reason):
        ingest([day], tmp_path / "work", IngestSettings())


@pytest.mark.parametrize("command", ["ingest", "inspect"])
def test_infinite_times_warn_of_nothing(day, tmp_path, command):
    """Warnings are errors in the tests."""
    rows = "".join(f"inf;{i * 0.1:.4f};{i % 7 * 0.3:.3f}\n" for i in range(300))
    (day / "log.csv").write_text(HEADER + rows, encoding="utf-8")
    if command == "ingest":
        with pytest.raises(LogError, match="not_a_number"):
            ingest([day], tmp_path / "work", IngestSettings())
    else:
        assert "not_a_number" in invoke("inspect", day).stdout


@pytest.mark.parametrize("command", ["ingest", "inspect"])
def test_a_name_of_several_lines_is_refused_in_one(day, tmp_path, command):
    (day / "log\nfrictioncli: all is well.csv").write_text(HEADER + ROWS, encoding="utf-8")
    options = ("-w", tmp_path / "work") if command == "ingest" else ()
    with pytest.raises(LogError) as told:
        invoke(command, day, *options)
    assert "several lines" in str(told.value)
    assert "\n" not in str(told.value)


def test_a_folder_with_a_name_of_several_lines_is_refused_in_one(day, tmp_path, monkeypatch):
    folder = day.rename(day.with_name("day\n1"))
    (folder / "log.csv").write_text(HEADER + ROWS, encoding="utf-8")
    monkeypatch.chdir(folder)
    for named in (folder, Path()):
        with pytest.raises(LogError, match=r"several lines") as told:
            ingest([named], tmp_path / "work", IngestSettings())
        assert "\n" not in str(told.value)


@pytest.mark.parametrize("sign", [-1, 0, 10, 13, 128, 256, 256 + 59, 1 << 20])
def test_the_fast_parser_takes_only_what_it_can_tell_apart(sign):
    parser = pytest.importorskip("frictioncli.logs.formats._plain_numbers")
    built = Path(parser.__file__)
    if built.stat().st_mtime < built.with_name("_plain_numbers.c").stat().st_mtime:
        pytest.skip("built from an older source")
    for signs in ((sign, ord(".")), (ord(";"), sign)):
        with pytest.raises(ValueError, match="expected characters"):
            parser.columns(b"1;2\n", *signs, np.ones(2, np.uint8).data, np.empty((2, 1)).data)


def test_warnings_of_libraries_do_not_reach_the_terminal(tmp_path):
    """As a user calls it: without the tests' filter of warnings."""
    call = (
        "import warnings; from frictioncli.cli import main; from frictioncli.logs import ingest\n"
        "ingest.discover = lambda *_, **__: warnings.warn('from a library', RuntimeWarning) or ()\n"
        "main()"
    )
    words = ["ingest", str(tmp_path), "-w", str(tmp_path / "work")]

    def said(*python):
        done = subprocess.run(
            [sys.executable, *python, "-c", call, *words],
            env=ENVIRONMENT,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 2
        return done.stderr

    assert "from a library" not in said()
    assert "no usable log" in said()
    assert "from a library" in said("-W", "default")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes with names")
def test_a_torque_that_never_changes_has_no_friction(tmp_path):
    columns = kuka_columns()
    columns["GearTorq_Act2[Nm]"][:] = 5.0
    ingest([write(tmp_path / "log.csv", columns)], tmp_path / "work")
    with pytest.raises(NotEnoughData, match="the torque holds no friction to speak of"):
        separate(tmp_path / "work", SeparationSettings(by="regression"))


def test_torques_whose_squares_are_zero_are_zeros(tmp_path):
    columns = kuka_columns()
    columns["GearTorq_Act2[Nm]"] *= 1e-300
    log = write(tmp_path / "log.csv", columns, digits=320)
    with pytest.raises(LogError, match="holds only zeros"):
        ingest([log], tmp_path / "work")


def test_a_pipe_in_the_place_of_an_output_is_not_waited_for(tmp_path):
    """A pipe that nobody writes into has no end."""
    for stage, name in ((pair, "samples.parquet"), (fit, "torques.parquet")):
        os.mkfifo(tmp_path / name)
        with pytest.raises(TableError, match=f"{name} is missing"):
            stage(tmp_path)
    os.mkfifo(tmp_path / "model.json")
    with pytest.raises(TableError, match=r"model\.json is missing"):
        read_models(tmp_path / "model.json")
