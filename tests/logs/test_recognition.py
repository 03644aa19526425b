"""Columns are recognised by name, and chosen for each joint."""

import numpy as np
import pytest

from frictioncli import schemas, tables
from frictioncli.errors import LogError
from frictioncli.logs.channels import units
from frictioncli.logs.channels.joint_channels import assign_channels
from frictioncli.logs.channels.recognition import joint_in_name, recognise_channels
from frictioncli.logs.ingest import IngestSettings, ingest
from frictioncli.logs.log_source import Refusal

from .logs import back_and_forth, kuka_columns, write


@pytest.mark.parametrize(
    ("column", "quantity", "joint", "side"),
    [
        ("Zeit[sec]", "time", None, "joint"),
        ("Zeit [s]", "time", None, "joint"),
        ("Time (s)", "time", None, "joint"),
        ('"timestamp"', "time", None, "joint"),
        ("AxisPos_Act2[°]", "position", 2, "joint"),
        ("AxisPos_Act_A2", "position", 2, "joint"),
        ("AxisAct_A2", "position", 2, "joint"),
        ("q_2", "position", 2, "joint"),
        ("Istposition[°]", "position", None, "motor"),
        ("ROBOT_ACTUAL_JOINT_POSITIONS (J3)", "position", 3, "joint"),
        ("A4 position [deg]", "position", 4, "joint"),
        ("axisQMsr", None, None, None),
        ("AxisVel_Act2[°/s]", "velocity", 2, "joint"),
        ("Istgeschwindigkeit[°/s]", "velocity", None, "motor"),
        ("DriveMotorTorq_Act3[Nm]", "torque", 3, "motor"),
        ("Istdrehmoment_A5 [Nm]", "torque", 5, ""),
        ("Iststrom_A2 (A)", "torque", 2, "motor"),
        ("Motortemperatur2", "motor_temperature", 2, "joint"),
        ("MOT_TEMP_A2", "motor_temperature", 2, "joint"),
        ("MotTemp_Act2[K]", "motor_temperature", 2, "joint"),
        ("Motortemperatur_Act_A2 [K]", "motor_temperature", 2, "joint"),
        ("joint_pos_meas3", "position", 3, "joint"),
        ("Temp_1", "motor_temperature", 1, "joint"),
        ("T_motor", "motor_temperature", None, "joint"),
        ("T_housing [°C]", "housing_temperature", None, "joint"),
        ("Gehäusetemperatur [°C]", "housing_temperature", None, "joint"),
        ("housing_temperature_3", "housing_temperature", 3, "joint"),
        ("present_position", "position", None, "joint"),
        ("q_msr2", "position", 2, "joint"),
        ("MsrTorque_A2", "torque", 2, "joint"),
        ("instCurrent_3", "torque", 3, "motor"),
        ("actual_current_as_torque_0", "torque", 1, "joint"),
        # RTDE by a script, a bridge of a robot to MQTT, YARP, and drives of Damiao
        ("actualI2", "torque", 2, "motor"),
        ("measured_tq_1", "torque", 1, "joint"),
        ("external_tq_1", None, None, None),
        ("tau_measured[2]", "torque", 2, "joint"),
        ("joint_angles_1", "position", 1, "joint"),
        ("motor_currents_1", "torque", 1, "motor"),
        ("t_rotor", "motor_temperature", None, "joint"),
        ("Tcoil_C", "motor_temperature", None, "joint"),
        ("t_mos", None, None, None),
        # what is current is present, but a current before anything else
        ("current_angle_deg", "position", None, "joint"),
        ("current joint velocity 2", "velocity", 2, "joint"),
        ("current_position_counts", None, None, None),
        ("current_2", "torque", 2, "motor"),
        ("current_limit", None, None, None),
        ("Motortemperatur Achse 1 [°C]", "motor_temperature", 1, "joint"),
        ("Motor Torque Axis 2 [%]", "torque", 2, ""),
        ("pos_joint_3", "position", 3, "joint"),
        ("Torque (Axis 3)", "torque", 3, "joint"),
        ("mechPos", "position", None, "joint"),
        ("axis1.encoder.pos_estimate", "position", 1, "joint"),
        ("axis0.motor.current_control.Iq_measured", "torque", 1, "motor"),
        ("axis0.motor_thermistor.temperature", "motor_temperature", 1, "joint"),
        ("axis0.fet_thermistor.temperature", None, None, None),
        ("axis0.controller.input_pos", None, None, None),
        ("tor(Nm)", "torque", None, "joint"),
        ("actuator2.position", "position", 2, "joint"),
        ("field.effort1", "torque", 1, "joint"),
        ("cur (A)", "torque", None, "motor"),
        ("FeedbackSpeed[min-1]", "velocity", None, "joint"),
        ("ExtTorque_A2", None, None, None),
        ("tau_ext_2", None, None, None),
        ("TorqueReference[%]", "torque", None, ""),  # where no torque was measured
        ("AxisPos_CmdIpo2[°]", None, None, None),
        ("Sollposition[°]", None, None, None),
        ("DriveMotorTorq_Cmd2[Nm]", None, None, None),
        ("ROBOT_TARGET_JOINT_TORQUES (J1)", None, None, None),
        ("Geschwindigkeitsdifferenz[°/s]", None, None, None),
    ],
)
def test_names(column, quantity, joint, side):
    found = recognise_channels([column])
    if quantity is None:
        assert found == ()
    else:
        meaning = found[0].meaning
        assert (meaning.quantity, found[0].joint, meaning.side) == (quantity, joint, side)


def test_joints_counted_from_zero_become_joints_from_one():
    assert [c.joint for c in recognise_channels(["t", "actual_q_0", "actual_q_5"])] == [None, 1, 6]


def test_motor_torque_goes_before_gear_torque_and_current():
    columns = ["Zeit", "Iststrom_A2", "GearTorq_Act2", "DriveMotorTorq_Act2", "AxisPos_Act2"]
    (joint,) = assign_channels(recognise_channels(columns), columns, joints=None, file_joint=1)
    assert joint.torque.name == "DriveMotorTorq_Act2"
    assert "not used: GearTorq_Act2, Iststrom_A2" in joint.notes[0]


def test_every_joint_with_a_torque_channel():
    columns = ["t", "q_1", "q_2", "q_3", "torque_2", "torque_3"]
    found = assign_channels(recognise_channels(columns), columns, joints=None, file_joint=1)
    assert [joint.joint for joint in found] == [2, 3]
    found = assign_channels(recognise_channels(columns), columns, joints=(3, 4), file_joint=1)
    assert [joint.joint for joint in found] == [3]


@pytest.mark.parametrize(
    ("columns", "reason"),
    [
        (["t", "q_2"], "no_torque_channel"),
        (["t", "torque_2"], "no_position_channel"),
        (["q_2", "torque_2"], "no_time_channel"),
    ],
)
def test_missing_channels_are_named(columns, reason):
    refusal = assign_channels(recognise_channels(columns), columns, joints=None, file_joint=1)
    assert isinstance(refusal, Refusal)
    assert refusal.reason == reason
    assert "--map" in refusal.text
    assert ", ".join(columns) in refusal.text


@pytest.mark.parametrize("column", ["T_oil", "gearTemp2 [°C]", "Kelvin"])
def test_a_temperature_of_unknown_name_is_not_left_out_in_silence(column):
    columns = ["t", "q", "tau", column]
    (joint,) = assign_channels(recognise_channels(columns), columns, joints=None, file_joint=1)
    (note,) = joint.notes
    assert column in note
    assert "motor_temperature" in note
    known = [*columns, "T_motor"]
    (joint,) = assign_channels(recognise_channels(known), known, joints=None, file_joint=1)
    assert not joint.notes


@pytest.mark.parametrize(
    ("column", "quantity", "joint", "unit"),
    [
        ("torque_nm", "torque", None, "N·m"),
        ("TORQUE_NM_2", "torque", 2, "N·m"),
        ("Torque in Nm", "torque", None, "N·m"),
        ("tau_Ncm", "torque", None, "N·cm"),
        ("torque_percent", "torque", None, "%"),
        ("Position/deg", "position", None, "deg"),
        ("pos_rad_2", "position", 2, "rad"),
        ("J3 pos degrees", "position", 3, "deg"),
        ("vel_rad_per_s", "velocity", None, "rad/s"),
        ("SPEED_DEG_PER_SEC", "velocity", None, "deg/s"),
        ("omega_radps", "velocity", None, "rad/s"),
        ("Winkel in Grad", "position", None, "deg"),
        ("velocity_rev_s", "velocity", None, "turn/s"),
        ("position_rot", "position", None, "turn"),
        ("Joint 2 Torque (% rated)", "torque", 2, "%"),
        ("t_s", "time", None, "s"),
        ("T1_C", "motor_temperature", 1, "°C"),
        ("T_K", "motor_temperature", None, "K"),
        ("motor_temp_C", "motor_temperature", None, "°C"),
        ("temp_K", "motor_temperature", None, "K"),
    ],
)
def test_units_are_the_last_words_of_a_known_name(column, quantity, joint, unit):
    (found,) = recognise_channels([column])
    assert (found.quantity, found.joint) == (quantity, joint)
    assert units.canonical(found.unit, quantity) == unit


@pytest.mark.parametrize(
    "column",
    ["current_B", "velocity_percent", "position_rev", "T_s", "t_k", "phase_C"],
)
def test_a_last_word_that_means_something_else_is_no_unit(column):
    """A phase, the share of an override, a way, the temperature of a surface, a sample's number."""
    assert recognise_channels([column]) == ()


@pytest.mark.parametrize(
    ("columns", "expected"),
    [
        (["t", "theta", "tau", "T"], ["time", "position", "torque", "motor_temperature"]),
        (["t", "theta", "T"], ["time", "position"]),
        (["T", "theta", "tau"], ["time", "position", "torque"]),
        (["T", "t_ms", "tau", "motor_temp"], ["time", "torque", "motor_temperature"]),
    ],
)
def test_a_capital_t_beside_a_time_is_no_time_but_a_temperature_beside_a_torque(columns, expected):
    assert [channel.quantity for channel in recognise_channels(columns)] == expected


@pytest.mark.parametrize(
    ("column", "joint"),
    [
        ("robot.joint_2.position", 2),
        ("arm/joint_4/position", 4),
        ("joint_states.position[1]", 1),
        ("/arm/joint_3/position", 3),
        ("commanded.joint_2.position", None),
        ("/arm/joint_3/command/position", None),
        ("/target/joint_3/position", None),
    ],
)
def test_the_last_parts_of_a_path_tell_what_is_measured(column, joint):
    found = recognise_channels([column])
    assert [(one.quantity, one.joint) for one in found] == ([("position", joint)] if joint else [])


@pytest.mark.parametrize(
    ("columns", "unit"),
    [
        (["t", "q", "current_A"], "A"),
        (["t", "q", "motor current_amps"], "A"),
        (["t", "q", "current_A", "current_B", "current_C"], None),
    ],
)
def test_a_current_in_ampere_is_not_that_of_a_phase(columns, unit):
    found = [one for one in recognise_channels(columns) if one.quantity == "torque"]
    assert [one.unit for one in found] == ([unit] if unit else [])


@pytest.mark.parametrize(
    "columns",
    [
        ["Tiempo (s)", "Posición (grados)", "Velocidad (grados/s)", "Temperatura (°C)"],
        ["tempo", "posizione", "velocità", "temperatura motore"],
    ],
)
def test_names_in_other_languages(columns):
    found = [channel.quantity for channel in recognise_channels(columns)]
    assert found == ["time", "position", "velocity", "motor_temperature"]


@pytest.mark.parametrize(
    ("column", "quantity", "joint"),
    [
        ("时间(s)", "time", None),
        ("时间戳", "time", None),
        ("关节1位置(rad)", "position", 1),
        ("关节2实际速度", "velocity", 2),
        ("电机电流_3(A)", "torque", 3),
        ("トルク[Nm]", "torque", None),
        ("電流2", "torque", 2),
        ("温度", "motor_temperature", None),
        ("目标位置", None, None),
        ("摩擦力矩", None, None),
        ("重力矩1", None, None),
    ],
)
def test_names_in_chinese_and_japanese(column, quantity, joint):
    """A torque of gravity or of friction is none that was measured."""
    found = [(c.quantity, c.joint, c.name) for c in recognise_channels([column])]
    assert found == ([] if quantity is None else [(quantity, joint, column)])


@pytest.mark.parametrize(
    ("columns", "clock"),
    [
        (["sim_time", "q1", "tau1"], "sim_time"),
        (["experiment_time_sec", "q1", "tau1"], "experiment_time_sec"),
        (["solve_time", "cycleTime_ms", "q1", "tau1"], None),
        (["t", "sim_time", "q1", "tau1"], "t"),
        (["ts_ms", "q1", "tau1"], "ts_ms"),
        (["T_s", "Ts [°C]", "q1", "tau1"], None),
    ],
)
def test_a_clock_is_known_by_its_last_word_where_there_is_no_other_time(columns, clock):
    times = [c.name for c in recognise_channels(columns) if c.quantity == "time"]
    assert times == ([] if clock is None else [clock])


QUATERNION = ["q0", "q1", "q2", "q3"]
FOUR = [f"q{i}" for i in range(1, 5)]
DOF = [f"dof_pos_{i}" for i in range(12)]


@pytest.mark.parametrize(
    ("columns", "positions"),
    [
        (["t", *QUATERNION, "motor_position", "torque"], ["motor_position"]),
        (["t", *FOUR, "joint1_pos", "joint2_pos", "tau1", "tau2"], ["joint1_pos", "joint2_pos"]),
        (["t", *QUATERNION, *DOF, *(f"dof_torque_{i}" for i in range(12))], DOF),
        # an arm of four joints, beside a gripper or its motors
        (["t", *FOUR, *(f"tau{i}" for i in range(1, 5)), "position"], [*FOUR, "position"]),
        (["t", *FOUR, *(f"motor_pos_{i}" for i in range(1, 5)), "tau1"], None),
        (["t", *FOUR, "tau1"], FOUR),
        (["t", "q1", "q2", "q3", "position", "tau"], ["q1", "q2", "q3", "position"]),
    ],
)
def test_a_quaternion_beside_positions_is_no_joint(columns, positions):
    found = [one.name for one in recognise_channels(columns) if one.quantity == "position"]
    assert found == (columns[1:-1] if positions is None else positions)


@pytest.mark.parametrize(
    ("columns", "currents"),
    [
        (["t", "q0", "q1", "i0", "i1"], 2),
        (["t", "q0", "q1", "i0"], 0),
        (["i", "t", "q", "x1"], 0),
        (["t", "AIPos_A1", "AIPos_A2", "i1", "i2"], 0),
        (["t", "q0", "q1", "i0", "i1", "tau0", "tau1"], 0),
    ],
)
def test_i_with_a_number_is_a_current_where_every_joint_has_one(columns, currents):
    found = [c for c in recognise_channels(columns) if c.quantity == "torque" and c.family == "i"]
    assert len(found) == currents


def quadruped(*joints):
    return ["t", *(f"{joint}_{what}" for joint in joints for what in ("q", "dq", "tauEst"))]


@pytest.mark.parametrize(
    ("columns", "joints"),
    [
        (quadruped("FR_0", "FR_1", "FR_2"), ["FR_0", "FR_1", "FR_2"]),
        (quadruped("LF_HAA", "LF_HFE", "LF_KFE", "base"), ["LF_HAA", "LF_HFE", "LF_KFE", "base"]),
        (quadruped("FR_0", "FR_1"), []),
        (
            ["t", *(f"{what}_{kind}" for kind in ("des", "meas", "err") for what in ("q", "tau"))],
            [],
        ),
    ],
)
def test_three_joints_with_position_and_torque_may_have_any_names(columns, joints):
    """Two may be the sides of a gear; words that say what kind of value it is are no joints."""
    found = recognise_channels(columns)
    assert list(dict.fromkeys(c.joint_name for c in found if c.joint_name)) == joints


def test_sensors_with_numbers_do_not_hide_joints_with_names():
    columns = [*quadruped("SP", "SR", "elbow"), "theta_1", "fx_1"]
    found = recognise_channels(columns)
    assert {c.joint_name for c in found if c.quantity == "torque"} == {"SP", "SR", "elbow"}


def test_a_log_of_one_joint_with_a_name():
    columns = ["time", "left_knee_pos", "left_knee_torque", "target_pos"]
    found = recognise_channels(columns)
    assert [(one.quantity, one.joint_name) for one in found] == [
        ("time", ""),
        ("position", "left_knee"),
        ("torque", "left_knee"),
    ]
    beside = recognise_channels(["position", "torque", *columns])
    assert {one.joint_name for one in beside} == {""}


@pytest.mark.parametrize(
    ("stem", "joint"),
    [("robot_NextGenDrive#3", 3), ("log_A2", 2), ("warm-up_j2", 2), ("log_2", None), ("s10", None)],
)
def test_joint_in_a_file_name(stem, joint):
    assert joint_in_name(stem) == joint


def test_columns_without_joint_number_are_of_the_joint_chosen(tmp_path):
    time, position, _, torque = back_and_forth()
    log = write(tmp_path / "log.csv", {"t": time, "position": position, "torque": torque})
    ingest([log], tmp_path / "a", IngestSettings(joints=(5,)))
    ingest([log], tmp_path / "b")
    joints = [
        set(tables.read(tmp_path / work / "samples.parquet", schemas.SAMPLES)["joint"])
        for work in "ab"
    ]
    assert joints == [{5}, {1}]


def test_duplicate_headers_take_the_first(tmp_path):
    lines = ["t;q_1;torque_1;q_1"]
    for t, q, _, u in np.stack(back_and_forth(), axis=1):
        lines.append(f"{t:.4f};{q:.6f};{u:.3f};999")
    (tmp_path / "log.csv").write_text("\n".join(lines))
    ingest([tmp_path / "log.csv"], tmp_path / "work")
    table = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    assert table["position"].max() < 100


def test_an_all_zero_torque_is_no_torque(tmp_path):
    columns = kuka_columns()
    columns["GearTorq_Act2[Nm]"] *= 0
    with pytest.raises(LogError, match="holds only zeros"):
        ingest([write(tmp_path / "log.csv", columns)], tmp_path / "work")


@pytest.mark.parametrize(("count", "joints"), [(1, 1), (2, 2), (99, 99), (100, 0)])
def test_names_are_of_joints_where_there_are_not_hundreds(count, joints):
    columns = [f"knee{i}x_{what}" for i in range(count) for what in ("pos", "torque")]
    found = {channel.joint for channel in recognise_channels(["t", *columns])} - {None}
    assert len(found) == joints
