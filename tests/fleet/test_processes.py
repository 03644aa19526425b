"""Workers of a fleet as processes: who ends them, and who does not."""

import errno
import multiprocessing
import os
import signal
import subprocess
import sys
import time

import pytest

from frictioncli.errors import OptionError
from frictioncli.fleet import local_processes
from frictioncli.fleet.joint import JointTask
from frictioncli.fleet.joint_logs import find_joints
from frictioncli.fleet.local_processes import run_locally
from frictioncli.fleet.settings import FleetSettings
from frictioncli.stages.settings import RunSettings
from tests.fleet.fleets import (
    ENVIRONMENT,
    PROGRAM,
    WITHOUT,
    Endless,
    begun,
    children,
    contents,
    fleet,
    is_alive,
    started,
    until,
)
from tests.fleet.joints import Joint, write_joint

QUICK = RunSettings(diagnosis=None)


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    """Return a folder with the logs of three joints, and what an undisturbed call gives."""
    folder = tmp_path_factory.mktemp("small")
    list(tasks_of(folder / "logs", folder / "out", endless=()))
    result = fleet(folder / "logs", "-w", folder / "out", "--workers", 1, *WITHOUT)
    assert "3 done, 0 failed" in result.stdout, result.stderr
    return folder / "logs", contents(folder / "out")


def workers_of(process):
    """Return the processes that work on joints."""
    found = []
    for pid in children(process.pid):
        with open(f"/proc/{pid}/cmdline", "rb") as stream:
            if b"spawn_main" in stream.read():
                found.append(pid)
    return found


@pytest.mark.slow
@pytest.mark.parametrize(
    "number",
    [
        *(pytest.param(one, marks=pytest.mark.long) for one in (signal.SIGTERM, signal.SIGHUP)),
        signal.SIGKILL,
    ],
)
def test_workers_end_with_the_process_that_started_them(small, tmp_path, number):
    (logs, whole), out = small, tmp_path / "out"
    process = started(logs, "-w", out, "--workers", 2, *WITHOUT)
    workers = until(lambda: begun(out) and len(workers_of(process)) == 2 and workers_of(process))
    process.send_signal(number)
    process.communicate(timeout=300)
    assert process.returncode == -number
    until(lambda: not any(map(is_alive, workers)), seconds=60)
    assert "3 done" in fleet(logs, "-w", out, "--workers", 1, *WITHOUT).stdout
    assert contents(out) == whole


@pytest.mark.slow
def test_ctrl_c_where_it_is_ignored_stops_nothing(small, tmp_path):
    """A job in the background of a script inherits that Ctrl-C is ignored."""
    (logs, whole), out = small, tmp_path / "out"
    process = subprocess.Popen(
        [sys.executable, "-c", PROGRAM, "fleet", logs, "-w", out, "--workers", "2", *WITHOUT],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        encoding="utf-8",
        env=ENVIRONMENT,
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_IGN),
    )
    until(lambda: begun(out) and len(workers_of(process)) == 2)
    os.killpg(process.pid, signal.SIGINT)
    output, errors = process.communicate(timeout=600)
    assert (process.returncode, errors) == (0, "")
    assert "3 done, 0 failed" in output
    assert contents(out) == whole


def tasks_of(folder, out, *, endless):
    """Return a task per joint; those of some joints never end."""
    for number in (1, 2, 3):
        write_joint(
            folder / "robot=A" / f"joint={number}", Joint(seed=1, runs=1, cycle=4), axis=number
        )
    for logs in find_joints(folder):
        kind = Endless if logs.joint in endless else type(logs)
        made = kind(robot="A", joint=logs.joint, folder=logs.folder)
        yield JointTask(logs=made, work=out / logs.subfolder, settings=QUICK, report=False)


@pytest.mark.long
def test_a_joint_that_takes_for_ever_fails_alone(tmp_path):
    tasks = list(tasks_of(tmp_path / "logs", tmp_path / "out", endless={1, 2}))
    outcomes = {one.joint: one for one in run_locally(tasks, 2, timeout=20.0)}
    assert {joint: one.status for joint, one in outcomes.items()} == {
        1: "failed",
        2: "failed",
        3: "done",
    }
    assert "not done within the 20 s of --timeout" in outcomes[1].message


@pytest.mark.parametrize("timeout", [0.0, -1.0, float("nan"), float("inf")])
def test_a_timeout_that_is_none(timeout):
    with pytest.raises(OptionError, match="--timeout"):
        FleetSettings(timeout=timeout)


def test_a_failed_joint_is_told_by_the_status_if_asked_for(tmp_path):
    logs, out = tmp_path / "logs", tmp_path / "out"
    (logs / "robot=A" / "joint=1").mkdir(parents=True)
    assert fleet(logs, "-w", out).returncode == 0
    asked = fleet(logs, "-w", out, "--fail-on", "failed")
    assert asked.returncode == 3
    assert "1 failed" in asked.stdout
    wrong = fleet(logs, "-w", out, "--fail-on", "any")
    assert (wrong.returncode, wrong.stdout) == (2, "")


@pytest.mark.long
def test_a_damaged_output_is_made_again(tmp_path):
    (task, *_) = tasks_of(tmp_path / "logs", tmp_path / "out", endless=())
    (first,) = run_locally([task], 1)
    whole = contents(task.work)
    for name in ("samples.parquet", "model.json"):
        (task.work / name).write_bytes(whole[name][:-5])
        (again,) = run_locally([task], 1)
        assert (first.status, again.status) == ("done", "done")
        assert contents(task.work) == whole
    (unchanged,) = run_locally([task], 1)
    assert unchanged.status == "unchanged"


def test_a_script_that_calls_a_fleet_is_run_once(tmp_path):
    """Also where it does not keep its calls from workers, which would begin it anew."""
    (tmp_path / "logs" / "robot=A" / "joint=1" / "run=1").mkdir(parents=True)
    (tmp_path / "logs" / "robot=A" / "joint=1" / "run=1" / "log.csv").write_bytes(b"")
    script = tmp_path / "script.py"
    script.write_text(
        "from pathlib import Path\n"
        "from frictioncli.fleet.fleet import run_fleet\n"
        "from frictioncli.fleet.settings import FleetSettings\n"
        "print('begun')\n"
        "print(run_fleet(Path('logs'), Path('out'), options=FleetSettings(workers=1)))\n",
        encoding="utf-8",
    )
    words = [sys.executable, str(script)]
    ended = subprocess.run(
        words, cwd=tmp_path, env=ENVIRONMENT, capture_output=True, text=True, check=True
    )
    assert ended.stdout.count("begun") == 1
    assert "no usable log" in ended.stdout
    assert ended.stderr == ""


def test_a_process_that_cannot_be_started_is_told(tmp_path, monkeypatch):
    def refused(process):
        raise BlockingIOError(errno.EAGAIN, "Resource temporarily unavailable")

    monkeypatch.setattr(multiprocessing.get_context("spawn").Process, "start", refused)
    (task, *_) = tasks_of(tmp_path / "logs", tmp_path / "out", endless=())
    with pytest.raises(OptionError, match=r"could not be started \(Resource temporarily"):
        list(run_locally([task], 1))


def test_a_timeout_of_years_is_waited_for_in_parts(monkeypatch):
    """The system takes no more than 24 days at once."""
    waits = []
    monkeypatch.setattr(local_processes, "wait", lambda _, seconds: waits.append(seconds) or [])
    worker = local_processes._Worker(began=time.monotonic())
    assert local_processes._next_ready([worker], 1e308) == []
    assert waits == [86_400.0]
