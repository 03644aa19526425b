"""One joint: its row against the truth, what is kept, what is done again, what is never lost."""

import json
import shutil
from dataclasses import replace
from types import SimpleNamespace

import pytest

from frictioncli.errors import FrictionError
from frictioncli.fleet import joint as joints
from frictioncli.fleet.joint import JointTask, run_joint
from frictioncli.fleet.joint_logs import JointLogs
from frictioncli.fleet.joint_record import check_folder, read_record
from frictioncli.fleet.table_row import causes_text
from frictioncli.model.settings import FitSettings
from frictioncli.stages.settings import RunSettings
from tests.equation_16 import friction
from tests.fleet.fleets import contents
from tests.fleet.joints import Joint, write_joint

WORN = Joint(seed=5, runs=5, cycle=6, wear=1.5)
QUICK = RunSettings(diagnosis=None)


@pytest.fixture(scope="module")
def logs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("joint") / "joint=2"
    write_joint(folder, WORN)
    return JointLogs(robot="A", joint=2, folder=folder)


@pytest.fixture(scope="module")
def finished(logs, tmp_path_factory):
    """A joint worked on in this process, with diagnosis and report."""
    work = tmp_path_factory.mktemp("out") / "robot=A" / "joint=2"
    return JointTask(logs=logs, work=work, settings=RunSettings()), run_joint(
        JointTask(logs=logs, work=work, settings=RunSettings())
    )


@pytest.fixture(scope="module")
def one_run(tmp_path_factory):
    """Logs of one run, for what does not depend on their contents."""
    folder = tmp_path_factory.mktemp("short") / "joint=2"
    write_joint(folder, Joint(seed=5, runs=1, cycle=6))
    return JointLogs(robot="A", joint=2, folder=folder)


@pytest.fixture
def task(one_run, tmp_path):
    return JointTask(logs=one_run, work=tmp_path / "out", settings=QUICK, report=False)


def test_a_row_tells_the_joint_that_made_the_logs(finished):
    task, outcome = finished
    row = read_record(task.work).row
    assert (outcome.status, row["status"], row["runs"]) == ("done", "done", 5)
    assert row["n_pairs"] == 5 * 6 * 3
    assert row["torque_unit"] == row["tau_c_unit"] == "N·m"
    assert row["reference_speed"] == pytest.approx(55, abs=0.5)
    # the fit of all runs holds a fifth of what the last one has more
    true = friction(WORN.parameters, load=0.0, speed=55.0, temperature=40.0) + WORN.wear / 5
    assert row["friction_40"] == pytest.approx(true, abs=0.5)
    # the logs reach from 25 to 45 °C
    assert {"friction_20", "friction_60"}.isdisjoint(row)


def test_wear_shows_as_a_change(finished):
    row = read_record(finished[0].work).row
    assert row["change_low"] < WORN.wear < row["change_high"]
    assert row["change_high"] - row["change_low"] < 0.6


def test_a_row_repeats_what_the_files_say(finished):
    task, outcome = finished
    row = read_record(task.work).row
    model = json.loads((task.work / "model.json").read_text(encoding="utf-8"))
    for name, entry in model["parameters"].items():
        assert row[name] == entry["estimate"]
        assert [row[f"{name}_low"], row[f"{name}_high"]] == (entry["ci95"] or [None, None])
        assert row[f"{name}_determined"] == entry["determined"]
    diagnosis = json.loads((task.work / "diagnosis.json").read_text(encoding="utf-8"))
    assert row["verdict"] == outcome.verdict == diagnosis["verdict"]
    assert (task.work / "report" / "index.html").is_file()


@pytest.mark.long
def test_the_same_joint_in_another_folder_gives_the_same_bytes(finished, tmp_path):
    task, _ = finished
    run_joint(replace(task, work=tmp_path / "elsewhere" / "joint=2"))
    assert contents(tmp_path / "elsewhere" / "joint=2") == contents(task.work)


def test_what_is_unchanged_is_not_done_again(task):
    assert run_joint(task).status == "done"
    stamp = (task.work / "model.json").stat().st_mtime_ns
    assert run_joint(task).status == "unchanged"
    assert (task.work / "model.json").stat().st_mtime_ns == stamp
    assert run_joint(replace(task, redo=True)).status == "done"
    assert (task.work / "model.json").stat().st_mtime_ns > stamp


@pytest.mark.long
def test_another_setting_or_version_is_a_reason_to_do_it_again(task, monkeypatch):
    run_joint(task)
    other = replace(task, settings=replace(QUICK, fit=FitSettings(method="paper")))
    assert run_joint(other).status == "done"
    monkeypatch.setattr(joints, "__version__", "99.0")
    assert run_joint(other).status == "done"
    assert run_joint(other).status == "unchanged"


def test_another_log_or_another_name_of_a_run_is_a_reason(task, tmp_path):
    copy = tmp_path / "logs" / "joint=2"
    shutil.copytree(task.logs.folder, copy)
    task = replace(task, logs=replace(task.logs, folder=copy))
    run_joint(task)
    log = next(copy.rglob("003.csv"))
    lines = log.read_bytes().splitlines(keepends=True)
    log.write_bytes(b"".join(lines[:-1]))
    assert run_joint(task).status == "done"
    first = min(copy.iterdir())
    first.rename(first.with_name("run=2023-12-31"))
    assert run_joint(task).status == "done"
    assert run_joint(task).status == "unchanged"


def test_a_failed_joint_leaves_its_reason_and_nothing_else(task, tmp_path):
    run_joint(task)
    lost = replace(task, logs=JointLogs(robot="A", joint=2, run_paths=(("d", tmp_path / "none"),)))
    outcome = run_joint(lost)
    assert outcome.status == "failed"
    assert "none: no such file or folder; expected the logs of run d" in outcome.message
    assert sorted(path.name for path in task.work.iterdir()) == ["failure.txt", "fleet.json"]
    assert run_joint(task).status == "done"
    assert not (task.work / "failure.txt").exists()


def test_a_bug_is_a_failed_joint_with_its_traceback(task, monkeypatch):
    def broken(*_, **__):
        raise ZeroDivisionError("by zero")

    monkeypatch.setattr(joints, "analyse", broken)
    outcome = run_joint(task)
    assert (outcome.status, outcome.message) == ("failed", "a bug: ZeroDivisionError: by zero")
    assert "Traceback" in (task.work / "failure.txt").read_text(encoding="utf-8")


def test_a_run_without_usable_logs_does_not_stop_the_others(task, tmp_path):
    empty = tmp_path / "empty"
    empty.mkdir()
    listed = (*task.logs.runs().items(), ("2025-01-01", empty))
    outcome = run_joint(replace(task, logs=JointLogs(robot="A", joint=2, run_paths=listed)))
    assert outcome.status == "done"
    assert "no pairs from run 2025-01-01" in outcome.message


def test_a_folder_that_something_else_has_filled_is_left_alone(tmp_path):
    (tmp_path / "mine.txt").write_text("precious", encoding="utf-8")
    with pytest.raises(FrictionError, match="holds files that 'fleet' did not write"):
        check_folder(tmp_path)
    check_folder(tmp_path / "not there yet")


def test_causes_in_words():
    sets = [["thermal_lag"], ["drift", "run_in"], []]
    causes = [SimpleNamespace(effects=names) for names in sets]
    assert causes_text(causes) == "thermal_lag; drift or run_in; unnamed"


def test_logs_that_change_while_they_are_read_are_refused(task, tmp_path, monkeypatch):
    """Cut and put back in between: the hashes before and after are the same."""
    folder = shutil.copytree(task.logs.folder, tmp_path / "joint=2")
    task = replace(task, logs=replace(task.logs, folder=folder))
    path, run_stages = sorted(folder.rglob("*.csv"))[0], joints._run_stages

    def disturbed(*arguments):
        content = path.read_bytes()
        path.write_bytes(content[: len(content) // 2])
        try:
            return run_stages(*arguments)
        finally:
            path.write_bytes(content)

    with monkeypatch.context() as patched:
        patched.setattr(joints, "_run_stages", disturbed)
        outcome = run_joint(task)
    assert outcome.status == "failed"
    assert f"{path} was written while it was read (1 of 7 files)" in outcome.message
    assert run_joint(task).status == "done"
