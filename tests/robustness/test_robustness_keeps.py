"""Files that are not the program's own stay, wherever they lie."""

import shutil

import pytest

from frictioncli.errors import FrictionError, LogError, OptionError, TableError
from frictioncli.files import write_text
from frictioncli.fleet import fleet as fleets
from frictioncli.fleet.fleet import run_fleet
from frictioncli.fleet.joint_record import (
    RECORD,
    JointRecord,
    read_record,
    reset_folder,
    write_record,
)
from frictioncli.fleet.settings import FleetSettings
from frictioncli.logs.ingest import ingest
from frictioncli.stages.report import report
from frictioncli.stages.run import run
from frictioncli.workfiles import DIAGNOSIS, EXTENDED
from tests.logs.logs import kuka_columns, write


def test_a_log_is_not_replaced_by_an_output(tmp_path):
    log = write(tmp_path / "samples.parquet", kuka_columns())
    before = log.read_bytes()
    with pytest.raises(LogError, match=r"samples\.parquet: has the place of an output"):
        ingest([log], tmp_path)
    assert log.read_bytes() == before
    assert list(tmp_path.iterdir()) == [log]


def test_a_named_folder_that_is_the_work_folder_is_said_to_be_passed_over(tmp_path):
    write(tmp_path / "log.csv", kuka_columns())
    with pytest.raises(LogError, match=f"the work folder {tmp_path} is not searched"):
        ingest([tmp_path], tmp_path)


@pytest.mark.parametrize("name", ["thesis.docx", "figures/own.svg", "data/notes.txt"])
def test_a_folder_of_the_user_is_not_replaced_by_a_report(tmp_path, name):
    own = tmp_path / "report" / name
    own.parent.mkdir(parents=True)
    own.write_text("mine", encoding="utf-8")
    with pytest.raises(FrictionError, match="which frictioncli did not write"):
        report(tmp_path)
    assert own.read_text(encoding="utf-8") == "mine"


@pytest.mark.parametrize("name", ["friction_a2.src", "friction_a2.dat", "friction_a2_check.script"])
def test_a_report_that_offers_a_robot_program_is_replaced(tmp_path, name):
    offered = tmp_path / "report" / "data" / name
    offered.parent.mkdir(parents=True)
    offered.write_text("", encoding="utf-8")
    with pytest.raises(TableError):  # there are no torques to report on; the folder is no reason
        report(tmp_path)


def test_a_folder_in_the_place_of_a_file_stays(tmp_path):
    own = tmp_path / "model.json" / "mine.txt"
    own.parent.mkdir()
    own.write_text("mine", encoding="utf-8")
    with pytest.raises(FrictionError, match=r"model\.json: holds mine\.txt"):
        write_text(own.parent, "{}")
    assert own.read_text(encoding="utf-8") == "mine"


def test_logs_that_are_not_there_cost_no_diagnosis(tmp_path):
    """A slip in a path ends the call; the outputs of the former one are still those."""
    for name in (DIAGNOSIS, EXTENDED):
        (tmp_path / name).write_text("former", encoding="utf-8")
    with pytest.raises(LogError, match="no such file"):
        run([tmp_path / "lgos"], tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == [DIAGNOSIS, EXTENDED]


@pytest.fixture
def joint(tmp_path):
    """Work folder of a joint that a fleet has made, with logs that somebody has put there."""
    work = tmp_path / "out" / "robot=A" / "joint=2"
    write(work / "run=1" / "log.csv", kuka_columns())
    (work / "model.json").write_text("{}", encoding="utf-8")
    write_record(work, JointRecord(key="former", row={}))
    return work


def test_only_outputs_are_removed_from_a_joint(joint):
    reset_folder(joint, {})
    assert sorted(path.name for path in joint.iterdir()) == ["fleet.json", "run=1"]
    assert (joint / "run=1" / "log.csv").is_file()


@pytest.mark.parametrize("listed", [False, True])
def test_logs_among_the_results_of_their_joint_are_refused(joint, tmp_path, listed, monkeypatch):
    monkeypatch.setattr(fleets, "run_locally", None)  # nothing is to be begun
    out = fleet = tmp_path / "out"
    if listed:
        # a link does not hide where they lie
        (tmp_path / "logs").symlink_to(joint / "run=1")
        fleet = tmp_path / "fleet.csv"
        fleet.write_text("robot,joint,run,path\nA,2,1,logs\n", encoding="utf-8")
    with pytest.raises(OptionError, match="lies in the folder of this joint's results"):
        run_fleet(fleet, out, options=FleetSettings(workers=1))
    assert (joint / "run=1" / "log.csv").is_file()
    assert (joint / "model.json").is_file()


def test_results_among_the_logs_of_a_run_are_refused(tmp_path):
    """The next call would take them for logs."""
    run = tmp_path / "robot=A" / "joint=2" / "run=1"
    write(run / "log.csv", kuka_columns())
    with pytest.raises(OptionError, match=r"lies in .*run=1, all of which are logs"):
        run_fleet(tmp_path, run / "out", options=FleetSettings(workers=1))
    assert [path.name for path in run.iterdir()] == ["log.csv"]


@pytest.mark.parametrize(
    ("old", "new"), [('"status": "done"', '"status": "dome"'), ("0.25", "0.75"), ("0.25", '"x"')]
)
def test_a_damaged_record_of_a_joint_is_none(tmp_path, old, new):
    """Its row would go into the table of the fleet."""
    whole = JointRecord(key="k", row={"status": "done", "rmse": 0.25}, outputs={"a": "b"})
    write_record(tmp_path, whole)
    found = read_record(tmp_path)
    assert (found.key, found.row, found.outputs) == (whole.key, whole.row, whole.outputs)
    text = (tmp_path / RECORD).read_text(encoding="utf-8")
    (tmp_path / RECORD).write_text(text.replace(old, new), encoding="utf-8")
    assert read_record(tmp_path) is None


def test_a_table_of_contents_is_not_replaced_by_the_table_of_results(tmp_path):
    shutil.copytree(write(tmp_path / "day" / "log.csv", kuka_columns()).parent, tmp_path / "1")
    table = tmp_path / "fleet.parquet"
    table.write_text("robot,joint,run,path\nA,2,1,1\n", encoding="utf-8")
    with pytest.raises(OptionError, match="has the place of an output of this fleet"):
        run_fleet(table, tmp_path)
    assert table.read_text(encoding="utf-8").startswith("robot,")
