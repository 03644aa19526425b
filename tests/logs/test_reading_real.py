"""Logs of real robots, where they are at hand."""

import numpy as np
import pytest

from frictioncli import schemas, tables
from frictioncli.errors import LogError
from frictioncli.logs.ingest import IngestSettings, ingest

from .logs import REAL

pytestmark = pytest.mark.skipif(
    not REAL.is_dir(), reason=f"no real logs beside the project: {REAL}"
)


def samples(work):
    return tables.read(work / "samples.parquet", schemas.SAMPLES)


def test_kuka_kr3_is_in_radians_and_on_the_motor(tmp_path):
    summary = ingest([REAL / "kuka-kr3" / "PTP_Vel"], tmp_path, IngestSettings(joints=(3,)))
    table = samples(tmp_path)
    assert summary.files_read == 4
    assert (summary.torque_unit, summary.torque_side) == ("N·m", "motor")
    assert table["position"].min() == pytest.approx(55, abs=0.1)
    assert table["position"].max() == pytest.approx(145, abs=0.1)
    assert {(file.file.rsplit(".", 1)[1], file.reason) for file in summary.files_rejected} == {
        ("csv", "same_recording")
    }
    assert len(summary.files_rejected) == 8
    rows = tables.read(tmp_path / "recordings.parquet", schemas.RECORDINGS)
    assert rows["payload"].tolist() == [0.661] * 4
    assert rows["started_at"].tolist() == [
        f"2021-05-19T{clock}+00:00"
        for clock in ("15:03:52.944500", "15:04:49.716500", "15:05:17.592500", "15:05:43.344500")
    ]


def test_kuka_kr3_velocity_of_the_drive_adds_up_to_the_way_of_the_joint(tmp_path):
    """True deg/s, as the drive says, through a gear of 89.25."""
    ingest([REAL / "kuka-kr3" / "PTP_Vel"], tmp_path, IngestSettings(joints=(3,)))
    for _, part in samples(tmp_path).groupby("recording"):
        way = np.sum(np.abs(np.diff(part["position"])))
        assert np.trapezoid(part["velocity"].abs(), part["time"]) == pytest.approx(way, rel=1e-3)


def test_kuka_kr3_half_difference(tmp_path):
    """0.136 N·m at 46 deg/s and 0.312 at 229, measured from these files by another program."""
    ingest([REAL / "kuka-kr3" / "PTP_Vel"], tmp_path, IngestSettings(joints=(3,)))
    table = samples(tmp_path)
    for name, speed, friction in (("_10_", 45.7, 0.136), ("_50_", 228.0, 0.312)):
        part = table[table["recording"].str.contains(name)]
        steady = part[np.abs(part["velocity"].abs() - speed) < 0.02 * speed]
        bins = (steady["position"] // 5).astype(int)
        means = steady["torque"].groupby([bins, steady["velocity"] > 0]).mean().unstack()
        assert (means[True] - means[False]).mean() / 2 == pytest.approx(friction, abs=0.006)


def test_kuka_kr3_combined(tmp_path):
    summary = ingest([REAL / "kuka-kr3" / "PTP_Combined"], tmp_path)
    assert (summary.files_read, summary.rows_read) == (11, 2598)
    assert list(summary.samples) == [2, 3]


XARM = """
[channels]
time = "Time (s)"
position = "Pos_1"
velocity = "Velocity_1"
torque = "Current_1"
load = "Torque_1"
motor_temperature = "Temp_1"
[units]
position = "deg"
velocity = "deg/s"
torque = "A"
load = "N·m"
motor_temperature = "°C"
[joint]
number = 2
"""


def test_xarm_with_a_map(tmp_path):
    channel_map = tmp_path / "channels.toml"
    channel_map.write_text(XARM, encoding="utf-8")
    summary = ingest([REAL / "xarm6-j2"], tmp_path / "work", IngestSettings(map_file=channel_map))
    table = samples(tmp_path / "work")
    assert (summary.files_read, summary.rows_read, summary.torque_unit) == (14, 8400, "A")
    assert [file.reason for file in summary.files_rejected] == ["empty_file"]
    assert set(table["joint"]) == {2}
    assert table["load"].notna().all()
    difference = table["motor_temperature"] - table["motor_temperature_reading"]
    assert 0 < difference.abs().max() <= 0.5


def test_ur3_without_positions_is_refused(tmp_path):
    with pytest.raises(LogError, match=r"no position channel.*Current_J0.*--map"):
        ingest([REAL / "ur3-cobotops"], tmp_path / "work")
    assert not (tmp_path / "work").exists()


def test_nist_velocity_is_in_rad_per_second(tmp_path):
    summary = ingest([REAL / "nist-ur5"], tmp_path, IngestSettings(joints=(1,)))
    table = samples(tmp_path)
    change = np.gradient(table["position"], table["time"])
    moving = table["velocity"].abs() > 5
    assert np.median(change[moving] / table["velocity"][moving]) == pytest.approx(1, abs=0.01)
    assert summary.rows_kept == 7906


def test_damiao_is_in_radians_by_its_range(tmp_path):
    """Speeds are commanded up to 8 rad/s; without units, positions wrap at ±12.5."""
    summary = ingest([REAL / "damiao-5"], tmp_path)
    speed = samples(tmp_path)["velocity"].abs().max()
    assert np.radians(speed) == pytest.approx(8.0, abs=0.2)
    assert any("wraps at ±12.5" in note and "read as rad" in note for note in summary.notes)
