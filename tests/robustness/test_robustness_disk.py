"""Full disks, folders that cannot be written and odd paths: one message, nothing half-written."""

import multiprocessing
import os
import resource
import shutil
import subprocess
from pathlib import Path

import pytest

from frictioncli.errors import FrictionError
from frictioncli.files import atomic_write, write_text
from frictioncli.stages.diagnose import diagnose
from frictioncli.stages.evaluate import evaluate
from frictioncli.stages.fit import fit
from frictioncli.stages.ingest import ingest
from frictioncli.stages.pair import pair
from frictioncli.stages.report import report
from frictioncli.stages.run import run
from frictioncli.stages.separate import separate
from frictioncli.stages.simulate import simulate
from tests.robustness.runs import check_readable, digests, finished, outputs, refused, write_warm_up

STAGES = {
    "ingest": lambda logs, work: ingest([logs], work),
    "pair": lambda logs, work: pair(work),
    "separate": lambda logs, work: separate(work),
    "fit": lambda logs, work: fit(work),
    "diagnose": lambda logs, work: diagnose(work),
    "simulate": lambda logs, work: simulate(work),
    "evaluate": lambda logs, work: evaluate(work),
    "report": lambda logs, work: report(work),
    "run": lambda logs, work: run([logs], work),
}
WRITING = {"ingest": (64_000, 16_000, 100), "report": (20_000, 100)}
_PROCESSES = multiprocessing.get_context("forkserver")
_PROCESSES.set_forkserver_preload(["frictioncli.stages.run", "frictioncli.report.page"])


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """A finished run, and its logs."""
    folder = tmp_path_factory.mktemp("done")
    write_warm_up(folder / "logs" / "day", levels=(25, 32, 39, 46, 53))
    run([folder / "logs"], folder / "work")
    return folder


def fault(stage, logs, work):
    """Return the message with which a stage refuses."""
    with pytest.raises(FrictionError) as caught:
        STAGES[stage](logs, work)
    return str(caught.value)


@pytest.fixture
def mounted(tmp_path):
    """Return a function that mounts a small file system, which may be read-only."""
    points = []

    def mount(size, *, filled_from=None):
        point = tmp_path / f"mount{len(points)}"
        point.mkdir()
        made = subprocess.run(
            ["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", point],
            capture_output=True,
            check=False,
        )
        if made.returncode != 0:
            pytest.skip("file systems cannot be mounted here")
        points.append(point)
        if filled_from is not None:
            shutil.copytree(filled_from, point / "work")
            subprocess.run(["mount", "-o", "remount,ro", point], check=True)
        return point

    if os.geteuid() != 0 or shutil.which("mount") is None:
        pytest.skip("mounting a file system needs root")
    yield mount
    for point in points:
        subprocess.run(["umount", "-l", point], check=True)


def fault_with_small_files(stage, logs, work, size):
    """Return the message of a stage in a process that cannot write files beyond a size [byte]."""
    ours, theirs = _PROCESSES.Pipe()
    process = _PROCESSES.Process(target=_limited, args=(theirs, stage, logs, work, size))
    process.start()
    theirs.close()
    message = ours.recv()
    ours.close()
    process.join()
    return message


def _limited(connection, stage, logs, work, size):
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))
    try:
        STAGES[stage](logs, work)
        connection.send("done")
    except FrictionError as error:
        connection.send(str(error))


@pytest.mark.parametrize(
    ("stage", "size"),
    [(stage, size) for stage in STAGES for size in WRITING.get(stage, (100,))],
)
def test_a_stage_that_cannot_write_its_files_keeps_the_old_ones(done, tmp_path, stage, size):
    """As on a full disk, at different places: no file may grow beyond the size."""
    work = shutil.copytree(done / "work", tmp_path / "work")
    before = digests(work)
    message = fault_with_small_files(stage, done / "logs", work, size)
    assert "cannot be written (" in message
    kept = digests(work)
    if stage == "run":  # a run begins by removing what is of other data
        before = {name: digest for name, digest in before.items() if name in kept}
    assert kept == before


@pytest.mark.parametrize("size", ["24k", pytest.param("400k", marks=pytest.mark.long)])
def test_a_full_disk_ends_a_run_with_one_message(done, mounted, size):
    point = mounted(size)
    result = finished("run", done / "logs", "-w", point / "work")
    message = refused(result)
    assert "No space left on device" in message
    for path in outputs(point / "work") if (point / "work").exists() else ():
        check_readable(path)
    assert not [path for path in point.rglob(".*")]


@pytest.mark.parametrize("stage", STAGES)
def test_a_read_only_folder(done, mounted, stage):
    point = mounted("64m", filled_from=done / "work")
    before = digests(point / "work")
    assert "Read-only file system" in fault(stage, done / "logs", point / "work")
    assert digests(point / "work") == before


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
@pytest.mark.parametrize("stage", STAGES)
def test_no_permission(done, tmp_path, stage):
    work = shutil.copytree(done / "work", tmp_path / "work")
    work.chmod(0o500)
    try:
        assert "Permission denied" in fault(stage, done / "logs", work)
    finally:
        work.chmod(0o700)
    assert digests(work) == digests(done / "work")


@pytest.mark.parametrize("stage", STAGES)
def test_a_work_folder_that_is_a_file(done, tmp_path, stage):
    (tmp_path / "work").write_text("mine", encoding="utf-8")
    for work in (tmp_path / "work", tmp_path / "work" / "below"):
        assert "choose another folder with -w" in fault(stage, done / "logs", work)
    assert (tmp_path / "work").read_text(encoding="utf-8") == "mine"


@pytest.mark.parametrize("stage", STAGES)
def test_a_work_folder_whose_name_is_too_long(done, tmp_path, stage):
    assert "File name too long" in fault(stage, done / "logs", tmp_path / ("w" * 300))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("command", ["inspect", "ingest"])
def test_a_log_whose_name_is_too_long(tmp_path, command):
    where = () if command == "inspect" else ("-w", tmp_path / "work")
    assert "File name too long" in refused(finished(command, tmp_path / ("w" * 300), *where))
    assert list(tmp_path.iterdir()) == []


def test_an_output_that_is_a_folder_is_replaced(done, tmp_path):
    work = shutil.copytree(done / "work", tmp_path / "work")
    (work / "model.json").unlink()
    (work / "model.json" / "below").mkdir(parents=True)
    fit(work)
    assert digests(work)["model.json"] == digests(done / "work")["model.json"]


def test_a_body_that_fails_leaves_the_old_file_and_nothing_else(tmp_path):
    write_text(tmp_path / "a.json", "old")

    def fail():
        with atomic_write(tmp_path / "a.json") as draft:
            draft.write_text("half", encoding="utf-8")
            raise ValueError("a bug")

    with pytest.raises(ValueError, match="a bug"):
        fail()
    assert (tmp_path / "a.json").read_text(encoding="utf-8") == "old"
    assert [path.name for path in tmp_path.iterdir()] == ["a.json"]


def test_a_device_that_takes_nothing(monkeypatch, tmp_path):
    """The disk is full only when what was written is flushed."""

    def refuse(_number):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", refuse)
    with pytest.raises(FrictionError, match="No space left on device"):
        write_text(tmp_path / "a.json", "new")
    assert list(Path(tmp_path).iterdir()) == []
