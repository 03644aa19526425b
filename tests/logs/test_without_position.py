"""Logs of drives with velocity and torque only: position is integrated, pairs go by speed."""

import numpy as np
import pandas as pd
import pytest

from frictioncli import schemas, tables
from frictioncli.errors import LogError
from frictioncli.inspection.inspect import inspect
from frictioncli.logs.ingest import IngestSettings, ingest
from frictioncli.stages.pair import pair

from .logs import REAL, back_and_forth, write

HEAD = """Date:;2020-07-08 21:24:28
Firmware Version:;0x0120;0x6150;0x0000;0x0000
Max. samples:;{rows}
Sampling period:;10.000
Scale:;0;True;1.000;10.000;-14.000;-6.000
Trigger:;1;0.000000;"Parameter values";"Channel 1";"Rising above value"
;Velocity actual value averaged;Torque actual value averaged
ms;rpm;%
"""


def recorder_file(folder, speed, *, seconds=4.0, minute=0):
    """Write a recording of a motor that turns at a constant speed [rpm]; friction opposes it."""
    rng = np.random.default_rng(abs(int(speed)))
    time = np.arange(0.0, seconds, 0.01)
    torque = np.sign(speed) * (20 + 0.05 * abs(speed)) + rng.normal(0, 0.5, len(time))
    rows = [f"{1000 * t:.3f};{speed:.0f};{m:.1f}\r\n" for t, m in zip(time, torque, strict=True)]
    head = HEAD.format(rows=len(rows)).replace("21:24:28", f"21:{minute:02d}:28")
    name = f"{'n' if speed < 0 else ''}{abs(speed)}.csv"
    (folder / name).write_text(head + "".join(rows), encoding="utf-8", newline="")
    return time, torque


@pytest.fixture
def drive(tmp_path):
    folder = tmp_path / "drive"
    folder.mkdir()
    for number, speed in enumerate([10, -10, 40, -40, 90, -90, 160, -160]):
        recorder_file(folder, speed, minute=number)
    return folder


def test_the_recorder_of_epos_studio_is_read(drive, tmp_path):
    summary = ingest([drive], tmp_path / "work")
    assert (summary.files_read, summary.torque_unit, summary.time_known) == (8, "%", True)
    assert any("paired by speed alone" in note for note in summary.notes)
    table = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    part = table[table["recording"] == "n40"]
    assert (part["velocity"] == -240.0).all()
    np.testing.assert_allclose(part["position"], -240.0 * np.arange(0.0, 4.0, 0.01), atol=1e-6)
    assert part["time"].iloc[0] == pytest.approx(180.0)  # the fourth, three minutes later


def test_pairs_go_by_speed(drive, tmp_path):
    """Friction of 20 % + 0.05 % per rpm, whatever the angle."""
    work = tmp_path / "work"
    ingest([drive], work, IngestSettings(rated_torque=0.5))
    pair(work)
    pairs = tables.read(work / "pairs.parquet", schemas.PAIRS)
    assert pairs["speed"].tolist() == pytest.approx([60.0, 240.0, 540.0, 960.0])
    friction = (pairs["torque_forward"] - pairs["torque_reverse"]) / 2
    expected = 0.005 * (20 + 0.05 * pairs["speed"] / 6)
    np.testing.assert_allclose(friction, expected, rtol=0.02)


def test_inspect_says_that_the_logs_suffice(drive):
    (joint,) = inspect([drive]).joints
    assert {stage.name: stage.suffices for stage in joint.stages}["pair"] != "no"


@pytest.mark.parametrize("batch_bytes", [1000, 1 << 22])
def test_the_integral_does_not_depend_on_batches(batch_bytes, tmp_path):
    time, position, velocity, torque = back_and_forth()
    log = pd.DataFrame({"time [s]": time, "velocity [deg/s]": velocity, "torque [Nm]": torque})
    path = write(tmp_path / "log.csv", dict(log.items()))
    ingest([path], tmp_path / "work", IngestSettings(batch_bytes=batch_bytes))
    table = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    np.testing.assert_allclose(table["position"], position - position[0], atol=0.1)


@pytest.mark.parametrize("channel", ["time [s]", "velocity [deg/s]"])
@pytest.mark.parametrize("value", [1e9, -1e18, 1e308])
def test_a_damaged_value_costs_its_row(channel, value, tmp_path):
    """The integral of all later rows would be beyond every limit, or tell other units."""
    time, position, velocity, torque = back_and_forth()
    columns = {"time [s]": time, "velocity [deg/s]": velocity, "torque [Nm]": torque}
    columns[channel] = columns[channel].copy()
    columns[channel][100] = value
    pd.DataFrame(columns).to_parquet(tmp_path / "log.parquet")
    summary = ingest([tmp_path / "log.parquet"], tmp_path / "work")
    assert summary.rows_kept == len(time) - 1
    table = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    expected = np.delete(position, 100) - position[0]
    # two periods at 40 deg/s may be missing
    np.testing.assert_allclose(table["position"], expected, atol=1.1)
    np.testing.assert_allclose(table["time"], np.delete(time, 100), atol=1e-9)


def test_a_motor_may_turn_any_number_of_times(tmp_path):
    """At 3000 rpm the angle is 1.8e6 deg after 100 s, more than any sensor shows."""
    time = np.arange(0.0, 100.0, 0.05)
    columns = {"time [s]": time, "velocity [rpm]": np.full(len(time), 3000.0)}
    path = write(tmp_path / "log.csv", columns | {"torque [Nm]": np.ones(len(time))})
    assert ingest([path], tmp_path / "work").rows_kept == len(time)
    table = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    np.testing.assert_allclose(table["position"], 18_000 * time, rtol=1e-9)


def test_several_joints_without_position_are_refused(tmp_path):
    """An arm carries a load that depends on the angles."""
    time, _, velocity, torque = back_and_forth()
    columns = {"time": time, "velocity_1": velocity, "velocity_2": velocity}
    columns |= {"torque_1": torque, "torque_2": torque}
    with pytest.raises(LogError, match="no position channel"):
        ingest([write(tmp_path / "log.csv", columns)], tmp_path / "work")


@pytest.mark.skipif(not REAL.is_dir(), reason=f"no real logs beside the project: {REAL}")
def test_epos_drive(tmp_path):
    """16 speeds; half differences measured from the files by another program."""
    ingest([REAL / "epos-drive1"], tmp_path)
    pair(tmp_path)
    pairs = tables.read(tmp_path / "pairs.parquet", schemas.PAIRS)
    friction = (pairs["torque_forward"] - pairs["torque_reverse"]) / 2
    for rpm in (20, 60, 100, 200):
        means = []
        for sign in ("", "n"):
            rows = (REAL / "epos-drive1" / f"{sign}{rpm}.csv").read_text("cp1252").split("\n")[14:]
            cells = [row.strip().split(";") for row in rows]
            means.append(np.mean([float(c[2]) for c in cells if len(c) == 3 and c[2]]))
        same = np.abs(pairs["speed"] - 6 * rpm) < 0.02 * 6 * rpm
        assert friction[same].to_numpy() == pytest.approx(abs(means[0] - means[1]) / 2, rel=0.02)
