"""The mapping file names columns, units and the joint where detection fails."""

from pathlib import Path

import numpy as np
import pytest

from frictioncli import schemas, tables
from frictioncli.errors import MappingError
from frictioncli.logs.channels.channel_map import ChannelMap, read_map
from frictioncli.logs.channels.mapped_channels import mapped_channels
from frictioncli.logs.ingest import IngestSettings, ingest

from .logs import back_and_forth, kuka_columns, write

MAP = """
[channels]
time = "Uhr"
position = "Winkel-Wert"
torque = "M"
[units]
time = "ms"
position = "rad"
torque = "mNm"
[joint]
number = 4
"""


def write_map(tmp_path, text):
    path = tmp_path / "channels.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_map_names_columns_units_and_joint(tmp_path):
    time, position, _, torque = back_and_forth()
    columns = {
        "Uhr": time * 1000,
        "Winkel-Wert [bogus]": np.radians(position),
        "M": torque * 1000,
        "torque_1": torque * 0,
    }
    log = write(tmp_path / "log.csv", columns, digits=12)
    ingest([log], tmp_path / "work", IngestSettings(map_file=write_map(tmp_path, MAP)))
    table = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    assert set(table["joint"]) == {4}
    np.testing.assert_allclose(table["time"], time, atol=1e-9)
    np.testing.assert_allclose(table["position"], position, atol=1e-9)
    np.testing.assert_allclose(table["torque"], torque, atol=1e-9)
    assert "channels.toml" in tables.metadata(tmp_path / "work" / "samples.parquet")["inputs"]


def test_a_mapped_column_that_is_missing(tmp_path):
    log = write(tmp_path / "log.csv", kuka_columns())
    channel_map = write_map(tmp_path, '[channels]\ntorque = "GearTorque_Act2"\nposition = "X"\n')
    with pytest.raises(MappingError, match=r"no column 'GearTorque_Act2'.*close: GearTorq_Act2"):
        ingest([log], tmp_path / "work", IngestSettings(map_file=channel_map))
    assert not (tmp_path / "work").exists()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[channels\n", "cannot be read as a mapping file"),
        ("[chanels]\n", "unknown section: chanels.*did you mean channels"),
        ('[channels]\npositon = "a"\n', "unknown name in .channels.: positon.*position"),
        ("[channels]\nposition = 0\n", "expected a column name"),
        ('[units]\nposition = "furlong"\n', "'furlong'; expected one of deg, rad, udeg"),
        ('[units]\ntorque = "bar"\n', "expected one of N·m"),
        ('[csv]\ndelimiter = "x"\n', "delimiter = 'x'"),
        ('[csv]\ndecimal = "."\nencodng = "utf-8"\n', "encodng.*did you mean encoding"),
        ('[csv]\nencoding = "klingon"\n', "'klingon'"),
        ("[joint]\nnumber = 0\n", "number = 0"),
        ("[joint]\ngear_ratio = 0\n", "gear_ratio = 0"),
        ("channels = 3\n", "expected a section"),
    ],
)
def test_a_bad_map_says_where_and_what(tmp_path, text, message):
    with pytest.raises(MappingError, match=message) as caught:
        read_map(write_map(tmp_path, text))
    assert "channels.toml" in str(caught.value)


def test_a_missing_map(tmp_path):
    with pytest.raises(MappingError, match=r"nothing\.toml"):
        read_map(tmp_path / "nothing.toml")


def motor_log(tmp_path, ratio):
    """Write a log whose position and velocity are of the motor, in columns with plain names."""
    columns = kuka_columns()
    names = ["t [s]", "position [deg]", "velocity [deg/s]", "torque [Nm]"]
    values = dict(zip(names, columns.values(), strict=True))
    values["position [deg]"] = ratio * values["position [deg]"]
    values["velocity [deg/s]"] = ratio * values["velocity [deg/s]"]
    return write(tmp_path / "log.csv", values), columns


@pytest.mark.parametrize("names_columns", [True, False])
@pytest.mark.parametrize("torque_side", ["joint", "motor"])
def test_a_map_says_which_channels_are_at_the_motor(names_columns, torque_side, tmp_path):
    log, columns = motor_log(tmp_path, -80.0)
    text = f'[side]\nposition = "motor"\nvelocity = "motor"\ntorque = "{torque_side}"\n'
    text += "[joint]\ngear_ratio = -80\n"
    if names_columns:
        text += '[channels]\nposition = "position"\nvelocity = "velocity"\ntorque = "torque"\n'
    path = tmp_path / "channels.toml"
    path.write_text(text, encoding="utf-8")
    summary = ingest([log], tmp_path / "work", IngestSettings(map_file=path))
    table = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    np.testing.assert_allclose(table["position"], columns["AxisPos_Act2[°]"], atol=1e-7)
    np.testing.assert_allclose(table["velocity"], columns["AxisVel_Act2[°/s]"], atol=1e-7)
    factor = -80.0 if torque_side == "motor" else 1.0
    np.testing.assert_allclose(table["torque"], factor * columns["GearTorq_Act2[Nm]"], atol=1e-6)
    assert not any("is not used" in text for text in summary.warnings)


def test_a_gear_ratio_without_use_is_warned_of(tmp_path):
    log, _ = motor_log(tmp_path, 80.0)
    summary = ingest([log], tmp_path / "work", IngestSettings(gear_ratio=80.0))
    assert any("gear ratio 80 of joint 1 is not used" in text for text in summary.warnings)


def test_a_side_that_is_none(tmp_path):
    path = tmp_path / "channels.toml"
    path.write_text('[side]\nposition = "rotor"\n', encoding="utf-8")
    with pytest.raises(MappingError, match="expected joint or motor"):
        read_map(path)


@pytest.mark.parametrize("header", [True, False])
def test_a_map_in_one_line_names_columns_by_number(header, tmp_path):
    time, position, velocity, torque = back_and_forth()
    rows = np.stack([np.ones_like(time), time, np.radians(position), torque, velocity], axis=1)
    lines = [" ".join(f"{x:.12f}" for x in row) for row in rows]
    path = tmp_path / "log.txt"
    path.write_text("\n".join((["a b c d e"] if header else []) + lines), encoding="utf-8")
    text = "time=2,position=3:rad,torque=4:A,velocity=5:deg/s,joint=6"
    summary = ingest([path], tmp_path / "work", IngestSettings(map_file=Path(text)))
    assert (list(summary.samples), summary.torque_unit) == ([6], "A")
    table = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    np.testing.assert_allclose(table["position"], position, atol=1e-9)
    np.testing.assert_allclose(table["velocity"], velocity, atol=1e-9)
    np.testing.assert_allclose(table["torque"], torque, atol=1e-9)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("time=1,position", "expected name=column"),
        ("time=1,postion=2", "did you mean position"),
        ("time=1,position=2:furlong", "expected one of deg"),
        ("time=1,joint=zero", "expected a joint number"),
    ],
)
def test_a_bad_map_in_one_line(text, message):
    with pytest.raises(MappingError, match=message):
        read_map(Path(text))


@pytest.mark.parametrize(("number", "others"), [(2, {1, 3}), (3, {2, 4}), (1, None)])
def test_positions_of_other_joints_are_known_beside_a_mapped_one(number, others):
    """Pos_1 is joint 2 by its name; the map may count otherwise, but not below joint 1."""
    columns = ["t", "Pos_0", "Pos_1", "Pos_2", "cmd", "Current_1"]
    channel_map = ChannelMap(channels={"position": "Pos_1", "torque": "Current_1"})
    found = mapped_channels(channel_map, columns, number)
    positions = {c.joint: c.name for c in found if c.quantity == "position"}
    assert positions.pop(number) == "Pos_1"
    assert (set(positions) or None) == others


def test_columns_that_differ_in_a_number_need_not_be_positions():
    columns = ["t", "column 2", "column 3", "column 4"]
    channel_map = ChannelMap(channels={"position": "column 2", "torque": "column 4"})
    found = mapped_channels(channel_map, columns, 1)
    assert [c.name for c in found if c.quantity == "position"] == ["column 2"]
