"""Messages name what is missing, the joint it is of, and the command that helps."""

import numpy as np
import pytest

from frictioncli.deployment.settings import ExportSettings
from frictioncli.errors import LogError, NotEnoughData, TableError
from frictioncli.logs.ingest import IngestSettings, ingest
from frictioncli.stages.export import deployed
from frictioncli.stages.fit import fit
from frictioncli.stages.pair import pair
from frictioncli.stages.separate import separate
from tests.logs.logs import back_and_forth, kuka_columns, write


@pytest.mark.parametrize(
    ("stage", "file", "command"),
    [
        (pair, "samples.parquet", "ingest LOGS"),
        (separate, "pairs.parquet", "pair"),
        (fit, "torques.parquet", "separate"),
    ],
)
def test_a_stage_without_its_input_names_the_command(stage, file, command, tmp_path):
    with pytest.raises(
        TableError, match=rf"{file} is missing; make it with 'frictioncli {command}"
    ):
        stage(tmp_path)


def test_the_extended_model_is_made_by_diagnose(tmp_path):
    with pytest.raises(TableError, match="run 'frictioncli diagnose' first"):
        deployed(tmp_path, ExportSettings(to="json", extended=True))


def test_a_wrong_joint_lists_those_there_are(tmp_path):
    columns = kuka_columns()
    columns["AxisPos_Act3[°]"] = columns["AxisPos_Act2[°]"]
    columns["GearTorq_Act3[Nm]"] = columns["GearTorq_Act2[Nm]"]
    logs = [write(tmp_path / "run" / f"{name}.csv", columns) for name in "abc"]
    with pytest.raises(LogError) as caught:
        ingest([logs[0].parent], tmp_path / "work", IngestSettings(joints=(9,)))
    text = str(caught.value)
    assert text.endswith("a.csv and 2 more: no joint 9; there are torque channels of joint 2, 3")


def test_parts_of_different_joints_are_not_merged(tmp_path):
    """Joint 2 moves forward only, joint 3 in reverse only."""
    time, position, velocity, torque = back_and_forth()
    half = len(time) // 2
    columns = {"time [s]": time[:half]}
    for joint, part in ((2, slice(0, half)), (3, slice(half, 2 * half))):
        columns[f"q_{joint} [deg]"] = position[part]
        columns[f"qd_{joint} [deg/s]"] = velocity[part]
        columns[f"torque_{joint} [Nm]"] = torque[part]
    ingest([write(tmp_path / "log.csv", columns)], tmp_path / "work")
    with pytest.raises(NotEnoughData) as caught:
        pair(tmp_path / "work")
    text = str(caught.value)
    assert "joint 2: 1 constant-velocity parts forward at 40 to 40 deg/s, 0 constant" in text
    assert "joint 3: 0 constant-velocity parts forward, 1 constant-velocity parts reverse" in text


def test_a_sine_is_sent_to_regression(tmp_path):
    time = np.arange(0, 30, 0.01)
    columns = {"time [s]": time, "q_1 [deg]": 50 * np.sin(time), "torque_1 [Nm]": np.cos(time)}
    ingest([write(tmp_path / "log.csv", columns)], tmp_path / "work")
    with pytest.raises(NotEnoughData, match="separate --by regression") as caught:
        pair(tmp_path / "work")
    assert "loosen" not in str(caught.value)


def test_units_as_told_that_nothing_explains(tmp_path):
    columns = kuka_columns()
    columns["AxisVel_Act2[°/s]"] = columns["AxisVel_Act2[°/s]"] * 3.3
    log = write(tmp_path / "log.csv", columns)
    summary = ingest([log], tmp_path / "work", IngestSettings(velocity_unit="deg/s"))
    (warning,) = (text for text in summary.warnings if "as specified" in text)
    assert "None" not in warning
    assert "which no units explain" in warning
