"""Two programs at one work folder do not mix; stages notice inputs that were replaced."""

import json
import os
import shutil
import signal
import time

import pytest

from frictioncli.errors import FrictionError, TableError
from frictioncli.pairs.settings import PairingSettings
from frictioncli.stages.fit import fit
from frictioncli.stages.pair import pair
from frictioncli.stages.report import report
from frictioncli.stages.run import analyse
from frictioncli.stages.separate import separate
from frictioncli.workfolder import locked, outdated
from tests.command_line import called
from tests.robustness.runs import digests, finished, refused, started, write_warm_up

LEVELS = (25, 39, 53)


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """A work folder with everything but the report, and its logs."""
    folder = tmp_path_factory.mktemp("done")
    write_warm_up(folder / "logs" / "day", levels=LEVELS)
    analyse([folder / "logs"], folder / "work")
    return folder


@pytest.fixture
def work(done, tmp_path):
    return shutil.copytree(done / "work", tmp_path / "work")


def waits_for(path, process):
    """Wait until a process has made a file."""
    while not path.exists():
        assert process.poll() is None, process.stderr.read()
        time.sleep(0.005)


def waits_until_held(work, process):
    """Wait until a process writes into a folder: its lock is there a moment before it is locked."""
    while all(path.name == ".lock" for path in work.glob("*")):
        assert process.poll() is None, process.stderr.read()
        time.sleep(0.005)


@pytest.mark.slow
def test_of_two_runs_into_one_folder_the_second_is_refused(done, tmp_path):
    first = started("run", done / "logs", "-w", tmp_path / "work")
    waits_until_held(tmp_path / "work", first)
    os.kill(first.pid, signal.SIGSTOP)  # it holds the folder for as long as we like
    try:
        for command in (("run", done / "logs"), ("ingest", done / "logs"), ("pair",), ("report",)):
            message = refused(called(*command, "-w", tmp_path / "work"))
            assert "another frictioncli is writing into this folder" in message
    finally:
        os.kill(first.pid, signal.SIGCONT)
    first.communicate()
    assert first.returncode == 0
    alone_made = digests(done / "work")
    assert alone_made.items() <= digests(tmp_path / "work").items()


def test_the_lock_of_a_killed_run_holds_nobody_up(done, tmp_path):
    first = started("run", done / "logs", "-w", tmp_path / "work")
    waits_for(tmp_path / "work" / ".lock", first)
    first.kill()
    first.communicate()
    assert (tmp_path / "work" / ".lock").exists()
    for left_over in (".writing.abc", ".reading.abc"):
        (tmp_path / "work" / left_over).mkdir()
        (tmp_path / "work" / left_over / "samples.parquet").write_bytes(b"half")
    assert called("ingest", done / "logs", "-w", tmp_path / "work").returncode == 0
    assert {path.name for path in (tmp_path / "work").iterdir()} == {
        "samples.parquet",
        "recordings.parquet",
        "rejected.parquet",
    }


def test_who_holds_a_folder_may_enter_again_and_leaves_nothing(tmp_path):
    with locked(tmp_path / "a" / "work"):
        with locked(tmp_path / "a" / "work"):
            assert (tmp_path / "a" / "work" / ".lock").exists()
        assert (tmp_path / "a" / "work" / ".lock").exists()
    assert not (tmp_path / "a").exists()


def test_two_spellings_of_a_folder_are_one_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "work").mkdir()
    (tmp_path / "link").symlink_to("work")
    with locked(tmp_path / "work"):
        message = refused(finished("pair", "-w", tmp_path / "link"))
    assert "another frictioncli" in message


def test_a_fault_gives_the_folder_back(done, work):
    (work / "torques.parquet").unlink()
    with pytest.raises(FrictionError, match="torques"):
        fit(work)
    separate(work)
    fit(work)


def test_tables_that_belong_together_need_no_warning(work):
    for stage in (pair, separate, fit, report):
        assert "warning" not in stage(work).text
    copied = shutil.copytree(work, work.parent / "copied")  # all times are new, the bytes are not
    assert "warning" not in fit(copied).text


@pytest.mark.long
def test_a_table_made_from_a_replaced_one_is_told(work):
    pairs = digests(work)["pairs.parquet"]
    pair(work, PairingSettings(bin_width=2.0))
    assert digests(work)["pairs.parquet"] != pairs
    told = (
        "warning: torques.parquet was made from a different pairs.parquet;"
        " run 'frictioncli separate' again"
    )
    assert fit(work).text.splitlines()[0] == told
    assert told in report(work).text
    separate(work)
    assert "warning" not in fit(work).text
    told = report(work).text
    assert "warning: evaluation.parquet was made from a different torques.parquet" in told
    assert "run 'frictioncli evaluate' again" in told


def test_an_old_model_is_told_whatever_its_time(work):
    """A model put back from elsewhere has an old time; its inputs tell that it does not fit."""
    document = json.loads((work / "model.json").read_text(encoding="utf-8"))
    document["provenance"]["inputs"]["torques.parquet"] = "0" * 64
    (work / "model.json").write_text(json.dumps(document), encoding="utf-8")
    os.utime(work / "model.json", (1, 1))
    with pytest.raises(
        TableError, match=r"model\.json: was made from a different torques\.parquet"
    ):
        report(work)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("other.parquet", b"no Parquet"),
        ("other.json", b"{}"),
        ("other.json", b'{"provenance": {"stage": "fit", "inputs": {"../x": "1", "a/b": "2"}}}'),
        ("other.json", b'{"provenance": {"stage": "fit", "inputs": [1]}}'),
        ("other.json", b"\xff"),
        ("notes.txt", b"mine"),
    ],
)
def test_files_of_someone_else_in_the_folder_are_left_alone(tmp_path, name, content):
    (tmp_path / name).write_bytes(content)
    assert outdated([tmp_path / name]) == []
