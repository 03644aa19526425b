"""A fleet on a real Dask scheduler with real worker processes, on this machine's loopback."""

import os
import signal
import subprocess
import sys
from dataclasses import replace

import pytest

from frictioncli.errors import FrictionError, OptionError
from frictioncli.fleet.cluster import run_on_cluster
from frictioncli.fleet.joint import JointTask, record_unworked
from frictioncli.fleet.joint_logs import find_joints
from frictioncli.fleet.joint_record import read_row
from frictioncli.fleet.local_processes import run_locally
from frictioncli.stages.settings import RunSettings
from frictioncli.workfolder import locked
from tests.fleet.clusters import certificates, free_port, scheduler, worker
from tests.fleet.fleets import (
    ENVIRONMENT,
    WITHOUT,
    Deadly,
    begun,
    contents,
    done,
    fleet,
    started,
    until,
)
from tests.fleet.joints import Joint, write_joint
from tests.fleet.test_processes import tasks_of

pytest.importorskip("distributed", reason="needs the extra 'cluster'")

QUICK = RunSettings(diagnosis=None)


@pytest.mark.long
def test_two_workers_one_of_them_killed_give_the_same_bytes(undiagnosed, logs, tmp_path):
    out = tmp_path / "out"
    with (
        scheduler() as (address, _),
        worker(address, tmp_path / "one") as victim,
        worker(address, tmp_path / "two"),
    ):
        process = started(logs, "-w", out, "--scheduler", address, *WITHOUT)
        # both workers are at a joint after one is done
        until(lambda: done(out) and len(begun(out)) == 2)
        os.kill(victim.pid, signal.SIGKILL)
        output, errors = process.communicate(timeout=300)
    assert process.returncode == 0, errors
    assert "4 done" in output
    assert "2 failed" in output
    assert contents(out) == contents(undiagnosed)


@pytest.mark.long
def test_a_joint_that_takes_down_workers_fails_alone(tmp_path):
    for number in (1, 2):
        folder = tmp_path / "logs" / "robot=A" / f"joint={number}"
        write_joint(folder, Joint(seed=number, runs=1, cycle=4), axis=number)
    good, bad = (
        JointTask(logs=logs, work=tmp_path / "out" / logs.subfolder, settings=QUICK, report=False)
        for logs in find_joints(tmp_path / "logs")
    )
    deadly = Deadly(
        robot="A", joint=2, folder=bad.logs.folder, counter=tmp_path / "counter", deaths=99
    )
    tasks = [good, JointTask(logs=deadly, work=bad.work, settings=QUICK, report=False)]
    patience = {"DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "1"}
    with scheduler(**patience) as (address, _), worker(address, tmp_path / "one", nanny=True):
        outcomes = {outcome.joint: outcome for outcome in run_on_cluster(tasks, address)}
    assert {joint: outcome.status for joint, outcome in outcomes.items()} == {
        1: "done",
        2: "failed",
    }
    assert "the process that worked on it died" in outcomes[2].message


def test_workers_with_several_threads_are_refused(logs, tmp_path):
    with scheduler() as (address, _), worker(address, tmp_path / "one", threads=2):
        result = fleet(logs, "-w", tmp_path / "out", "--scheduler", address)
    assert result.returncode == 2
    assert "has 2 threads; expected one" in result.stderr
    assert "Traceback" not in result.stderr


def test_workers_of_another_version_are_refused(logs, tmp_path):
    (joint, *_) = find_joints(logs)
    task = JointTask(logs=joint, work=tmp_path / "out", settings=QUICK, version="0.0.1")
    with (
        scheduler() as (address, _),
        worker(address, tmp_path / "one"),
        pytest.raises(OptionError, match=r"expected 0\.0\.1, the version of the caller"),
    ):
        list(run_on_cluster([task], address))


@pytest.mark.slow
@pytest.mark.parametrize(
    "ended_by", [signal.SIGKILL, pytest.param(signal.SIGSTOP, marks=pytest.mark.long)]
)
def test_a_scheduler_that_goes_is_told_in_the_rows_and_the_next_call_goes_on(
    tmp_path, monkeypatch, ended_by
):
    """One that is stopped keeps its connections and never answers."""
    monkeypatch.setattr("frictioncli.fleet.cluster._PATIENCE", 10)
    monkeypatch.setattr("frictioncli.fleet.cluster._CHECKED", 3)
    out = tmp_path / "out"
    tasks = list(tasks_of(tmp_path / "logs", out, endless={2}))
    with scheduler() as (address, process), worker(address, tmp_path / "one"):
        outcomes = run_on_cluster(tasks, address)
        first = next(outcomes)
        process.send_signal(ended_by)
        rest = list(outcomes)
    assert [first.joint, *(one.joint for one in rest)] == [1, 3, 2]
    assert first.status == "done"
    assert {one.status for one in rest} == {"failed"}
    assert all("the scheduler stopped answering" in one.message for one in rest)
    again = {one.joint: one.status for one in run_locally(tasks[::2], 1)}
    assert again == {1: "unchanged", 3: "done"}


@pytest.mark.long
def test_a_scheduler_without_workers_for_long_is_told_in_the_rows(tmp_path, monkeypatch):
    monkeypatch.setattr("frictioncli.fleet.cluster._WITHOUT_WORKERS", 8)
    monkeypatch.setattr("frictioncli.fleet.cluster._CHECKED", 3)
    tasks = list(tasks_of(tmp_path / "logs", tmp_path / "out", endless=()))
    with scheduler() as (address, _), worker(address, tmp_path / "one") as process:
        outcomes = run_on_cluster(tasks, address)
        assert next(outcomes).status == "done"
        process.kill()
        rest = list(outcomes)
    assert {one.status for one in rest} == {"failed"}
    assert all("no workers for 8 s" in one.message for one in rest)


def test_what_is_done_stays_done_where_nobody_works_any_more(tmp_path):
    first, second, _ = tasks_of(tmp_path / "logs", tmp_path / "out", endless=())
    (done_before,) = run_locally([first], 1)
    whole = contents(first.work)
    assert record_unworked(first, "gone") == replace(done_before, seconds=0.0)
    assert contents(first.work) == whole
    with locked(second.work):  # by this process, which may take it again
        assert record_unworked(second, "gone").message == "gone"
    assert read_row(second.work)["status"] == "failed"
    (first.work / "model.json").write_text("{}")
    assert record_unworked(first, "gone").status == "failed"


@pytest.mark.slow
def test_an_encrypted_cluster_lets_in_only_who_is_known(tmp_path):
    own, strange = certificates(tmp_path / "own"), certificates(tmp_path / "strange")
    folder = tmp_path / "logs" / "robot=A" / "joint=2"
    write_joint(folder, Joint(seed=1, runs=1, cycle=4))
    words = (tmp_path / "logs", "-w", tmp_path / "out", *WITHOUT)

    def call(address, files):
        names = ("--tls-ca", "--tls-cert", "--tls-key")
        options = [part for pair in zip(names, files, strict=False) for part in pair]
        return fleet(*words, "--scheduler", address, *options)

    with scheduler(tls=own) as (address, _), worker(address, tmp_path / "one", tls=own):
        known = call(address, own)
        assert (known.returncode, known.stderr) == (0, "")
        assert "1 done" in known.stdout
        for stranger in (call(address, strange), call(address.replace("tls", "tcp"), ())):
            assert stranger.returncode == 2
            assert "no Dask scheduler answers" in stranger.stderr
            assert "Traceback" not in stranger.stderr
    assert call(address, own[:2]).returncode == 2


@pytest.mark.slow
@pytest.mark.parametrize(
    ("nanny", "timeout"), [pytest.param(True, 20.0, marks=pytest.mark.long), (False, 5.0)]
)
def test_a_joint_that_takes_for_ever_is_a_row(tmp_path, nanny, timeout):
    """The joints after it have their time only where a nanny ends what holds them up."""
    tasks = list(tasks_of(tmp_path / "logs", tmp_path / "out", endless={1}))
    with scheduler() as (address, _), worker(address, tmp_path / "one", nanny=nanny):
        outcomes = {one.joint: one for one in run_on_cluster(tasks, address, timeout=timeout)}
    assert f"not done within the {timeout:g} s" in outcomes[1].message
    others = {outcomes[joint].status for joint in (2, 3)}
    assert others == ({"done"} if nanny else {"failed"})
    if not nanny:
        assert "all workers are blocked" in outcomes[3].message


@pytest.mark.slow
def test_a_worker_that_does_not_answer_holds_nothing_up(tmp_path):
    tasks = list(tasks_of(tmp_path / "logs", tmp_path / "out", endless=()))
    with scheduler() as (address, _), worker(address, tmp_path / "one") as process:
        outcomes = run_on_cluster(tasks, address, timeout=40.0)
        first = next(outcomes)
        os.kill(process.pid, signal.SIGSTOP)
        rest = list(outcomes)
    assert first.status == "done"
    assert {one.status for one in rest} == {"failed"}


def test_no_scheduler_at_the_address(tmp_path, monkeypatch):
    monkeypatch.setattr("frictioncli.fleet.cluster._PATIENCE", 1)
    address = f"tcp://127.0.0.1:{free_port()}"
    with pytest.raises(OptionError, match="no Dask scheduler answers"):
        list(run_on_cluster([], address))


def test_a_scheduler_that_is_stopped_before_the_call(tmp_path):
    """The system still accepts connections for it; Dask would wait for its greeting for ever."""
    call = (
        "import socket; from frictioncli.errors import OptionError;"
        "from frictioncli.fleet import cluster; cluster._PATIENCE = 1;"
        "silent = socket.create_server(('127.0.0.1', 0)); port = silent.getsockname()[1]\n"
        "try:\n"
        "    list(cluster.run_on_cluster([], f'tcp://127.0.0.1:{port}'))\n"
        "except OptionError as error:\n"
        "    print(error)"
    )
    done = subprocess.run(
        [sys.executable, "-c", call], env=ENVIRONMENT, capture_output=True, text=True, timeout=120
    )
    assert "no Dask scheduler answers (it is silent for 2 s)" in done.stdout


def test_no_dask(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(FrictionError, match=r"pip install 'frictioncli\[cluster\]'"):
        list(run_on_cluster([], "tcp://127.0.0.1:1"))
