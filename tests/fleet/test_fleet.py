"""A fleet on this machine: one worker or two, workers that die, a user who interrupts."""

import json
import os
import re
import signal
from pathlib import Path

import pytest

from frictioncli import schemas, tables
from frictioncli.fleet.fleet import run_fleet
from frictioncli.fleet.joint import JointTask
from frictioncli.fleet.joint_logs import find_joints
from frictioncli.fleet.joint_record import read_record
from frictioncli.fleet.local_processes import run_locally
from frictioncli.fleet.settings import FleetSettings
from frictioncli.stages.settings import RunSettings
from tests.fleet.fleets import (
    WITHOUT,
    Deadly,
    begun,
    children,
    contents,
    done,
    fleet,
    started,
    until,
)
from tests.fleet.joints import Joint, write_joint

QUICK = RunSettings(diagnosis=None)


def test_one_row_per_joint_bad_ones_too(alone):
    out, said = alone
    rows = tables.read(out / "fleet.parquet", schemas.FLEET)
    assert list(zip(rows["robot"], rows["joint"], strict=True)) == [
        ("A", 2),
        ("A", 3),
        ("B", 2),
        ("B", 4),
        ("B", 5),
        ("C", 1),
    ]
    assert list(rows["status"]) == ["done"] * 4 + ["failed"] * 2
    assert "000.csv" in rows["message"][4]
    assert "expected run=D" in rows["message"][5]
    assert rows["change"][1] == pytest.approx(2.0, abs=0.3)
    assert rows["change"][0] == pytest.approx(0.0, abs=0.3)
    assert "joints    6: 4 done, 2 failed" in said
    assert "verdicts  " in said
    assert "failed    robot B, joint 5" in said


def test_the_page_holds_the_rows_of_the_table(alone):
    """Friction by run agrees with the change: the last run less the mean of the earlier ones."""
    rows = tables.read(alone[0] / "fleet.parquet", schemas.FLEET)
    html = (alone[0] / "fleet.html").read_text(encoding="utf-8")
    data = json.loads(re.search(r'id="fleet">(.*?)</script>', html, re.DOTALL)[1])
    keys = [column["key"] for column in data["columns"]]
    shown = [dict(zip(keys, row, strict=True)) for row in data["rows"]]
    assert len(shown) == len(rows)
    compared = 0
    for row in rows.itertuples():
        (own,) = (
            one for one in shown if (one["robot"], one["joint"]) == (row.robot, str(row.joint))
        )
        if row.status == "failed":
            assert own["verdict"] == "failed"
            continue
        by_run = row.friction_by_run
        if by_run is not None and own["change"]:
            assert own["change"][0] == pytest.approx(row.change, rel=1e-6)
            assert by_run[-1] - by_run[:-1].mean() == pytest.approx(row.change, abs=1e-9)
            assert own["friction_by_run"][0] == pytest.approx(list(by_run), rel=1e-6)
            compared += 1
    assert compared >= 2


def test_units_of_the_columns(alone):
    schema = next(tables.batches(alone[0] / "fleet.parquet", schemas.FLEET)).schema
    units = {field.name: field.metadata[b"unit"].decode() for field in schema}
    assert units["reference_speed"] == "deg/s"
    assert units["change"] == "torque unit"
    assert units["tau_c"] == units["tau_c_low"] == "tau_c_unit"


@pytest.mark.long
def test_two_workers_give_the_same_bytes(alone, logs, tmp_path):
    result = fleet(logs, "-w", tmp_path / "two", "--workers", 2, "--no-report")
    assert (result.returncode, result.stderr) == (0, "")
    assert contents(tmp_path / "two") == contents(alone[0])


@pytest.mark.long
def test_a_worker_killed_in_mid_run_loses_nothing(undiagnosed, logs, tmp_path):
    process = started(logs, "-w", tmp_path / "out", "--workers", 2, *WITHOUT)
    until(lambda: done(tmp_path / "out") and begun(tmp_path / "out"))
    workers = [pid for pid in children(process.pid) if is_worker(pid)]
    assert len(workers) == 2
    for pid in workers:
        os.kill(pid, signal.SIGKILL)
    output, errors = process.communicate(timeout=300)
    assert (process.returncode, errors) == (0, "")
    # one that was killed between its record and its answer counts as done before
    assert re.search(r"4 done( \(. of them before, unchanged\))?, 2 failed", output)
    assert contents(tmp_path / "out") == contents(undiagnosed)


def is_worker(pid):
    with open(f"/proc/{pid}/cmdline", "rb") as stream:
        return b"spawn_main" in stream.read()


@pytest.mark.slow
def test_ctrl_c_leaves_what_is_done_and_the_next_call_goes_on(undiagnosed, logs, tmp_path):
    out = tmp_path / "out"
    process = started(logs, "-w", out, "--workers", 1, *WITHOUT)
    until(lambda: done(out) and begun(out))
    os.killpg(process.pid, signal.SIGINT)
    _, errors = process.communicate(timeout=300)
    assert process.returncode == 130
    assert errors == "interrupted; finished joints are kept: run the command again to continue\n"
    assert not (out / "fleet.parquet").exists()
    before = len(done(out))
    result = fleet(logs, "-w", out, "--workers", 1, *WITHOUT)
    assert f"4 done ({before} of them before, unchanged), 2 failed" in result.stdout
    assert contents(out) == contents(undiagnosed)


@pytest.mark.long
def test_a_joint_that_takes_down_its_process_has_three_tries(tmp_path):
    deaths = {1: 0, 2: 2, 3: 3}
    for number in deaths:
        folder = tmp_path / "logs" / "robot=A" / f"joint={number}"
        write_joint(folder, Joint(seed=number, runs=1, cycle=4), axis=number)
    tasks = []
    for logs in find_joints(tmp_path / "logs"):
        deadly = Deadly(
            robot="A",
            joint=logs.joint,
            folder=logs.folder,
            counter=tmp_path / f"counter{logs.joint}",
            deaths=deaths[logs.joint],
        )
        work = tmp_path / "out" / logs.subfolder
        tasks.append(JointTask(logs=deadly, work=work, settings=QUICK, report=False))
    outcomes = {outcome.joint: outcome for outcome in run_locally(tasks, 2)}
    assert {joint: outcome.status for joint, outcome in outcomes.items()} == {
        1: "done",
        2: "done",
        3: "failed",
    }
    tries = {joint: (tmp_path / f"counter{joint}").stat().st_size for joint in deaths}
    assert tries == {1: 1, 2: 3, 3: 3}
    assert "the process that worked on it died" in outcomes[3].message


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["nowhere"], "no such file or folder; expected a folder with robot=R/joint=J/run=D"),
        ([".", "--workers", "0"], "--workers 0: expected 1 or more"),
        ([".", "--workers", "1", "--scheduler", "tcp://x:1"], "exclude each other"),
        ([".", "--sign", "up"], "--sign up: expected auto, +1 or -1"),
    ],
)
def test_a_wrong_call_is_one_message_and_status_2(arguments, words):
    result = fleet(*arguments)
    assert result.returncode == 2
    assert words in result.stderr
    assert result.stderr.count("\n") == 1


def test_logs_are_never_taken_for_work_folders(logs):
    before = contents(logs)
    result = fleet(logs, "-w", logs)
    assert result.returncode == 2
    assert "holds files that 'fleet' did not write" in result.stderr
    assert contents(logs) == before


def test_a_table_of_contents_does_the_same_as_folders(alone, logs, tmp_path):
    rows = ["robot;joint;run;path"]
    for run in sorted((logs / "robot=A" / "joint=3").iterdir()):
        rows.append(f"A;3;{run.name.removeprefix('run=')};{run}")
    (tmp_path / "fleet.csv").write_text("\n".join(rows), encoding="utf-8")
    summary = run_fleet(
        tmp_path / "fleet.csv", tmp_path / "out", options=FleetSettings(report=False)
    )
    assert (summary.joints, summary.status["done"]) == (1, 1)
    place = Path("robot=A", "joint=3")
    assert read_record(tmp_path / "out" / place) == read_record(alone[0] / place)
