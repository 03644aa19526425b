"""The suggested map reads the same torque of the same joint as ``ingest`` does without a map."""

import tomllib

import numpy as np
import pandas as pd
import pytest

from frictioncli import schemas, tables
from frictioncli.inspection.inspect import inspect
from frictioncli.inspection.map_suggestion.suggest_map import suggested_map
from frictioncli.inspection.text import text
from frictioncli.logs.ingest import ingest
from frictioncli.logs.settings import IngestSettings
from tests.logs.logs import REAL
from tests.logs.test_without_position import recorder_file

from .faulty import COLUMNS, clean_log, write

TIME, POSITION, VELOCITY, TORQUE, _ = COLUMNS


def both_ways(logs, folder, **settings):
    """Return the samples without a map and with the suggested one, their facts, and the map."""
    suggested = suggested_map(logs, IngestSettings(**settings))
    map_file = folder / "channels.toml"
    map_file.write_text(suggested, encoding="utf-8")
    tried = (IngestSettings(**settings), IngestSettings(**settings, map_file=map_file))
    found, facts = [], []
    for number, one in enumerate(tried):
        work = folder / f"work-{number}"
        ingest(logs, work, one)
        found.append(tables.read(work / "samples.parquet", schemas.SAMPLES))
        facts.append(tables.facts(work / "samples.parquet"))
    return found, facts, suggested


def same_torque(found, facts, joint):
    """Assert that torque, its unit and its side are the same of a joint."""
    for name in ("torque_unit", "torque_side"):
        assert facts[0][name] == facts[1][name]
    one, two = (table[table["joint"] == joint] for table in found)
    assert len(one) > 0
    np.testing.assert_array_equal(one["torque"], two["torque"])
    np.testing.assert_array_equal(one["load"], two["load"])


@pytest.mark.parametrize(
    ("names", "side"),
    [
        (("DriveMotorTorq_Act3[Nm]", "GearTorq_Act3[Nm]"), "motor"),
        (("torque_3 [Nm]", "current_3 [A]"), "joint"),
    ],
)
def test_of_two_torques_the_map_takes_that_of_ingest(names, side, tmp_path):
    """The direction shows more clearly in the other channel, which has no noise."""
    log = clean_log()
    exact = clean_log(noise=0.0)
    table = pd.DataFrame({"time": log[TIME], "q_3 [deg]": log[POSITION]})
    table[names[0]], table[names[1]] = log[TORQUE], 0.7 * exact[TORQUE]
    write(table, tmp_path / "logs" / "log.csv")
    found, facts, text = both_ways([tmp_path / "logs"], tmp_path)
    same_torque(found, facts, 3)
    assert facts[0]["torque_side"] == side
    assert tomllib.loads(text)["channels"]["torque"] == names[0]
    assert f'# torque = "{names[1]}"' in text


def test_a_motor_torque_brought_to_the_joint_by_the_positions(tmp_path):
    """The map has the ratio that ingest finds from the positions on both sides."""
    log = clean_log()
    table = pd.DataFrame(
        {
            "time": log[TIME],
            "AxisPos_Act2[deg]": log[POSITION],
            "Istposition_A2[deg]": 80 * log[POSITION],
            "DriveMotorTorq_Act2[Nm]": log[TORQUE] / 80,
        }
    )
    write(table, tmp_path / "logs" / "log.csv", digits=9)
    found, facts, text = both_ways([tmp_path / "logs"], tmp_path)
    assert facts[1]["torque_side"] == "joint"
    np.testing.assert_allclose(found[0]["torque"], found[1]["torque"], rtol=1e-4)
    assert tomllib.loads(text)["joint"]["gear_ratio"] == pytest.approx(80, rel=1e-4)


def test_a_map_for_drives_without_position(tmp_path):
    folder = tmp_path / "drive"
    folder.mkdir()
    for number, speed in enumerate([10, -10, 40, -40, 90, -90]):
        recorder_file(folder, speed, minute=number)
    found, facts, text = both_ways([folder], tmp_path)
    same_torque(found, facts, 1)
    np.testing.assert_array_equal(found[0]["position"], found[1]["position"])
    mapping = tomllib.loads(text)
    assert "position" not in mapping["channels"]
    assert mapping["units"] == {"time": "ms", "velocity": "rpm", "torque": "%"}
    assert "position is its integral" in text
    assert "by name only" not in text


@pytest.mark.parametrize("name", ["motor_id", "Joint ID", "axis_no"])
def test_the_joint_is_that_of_the_id_column(name, tmp_path):
    log = clean_log()
    columns = {"time": log[TIME], name: 5, "position": log[POSITION], "torque": log[TORQUE]}
    write(pd.DataFrame(columns), tmp_path / "logs" / "log.csv")
    found, facts, text = both_ways([tmp_path / "logs"], tmp_path)
    same_torque(found, facts, 5)
    assert tomllib.loads(text)["joint"] == {"number": 5}


def test_an_id_that_changes_tells_the_joint_of_each_row(tmp_path):
    log = clean_log()
    table = pd.DataFrame({"time": log[TIME], "motor_id": 2, "pos": log[POSITION]})
    table["torque"] = log[TORQUE]
    table.loc[::2, "motor_id"] = 3
    summary = ingest([write(table, tmp_path / "log.csv")], tmp_path / "work")
    assert list(summary.samples) == [2, 3]
    assert summary.rows_read == len(table)


@pytest.mark.skipif(not REAL.is_dir(), reason=f"no real logs beside the project: {REAL}")
@pytest.mark.parametrize(
    ("folder", "joint"),
    [("kuka-kr3/PTP_Vel", 3), ("kinova-gen3-j4", 4), ("epos-drive1", 1), ("damiao-5", 5)],
)
def test_real_logs_with_the_suggested_map(folder, joint, tmp_path):
    found, facts, _ = both_ways([REAL / folder], tmp_path)
    assert facts[0]["torque_unit"] == facts[1]["torque_unit"]
    assert facts[0]["torque_side"] == facts[1]["torque_side"]
    one, two = (table[table["joint"] == joint] for table in found)
    assert len(one) == len(two) > 0
    # temperature and load of another file of a trace are not part of a map
    np.testing.assert_allclose(np.sort(one["torque"]), np.sort(two["torque"]), rtol=1e-9)


def test_the_map_keeps_what_a_gripper_carries(tmp_path):
    """With a map that names the torque, nothing else is read by its name."""
    log = clean_log()
    log["payload [g]"] = np.where(np.arange(len(log)) < len(log) / 2, 0.0, 2500.0)
    write(log, tmp_path / "logs" / "log.csv")
    found, _, text_of_map = both_ways([tmp_path / "logs"], tmp_path)
    assert 'payload = "g"' in text_of_map
    assert sorted(found[0]["payload"].unique()) == [0.0, 2.5]
    np.testing.assert_array_equal(found[0]["payload"], found[1]["payload"])
    assert "payload [g]: 0 to 2.5 kg" in text(inspect([tmp_path / "logs"], IngestSettings()))
