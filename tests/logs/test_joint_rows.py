"""Long tables: each row is of one joint, which a column of numbers or names tells."""

import gzip
from pathlib import Path

import numpy as np
import pytest

from frictioncli import schemas, tables
from frictioncli.errors import LogError
from frictioncli.inspection.inspect import inspect
from frictioncli.logs.ingest import IngestSettings, ingest

from .logs import back_and_forth

TIME, POSITION, VELOCITY, TORQUE = back_and_forth()
SPEEDS = {0: 1.0, 1: 0.5, 2: 0.25}
"""Joint from 0 -> its part of the motion."""


def long_log(path, names, column="motor_id", order="turns", late=0.0):
    """Write a log of three joints; in turns, or one joint after the other."""
    rows = [
        (number, f"{time + late * joint:.6f},{names[joint]},{p * part:.6f},{v * part:.6f},{u}")
        for joint, part in SPEEDS.items()
        for number, (time, p, v, u) in enumerate(
            zip(TIME, POSITION, VELOCITY, TORQUE + joint, strict=True)
        )
    ]
    if order == "turns":
        rows.sort(key=lambda row: row[0])
    header = f"time [s],{column},position [deg],velocity [deg/s],torque [Nm]"
    path.write_text("\n".join([header, *(text for _, text in rows)]) + "\n")
    return path


def check(summary, work, joints):
    samples = tables.read(work / "samples.parquet", schemas.SAMPLES)
    assert sorted(set(samples["joint"])) == sorted(joints)
    assert summary.rows_read == summary.rows_kept == len(TIME) * len(joints)
    for joint, place in joints.items():
        found = samples[samples["joint"] == joint]
        np.testing.assert_allclose(found["position"], POSITION * SPEEDS[place], atol=2e-6)
        np.testing.assert_allclose(found["torque"], TORQUE + place, atol=2e-6)
        np.testing.assert_allclose(np.diff(found["time"]), np.diff(TIME), atol=1e-6)


@pytest.mark.parametrize("order", ["turns", "blocks"])
@pytest.mark.parametrize(
    ("names", "column", "joints"),
    [
        ((0, 1, 2), "motor_id", {1: 0, 2: 1, 3: 2}),
        ((1, 2, 3), "Joint No", {1: 0, 2: 1, 3: 2}),
        ((11, 12, 7), "servo_id", {11: 0, 12: 1, 7: 2}),
        # addresses of a bus
        ((0x142, 0x141, 0x200), "motor_id", {2: 0, 1: 1, 3: 2}),
        (("hip", "knee", "ankle"), "joint_name", {1: 0, 2: 1, 3: 2}),
        (("z_axis", '"a, axis"', "m"), "axis", {1: 0, 2: 1, 3: 2}),
    ],
)
def test_each_number_or_name_is_a_joint(tmp_path, names, column, joints, order):
    path = long_log(tmp_path / "log.csv", names, column, order)
    summary = ingest([path], tmp_path / "work", IngestSettings(batch_bytes=3000))
    check(summary, tmp_path / "work", joints)
    recordings = tables.read(tmp_path / "work" / "recordings.parquet", schemas.RECORDINGS)
    assert set(recordings["recording"]) == {"log.csv"} or set(recordings["recording"]) == {"log"}
    assert list(recordings["rows_read"]) == [len(TIME)] * 3


@pytest.mark.parametrize(
    ("clock", "cells"),
    [
        ("stamp_sec,stamp_nsec", lambda t: f"{1_700_000_000 + int(t)},{round(t % 1 * 1e9)}"),
        ("date,clock", lambda t: f"2026-05-04,23:59:{58 + t:09.6f}" if t < 2 else midnight(t)),
    ],
)
def test_names_beside_a_time_in_two_columns(tmp_path, clock, cells):
    """Joint states of ROS are written in long tables with seconds and nanoseconds."""
    rows = [
        f"{cells(time)},{name},{part * p:.6f},{u + joint:.6f}"
        for time, p, u in zip(TIME, POSITION, TORQUE, strict=True)
        for (joint, part), name in zip(SPEEDS.items(), ("hip", "knee", "ankle"), strict=True)
    ]
    log = tmp_path / "log.csv"
    log.write_text("\n".join([f"{clock},joint_name,position [deg],effort [Nm]", *rows, ""]))
    check(ingest([log], tmp_path / "work"), tmp_path / "work", {1: 0, 2: 1, 3: 2})


def midnight(time):
    """Return date and time of day two seconds after the first midnight of the log."""
    return f"2026-05-05,00:00:{time - 2:09.6f}"


def test_names_are_told(tmp_path):
    path = long_log(tmp_path / "log.csv", ("hip", "knee", "ankle"), "name")
    notes = "\n".join(ingest([path], tmp_path / "work").notes)
    assert "column name: hip is joint 1, knee is joint 2, ankle is joint 3" in notes
    files = inspect([path]).files
    assert [file.rows for file in files] == [len(TIME)] * 3
    assert [joint.joint for file in files for joint in file.joints] == [1, 2, 3]


def test_a_column_of_names_that_do_not_take_turns_may_name_other_things(tmp_path):
    path = long_log(tmp_path / "log.csv", ("cold", "warm", "hot"), "name", "blocks")
    recordings = inspect([path]).files
    assert [joint.joint for file in recordings for joint in file.joints] == [1]


def test_addresses_on_a_bus_are_told(tmp_path):
    path = long_log(tmp_path / "log.csv", (322, 321, 512))
    notes = "\n".join(ingest([path], tmp_path / "work").notes)
    assert "column motor_id: 321 is joint 1, 322 is joint 2, 512 is joint 3" in notes


@pytest.mark.parametrize("column", ["motor [°C]", "motor", "drive"])
def test_a_column_named_by_what_it_measures_is_no_joint(tmp_path, column):
    """A temperature in whole degrees, which rises through the log."""
    rows = [
        f"{t:.3f},{p:.6f},{u},{30 + i // 100}"
        for i, (t, p, u) in enumerate(zip(TIME, POSITION, TORQUE, strict=True))
    ]
    (tmp_path / "log.csv").write_text(f"time [s],q [deg],torque [Nm],{column}\n" + "\n".join(rows))
    summary = ingest([tmp_path / "log.csv"], tmp_path / "work")
    assert dict(summary.samples) == {1: len(TIME)}


@pytest.mark.parametrize(
    "options", [{"joints": (2,)}, {"map_file": Path("joint=2,time=1,torque=5")}]
)
def test_one_joint_can_be_chosen(tmp_path, options):
    path = long_log(tmp_path / "log.csv", (0, 1, 2))
    if "map_file" in options:
        options = {"map_file": Path("joint=2,time=1,position=3:deg,velocity=4:deg/s,torque=5:Nm")}
    check(ingest([path], tmp_path / "work", IngestSettings(**options)), tmp_path / "work", {2: 1})


def test_a_joint_that_is_not_there(tmp_path):
    path = long_log(tmp_path / "log.csv", (0, 1, 2))
    told = "no joint 9; column motor_id has the rows of joint 1, 2 and 3: choose one of them"
    with pytest.raises(LogError, match=told):
        ingest([path], tmp_path / "work", IngestSettings(joints=(9,)))


def test_a_file_that_is_refused_for_all_its_joints_is_named_once(tmp_path):
    names = ("hip" * 40, "knee" * 30, "ankle" * 24)  # more than is read to tell the form
    packed = gzip.compress(long_log(tmp_path / "log.csv", names, "joint_name").read_bytes())
    path = tmp_path / "log.csv.gz"
    path.write_bytes(packed[:-20])
    with pytest.raises(LogError, match="cannot be read beyond line") as told:
        ingest([path], tmp_path / "work")
    assert f"{path}: " in str(told.value)
    assert "more" not in str(told.value)


def test_joints_sampled_one_after_the_other(tmp_path):
    path = long_log(tmp_path / "log.csv", (1, 2, 3), late=0.001)
    check(ingest([path], tmp_path / "work"), tmp_path / "work", {1: 0, 2: 1, 3: 2})


@pytest.mark.parametrize("names", [(1, 2, 3), ("hip", "knee", "ankle")])
def test_rows_of_no_joint_are_counted_once(tmp_path, names):
    path = long_log(tmp_path / "log.csv", names)
    lines = path.read_text().splitlines()
    lines[100] = "torn"
    lines[200] = "0.1,,1,1,1"
    lines[300] = f"1.188,{names[1]},x,1,1"
    lines[400] = "1.6,damaged,1,1,1"
    lines[500] = "2.0,-1,1,1,1"
    path.write_text("\n".join(lines))
    summary = ingest([path], tmp_path / "work")
    assert summary.rows_read == 3 * len(TIME)
    assert summary.rows_kept + sum(summary.rows_rejected.values()) == summary.rows_read
    assert summary.rows_rejected["wrong_field_count"] == 1
    assert sum(summary.rows_rejected.values()) == 5
    rejected = tables.read(tmp_path / "work" / "rejected.parquet", schemas.REJECTED)
    assert sorted(rejected["row"]) == [101, 201, 301, 401, 501]
    assert "torn" in set(rejected["text"])


def test_a_column_beside_numbered_columns_is_no_joint(tmp_path):
    """A program that tells which axis it moves: the columns number the joints."""
    rows = [
        f"{t:.3f},{1 + (i > len(TIME) // 2)},{p:.6f},0,{u},0"
        for i, (t, p, u) in enumerate(zip(TIME, POSITION, TORQUE, strict=True))
    ]
    header = "time [s],axis,q_1 [deg],q_2 [deg],torque_1 [Nm],torque_2 [Nm]"
    (tmp_path / "log.csv").write_text("\n".join([header, *rows]))
    summary = ingest([tmp_path / "log.csv"], tmp_path / "work", IngestSettings(joints=(1,)))
    assert (summary.files_read, summary.rows_kept) == (1, len(TIME))
