"""Units in headers are checked against the values; gear ratios and torque units."""

import numpy as np
import pytest

from frictioncli import schemas, tables
from frictioncli.errors import LogError, OptionError
from frictioncli.logs.channels import position_units, unit_evidence, units
from frictioncli.logs.ingest import IngestSettings, ingest

from .logs import back_and_forth, kuka_columns, write


def samples(work):
    return tables.read(work / "samples.parquet", schemas.SAMPLES)


@pytest.mark.parametrize(
    ("text", "quantity", "unit"),
    [
        ("sec", "time", "s"),
        ("°", "position", "deg"),
        ("ï¿½", "position", "deg"),
        ("Â°", "position", "deg"),
        ("?", "position", "deg"),
        ("ï¿½/s", "velocity", "deg/s"),
        ("\ufffd/s", "velocity", "deg/s"),
        ("N·m", "torque", "N·m"),
        ("NÂ·m", "torque", "N·m"),
        ("Nm", "torque", "N·m"),
        ("%", "torque", "%"),
        ("A", "torque", "A"),
        ("ï¿½C", "motor_temperature", "°C"),
        ("Kelvin", "motor_temperature", "K"),
        ("bar", "torque", None),
        ("s", "position", None),
    ],
)
def test_spellings(text, quantity, unit):
    assert units.canonical(text, quantity) == unit


def test_conversion_factors():
    assert units.FACTORS["position"]["rad"] * np.pi == pytest.approx(180)
    assert units.FACTORS["velocity"]["rpm"] == 6
    fahrenheit = units.conversion_from("°F", "motor_temperature")
    assert 212 * fahrenheit.factor + fahrenheit.offset == pytest.approx(100)
    kelvin = units.conversion_from("K", "motor_temperature")
    assert 300 * kelvin.factor + kelvin.offset == pytest.approx(26.85)


@pytest.mark.parametrize(
    ("position_factor", "velocity_factor", "ratio"),
    [(1, 1, 1), (np.pi / 180, 1, np.pi / 180), (1, np.pi / 180, 180 / np.pi), (1e6, 1, 1e6)],
)
def test_motion_ratio(position_factor, velocity_factor, ratio):
    time, position, velocity, _ = back_and_forth()
    motion = unit_evidence.RawMotion(time, position * position_factor, velocity * velocity_factor)
    assert unit_evidence.motion_ratio([motion]) == pytest.approx(ratio, rel=0.01)


@pytest.mark.parametrize("channel", ["time", "position", "velocity"])
@pytest.mark.parametrize("value", [9.2e18, -1e4, 300.0, 0.0])
@pytest.mark.parametrize("row", [0, 7, 100, -1])
def test_one_damaged_value_does_not_change_the_motion_ratio(channel, value, row):
    """A clock in ms beside rad and rad/s: without the ratio the log is 1000 times too slow."""
    time, position, velocity, _ = back_and_forth()
    values = {"time": 1000 * time, "position": position.copy(), "velocity": velocity.copy()}
    values[channel][row] = value
    ratio = unit_evidence.motion_ratio([unit_evidence.RawMotion(**values)])
    assert ratio == pytest.approx(1e-3, rel=0.01)


@pytest.mark.parametrize(("begin", "damaged"), [(1.7e12, -1.0), (0.0, 1e18)])
def test_a_damaged_first_time_does_not_change_the_unit(begin, damaged, tmp_path):
    """Times since 1970 are known by their size: in ms here, or else in s from the begin."""
    time, position, _, torque = back_and_forth()
    per_second = 1000 if begin else 1
    clock = begin + per_second * time
    clock[0] = damaged
    columns = {"time": clock, "position [deg]": position, "torque [Nm]": torque}
    ingest([write(tmp_path / "log.csv", columns)], tmp_path / "work")
    found = samples(tmp_path / "work")["time"]
    np.testing.assert_allclose(np.diff(found), np.diff(time)[: len(found) - 1], atol=1e-3)


def test_tiny_velocities_have_no_motion_ratio():
    time, position, velocity, _ = back_and_forth()
    motion = unit_evidence.RawMotion(time, position, velocity * 1e-310)
    assert unit_evidence.motion_ratio([motion]) is None


def test_rest_and_noise_have_no_motion_ratio():
    time = np.arange(0, 5, 0.01)
    rng = np.random.default_rng(1)
    rest = unit_evidence.RawMotion(time, np.zeros_like(time), np.zeros_like(time))
    noise = unit_evidence.RawMotion(time, rng.normal(size=len(time)), rng.normal(size=len(time)))
    assert unit_evidence.motion_ratio([rest]) is None
    assert unit_evidence.motion_ratio([noise]) is None


def test_lever_arm_of_half_a_metre():
    angle = np.linspace(-1, 1, 400)  # [rad]
    tool = 500 * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    assert position_units.tool_path_per_angle(tool, angle[:, None]) == pytest.approx(500, rel=1e-4)
    in_rad = position_units.possible_position_units(
        largest=1, span=2, on_motor=False, paths_per_angle=(500,)
    )
    assert in_rad[0] == {"rad"}
    in_degrees_or_near_the_axis = position_units.possible_position_units(
        largest=5, span=4, on_motor=False, paths_per_angle=(500 * np.pi / 180,)
    )
    assert in_degrees_or_near_the_axis[0] == {"deg", "rad"}


@pytest.mark.parametrize("lever", [0.25, 0.5, 1.3])  # [m]
@pytest.mark.parametrize("per_metre", [1.0, 1000.0])
@pytest.mark.parametrize("per_degree", [np.pi / 180, 1.0])
def test_a_tool_in_metres_or_millimetres(tmp_path, lever, per_metre, per_degree):
    """Robots of many makers log the tool in m beside angles in rad, without any unit."""
    time, position, velocity, torque = back_and_forth()
    angle = np.radians(position)
    columns = {"time": time, "q1": per_degree * position, "q2": 0.3 + 0 * time}
    columns |= {"qd1": per_degree * velocity, "qd2": 0 * time}
    columns |= {"x": per_metre * lever * np.cos(angle), "y": per_metre * lever * np.sin(angle)}
    columns |= {"z": per_metre * 0.1 + 0 * time, "tau1": torque, "tau2": 0.1 + 0 * time}
    log = write(tmp_path / "log.csv", columns, delimiter=",", digits=9)
    ingest([log], tmp_path / "work", IngestSettings(joints=(1,)))
    np.testing.assert_allclose(samples(tmp_path / "work")["position"], position, atol=1e-5)


@pytest.mark.parametrize("lever", [0.0005, 0.005, 0.02, 0.04])  # [m]
def test_a_tool_near_the_axis_of_a_joint_in_rad(tmp_path, lever):
    """The flange of a wrist turns about its own axis, and a gripper is some mm off."""
    time, position, _, torque = back_and_forth()
    angle = np.radians(position)
    columns = {"time": time, "q6": angle, "tau6": torque, "x": 0.4 + lever * np.cos(angle)}
    columns |= {"y": 0.1 + lever * np.sin(angle), "z": 0.3 + 0 * time}
    ingest([write(tmp_path / "log.csv", columns, digits=9)], tmp_path / "work")
    np.testing.assert_allclose(samples(tmp_path / "work")["position"], position, atol=1e-5)


def test_a_header_in_degrees_is_doubted_where_the_tool_may_be_near_the_axis(tmp_path):
    """KUKA's traces may hold rad under [°]; this flange is 5 mm off the axis of the wrist."""
    time, position, _, torque = back_and_forth()
    angle = np.radians(position)
    columns = {"Zeit[sec]": time, "AxisPos_Act6[°]": angle, "GearTorq_Act6[Nm]": torque}
    columns |= {"X_Act[mm]": 400 + 5 * np.cos(angle), "Y_Act[mm]": 100 + 5 * np.sin(angle)}
    log = write(tmp_path / "log.csv", {**columns, "Z_Act[mm]": 300 + 0 * time}, digits=9)
    with pytest.raises(LogError, match="--position-unit"):
        ingest([log], tmp_path / "work")


def test_radians_under_a_degree_header(tmp_path):
    columns = kuka_columns()
    columns["AxisPos_Act2[°]"] = np.radians(columns["AxisPos_Act2[°]"])
    log = write(tmp_path / "log.csv", columns, digits=12)
    summary = ingest([log], tmp_path / "work")
    table = samples(tmp_path / "work")
    np.testing.assert_allclose(table["position"], kuka_columns()["AxisPos_Act2[°]"], atol=1e-8)
    np.testing.assert_allclose(table["velocity"], kuka_columns()["AxisVel_Act2[°/s]"], atol=1e-8)
    assert any("read as rad; force with --position-unit deg" in note for note in summary.notes)


def test_radians_without_unit_and_velocity(tmp_path):
    columns = kuka_columns()
    del columns["AxisVel_Act2[°/s]"]
    columns["AxisPos_Act2"] = np.radians(columns.pop("AxisPos_Act2[°]"))
    ingest([write(tmp_path / "log.csv", columns, digits=12)], tmp_path / "work")
    position = samples(tmp_path / "work")["position"]
    np.testing.assert_allclose(position, kuka_columns()["AxisPos_Act2[°]"], atol=1e-8)


def test_small_positions_under_a_degree_header_stay_degrees(tmp_path):
    """A joint that moves within ±6.3 deg; velocity agrees with the header."""
    columns = kuka_columns(speed=4.0, start=-6.0)
    ingest([write(tmp_path / "log.csv", columns)], tmp_path / "work")
    np.testing.assert_allclose(
        samples(tmp_path / "work")["position"], columns["AxisPos_Act2[°]"], atol=1e-8
    )


def test_small_positions_that_nothing_tells_are_asked_for(tmp_path):
    columns = kuka_columns(speed=4.0, start=-6.0)
    del columns["AxisVel_Act2[°/s]"]
    log = write(tmp_path / "log.csv", columns)
    with pytest.raises(LogError, match=r"AxisPos_Act2\[°\] says °, but .*--position-unit"):
        ingest([log], tmp_path / "work")
    for unit, factor in (("deg", 1.0), ("rad", 180 / np.pi)):
        ingest([log], tmp_path / "work", IngestSettings(position_unit=unit))
        np.testing.assert_allclose(
            samples(tmp_path / "work")["position"], factor * columns["AxisPos_Act2[°]"], rtol=1e-9
        )


def test_a_motor_that_turns_twice_in_radians(tmp_path):
    """Positions beyond ±6.9 under a header of rad; velocity in rad/s agrees."""
    truth = kuka_columns(seconds=30.0, speed=60.0)
    columns = {
        "time [s]": truth["Zeit[sec]"],
        "position [rad]": np.radians(truth["AxisPos_Act2[°]"]),
        "velocity [rad/s]": np.radians(truth["AxisVel_Act2[°/s]"]),
        "torque [Nm]": truth["GearTorq_Act2[Nm]"],
    }
    assert columns["position [rad]"].max() > 6.9
    ingest([write(tmp_path / "log.csv", columns, digits=12)], tmp_path / "work")
    position = samples(tmp_path / "work")["position"]
    np.testing.assert_allclose(position, truth["AxisPos_Act2[°]"], atol=1e-8)


def test_a_forced_unit_wins_with_a_warning(tmp_path):
    columns = kuka_columns()
    del columns["AxisVel_Act2[°/s]"]
    log = write(tmp_path / "log.csv", columns)
    summary = ingest([log], tmp_path / "work", IngestSettings(position_unit="rad"))
    position = samples(tmp_path / "work")["position"]
    np.testing.assert_allclose(position, np.degrees(columns["AxisPos_Act2[°]"]), atol=1e-6)
    assert any("as specified, but values reach" in text for text in summary.warnings)


def test_later_positions_that_contradict_radians_stop(tmp_path):
    """30000 samples within a radian, then degrees: the survey sees only the first 20000."""
    time = np.arange(0, 400, 0.01)
    position = np.where(time < 300, np.sin(time), 90 * np.sin(time))
    columns = {"time [s]": time, "q_2": position, "torque_2 [Nm]": np.cos(time)}
    log = write(tmp_path / "log.csv", columns)
    with pytest.raises(LogError, match=r"log\.csv line 300\d\d: q_2 is .* looked like rad"):
        ingest([log], tmp_path / "work")
    assert not (tmp_path / "work").exists()


def test_velocity_that_fits_no_unit_is_not_used(tmp_path):
    columns = kuka_columns()
    truth = columns["AxisVel_Act2[°/s]"]
    columns["AxisVel_Act2[°/s]"] = truth * 3.3
    summary = ingest([write(tmp_path / "log.csv", columns)], tmp_path / "work")
    error = samples(tmp_path / "work")["velocity"] - truth
    assert np.quantile(np.abs(error), 0.9) < 0.01
    assert any("is not used" in text for text in summary.warnings)


def test_velocity_of_opposite_sign_is_reversed(tmp_path):
    columns = kuka_columns()
    truth = columns["AxisVel_Act2[°/s]"].copy()
    columns["AxisVel_Act2[°/s]"] = -truth
    summary = ingest([write(tmp_path / "log.csv", columns)], tmp_path / "work")
    np.testing.assert_allclose(samples(tmp_path / "work")["velocity"], truth, atol=1e-8)
    assert any("opposite" in text for text in summary.warnings)


@pytest.mark.parametrize("header", ["MOT_TEMP_A2", "Motortemperatur2[°C]", "MotorTemp_Act2[K]"])
def test_kelvin_is_found(tmp_path, header):
    columns = kuka_columns()
    columns[header] = np.full(len(columns["Zeit[sec]"]), 300.0)
    ingest([write(tmp_path / "log.csv", columns)], tmp_path / "work")
    assert set(samples(tmp_path / "work")["motor_temperature"].round(9)) == {26.85}


@pytest.mark.parametrize("value", [0.0, -60.0, 170.0])
def test_implausible_temperatures_are_left_out(tmp_path, value):
    columns = kuka_columns()
    columns["Motortemperatur2[°C]"] = np.full(len(columns["Zeit[sec]"]), value)
    summary = ingest([write(tmp_path / "log.csv", columns)], tmp_path / "work")
    assert samples(tmp_path / "work")["motor_temperature"].isna().all()
    assert any("has no temperature" in note for note in summary.notes)


def test_percent_stays_percent_unless_the_rated_torque_is_known(tmp_path):
    columns = kuka_columns()
    columns["Drehmoment_A2[%]"] = columns.pop("GearTorq_Act2[Nm]")
    log = write(tmp_path / "log.csv", columns)
    summary = ingest([log], tmp_path / "work")
    assert summary.torque_unit == "%"
    assert any("with --rated-torque they are in N·m" in note for note in summary.notes)
    summary = ingest([log], tmp_path / "work", IngestSettings(rated_torque=0.5))
    assert summary.torque_unit == "N·m"
    torque = samples(tmp_path / "work")["torque"]
    np.testing.assert_allclose(torque, 0.005 * columns["Drehmoment_A2[%]"], atol=1e-9)
    summary = ingest([log], tmp_path / "work", IngestSettings(torque_unit="A"))
    assert summary.torque_unit == "A"


def test_motor_current(tmp_path):
    columns = kuka_columns()
    columns["Iststrom_A2 (mA)"] = columns.pop("GearTorq_Act2[Nm]")
    summary = ingest([write(tmp_path / "log.csv", columns)], tmp_path / "work")
    path = tmp_path / "work" / "samples.parquet"
    assert (summary.torque_unit, tables.facts(path)["torque_unit"]) == ("A", "A")
    assert samples(tmp_path / "work")["torque"].abs().max() == pytest.approx(0.025)


def drive_columns(ratio=-90.0):
    """Return a log of a drive: position in 1e-6 deg of the motor, torque at the motor."""
    time, position, velocity, torque = back_and_forth()
    return {
        "Zeit[sec]": time,
        "Istposition[°]": np.round(position * ratio * 1e6),
        "Istgeschwindigkeit[°/s]": velocity * ratio,
        "Istmoment[Nm]": torque / ratio,
    }


def test_motor_side_needs_a_gear_ratio(tmp_path):
    log = write(tmp_path / "x_NextGenDrive#3.csv", drive_columns())
    with pytest.raises(LogError, match="--gear-ratio"):
        ingest([log], tmp_path / "work")
    ingest([log], tmp_path / "work", IngestSettings(gear_ratio=-90.0))
    table = samples(tmp_path / "work")
    _, position, velocity, torque = back_and_forth()
    assert set(table["joint"]) == {3}
    np.testing.assert_allclose(table["position"], position, atol=1e-7)
    np.testing.assert_allclose(table["velocity"], velocity, atol=1e-7)
    np.testing.assert_allclose(table["torque"], torque, atol=1e-6)


def test_gear_ratio_found_from_both_positions(tmp_path):
    drive = drive_columns()
    columns = kuka_columns()
    del columns["GearTorq_Act2[Nm]"]
    columns["Istposition2[°]"] = drive["Istposition[°]"]
    columns["DriveMotorTorq_Act2[Nm]"] = drive["Istmoment[Nm]"]
    summary = ingest([write(tmp_path / "log.csv", columns)], tmp_path / "work")
    np.testing.assert_allclose(samples(tmp_path / "work")["torque"], back_and_forth()[3], rtol=1e-3)
    assert summary.torque_side == "joint"
    assert any("-90" in note for note in summary.notes)


@pytest.mark.parametrize(
    "option",
    [
        {"position_unit": "furlong"},
        {"torque_unit": "bar"},
        {"rated_torque": 0.0},
        {"joints": ()},
        {"joints": (0,)},
        {"gear_ratio": 0.0},
        {"gear_ratio": float("nan")},
    ],
)
def test_invalid_options_are_refused(option):
    with pytest.raises(OptionError, match="expected"):
        IngestSettings(**option)


def test_one_gear_ratio_does_not_fit_two_joints(tmp_path):
    columns = kuka_columns()
    columns["AxisPos_Act3[°]"] = columns["AxisPos_Act2[°]"]
    columns["DriveMotorTorq_Act3[Nm]"] = columns["GearTorq_Act2[Nm]"]
    log = write(tmp_path / "log.csv", columns)
    with pytest.raises(OptionError, match=r"has joints 2, 3; expected one joint"):
        ingest([log], tmp_path / "work", IngestSettings(gear_ratio=90.0))
    ingest([log], tmp_path / "work", IngestSettings(gear_ratio=90.0, joints=(3,)))
    np.testing.assert_allclose(
        samples(tmp_path / "work")["torque"], 90 * columns["DriveMotorTorq_Act3[Nm]"]
    )


def test_logs_that_differ_in_side(tmp_path):
    columns = kuka_columns()
    columns["AxisPos_Act3[°]"] = columns["AxisPos_Act2[°]"]
    columns["DriveMotorTorq_Act3[Nm]"] = columns["GearTorq_Act2[Nm]"]
    with pytest.raises(LogError, match="differ in side of the torque"):
        ingest([write(tmp_path / "log.csv", columns)], tmp_path / "work")


@pytest.mark.parametrize("damage", [292277026596.0, -1e30, 1e308])
def test_a_damaged_velocity_does_not_change_the_ratio(damage):
    """Otherwise it would raise the threshold of motion above all other samples."""
    time, position, velocity, _ = back_and_forth()
    broken = velocity.copy()
    broken[len(broken) // 3] = damage
    assert unit_evidence.motion_ratio(
        [unit_evidence.RawMotion(time, position, broken)]
    ) == pytest.approx(1.0, rel=0.01)


def test_the_range_of_positions_is_found_once_for_all_joints(tmp_path, monkeypatch):
    """Joints share their unit: for each one anew, 99 joints in 16 logs took a minute."""
    time, position, _, torque = back_and_forth()
    columns = {"time [s]": time}
    for joint in range(1, 8):
        columns |= {f"q_{joint}": np.radians(position), f"tau_{joint}": torque}
    looked = []
    found = position_units.position_range
    monkeypatch.setattr(
        position_units, "position_range", lambda motions: looked.append(1) or found(motions)
    )
    ingest([write(tmp_path / "log.csv", columns)], tmp_path / "work")
    assert len(looked) == 1
    np.testing.assert_allclose(samples(tmp_path / "work")["position"], np.tile(position, 7))


@pytest.mark.parametrize("per_degree", [np.pi / 180, 1.0])
@pytest.mark.parametrize("has_velocity", [False, True])
def test_motor_and_joint_without_units_have_the_same_one(tmp_path, per_degree, has_velocity):
    """The gear ratio converts the motor's torque: it may not be 57 times too small."""
    time, position, velocity, torque = back_and_forth()
    columns = {"time": time, "motor_position": 101 * per_degree * position + 3.0}
    if has_velocity:
        columns["motor_velocity"] = 101 * per_degree * velocity
    columns |= {"motor_torque": torque / 101, "joint_position": per_degree * position}
    ingest([write(tmp_path / "log.csv", columns, digits=9)], tmp_path / "work")
    found = samples(tmp_path / "work")
    np.testing.assert_allclose(found["torque"], torque, rtol=1e-3)
    np.testing.assert_allclose(found["position"], position, atol=1e-5)
    moves = np.abs(velocity) == np.max(velocity)
    np.testing.assert_allclose(found["velocity"][moves], velocity[moves], rtol=0.02)
