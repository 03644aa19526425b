"""Layouts of common loggers, each written from its description."""

import numpy as np
import pytest

from frictioncli import schemas, tables
from frictioncli.errors import LogError
from frictioncli.logs.ingest import IngestSettings, ingest

from .logs import back_and_forth, kuka_columns, text_of, write

TIME, POSITION, VELOCITY, TORQUE = back_and_forth()


def samples(work):
    return tables.read(work / "samples.parquet", schemas.SAMPLES)


def check(table, torque=TORQUE, velocity_error=1e-6):
    np.testing.assert_allclose(table["time"], TIME, atol=1e-6)
    np.testing.assert_allclose(table["position"], POSITION, atol=1e-6)
    np.testing.assert_allclose(table["torque"], torque, atol=1e-6)
    np.testing.assert_allclose(table["velocity"], VELOCITY, atol=velocity_error)


def test_universal_robots_recording(tmp_path):
    """Blanks between columns, blank lines between rows, joints from 0, rad, uptime as time."""
    columns = {"timestamp": TIME + 4021.128}
    for joint in range(3):
        moves = 1.0 if joint == 1 else 0.0
        columns[f"target_q_{joint}"] = TIME * 0
        columns[f"actual_q_{joint}"] = np.radians(POSITION) * moves
        columns[f"actual_qd_{joint}"] = np.radians(VELOCITY) * moves
        columns[f"actual_current_{joint}"] = TORQUE * moves
        columns[f"joint_temperatures_{joint}"] = 30 + TIME / 100 + joint
    text = text_of(columns, delimiter=" ", digits=12).replace("\n", "\r\n\r\n")
    (tmp_path / "robot_data.csv").write_bytes(text.encode())
    summary = ingest([tmp_path / "robot_data.csv"], tmp_path / "work")
    table = samples(tmp_path / "work")
    assert set(table["joint"]) == {2}
    assert summary.torque_unit == "A"
    check(table)
    np.testing.assert_allclose(table["motor_temperature"], 31 + TIME / 100, atol=1e-9)


def test_franka_time_in_milliseconds_is_found_from_velocity(tmp_path):
    columns = {
        "time": TIME * 1000,
        "state.q[0]": np.radians(POSITION),
        "state.q_d[0]": np.radians(POSITION) + 1,
        "state.dq[0]": np.radians(VELOCITY),
        "state.tau_J[0]": TORQUE,
    }
    ingest([write(tmp_path / "log.csv", columns, delimiter=",", digits=12)], tmp_path / "work")
    check(samples(tmp_path / "work"))


def test_collector_with_sample_time_in_the_last_column(tmp_path):
    columns = {
        "Iststrom_A2 (A)": TORQUE,
        "Istposition_A2 (°)": POSITION * 90.72,
        "Motortemperatur_A2 (K)": 300 + TIME * 0,
        "Sample": TIME * 1000,
    }
    log = write(tmp_path / "log.csv", columns, encoding="utf-8-sig")
    ingest([log], tmp_path / "work", IngestSettings(gear_ratio=90.72))
    # rounded corners of the trapezoid: half a window times 200 deg/s²
    check(samples(tmp_path / "work"), velocity_error=5.0)


def test_kuka_trace_with_tool_position_and_motor_torque(tmp_path):
    angle = np.radians(POSITION)
    columns = {
        "Zeit[sec]": TIME,
        "X_Act[mm]": 400 * np.cos(angle),
        "Y_Act[mm]": 400 * np.sin(angle),
        "Z_Act[mm]": 0 * angle + 500,
        "AxisPos_Act1[°]": 0 * angle,
        "AxisPos_Act2[°]": angle,
        "GearTorq_Act2[Nm]": TORQUE,
        "DriveMotorTorq_Act2[Nm]": TORQUE / 100,
    }
    log = write(tmp_path / "x_KRCIpo.csv", columns, encoding="cp1252", digits=12)
    summary = ingest([log], tmp_path / "work")
    assert summary.torque_side == "motor"
    assert any("lever of 0.4 m: read as rad" in note for note in summary.notes)
    check(samples(tmp_path / "work"), torque=TORQUE / 100, velocity_error=5.0)


def test_excel_separator_line_and_quotes(tmp_path):
    text = text_of(kuka_columns()).replace("Zeit[sec];", '"Zeit[sec]";')
    (tmp_path / "log.csv").write_text("sep=;\n" + text, encoding="utf-8")
    ingest([tmp_path / "log.csv"], tmp_path / "work")
    check(samples(tmp_path / "work"))


def test_quoted_decimal_commas_between_commas(tmp_path):
    columns = kuka_columns()
    lines = [",".join(f'"{name}"' for name in columns)]
    for row in zip(*columns.values(), strict=True):
        lines.append(",".join(f'"{value:.9f}"'.replace(".", ",") for value in row))
    (tmp_path / "log.csv").write_text("\n".join(lines), encoding="utf-8")
    ingest([tmp_path / "log.csv"], tmp_path / "work")
    check(samples(tmp_path / "work"))


def test_preamble_lines_are_skipped(tmp_path):
    text = "Robot: KR 10\nOperator;X\n\n" + text_of(kuka_columns())
    (tmp_path / "log.csv").write_text(text, encoding="utf-8")
    ingest([tmp_path / "log.csv"], tmp_path / "work")
    check(samples(tmp_path / "work"))


def test_a_truncated_last_line_costs_one_row(tmp_path):
    text = text_of(kuka_columns()).rstrip("\n")
    (tmp_path / "log.csv").write_text(text[:-25], encoding="utf-8")
    summary = ingest([tmp_path / "log.csv"], tmp_path / "work")
    assert summary.rows_rejected == {"wrong_field_count": 1}
    assert summary.rows_kept == len(TIME) - 1


def test_decimal_comma_in_a_comma_separated_file(tmp_path):
    text = text_of(kuka_columns(), delimiter=",").replace(".", ",")
    (tmp_path / "log.csv").write_text(text, encoding="utf-8")
    with pytest.raises(LogError, match=r"header names 4 columns but the rows have 8 fields"):
        ingest([tmp_path / "log.csv"], tmp_path / "work")


def test_thousands_separators_are_refused_with_an_example(tmp_path):
    lines = ["Zeit[sec];AxisPos_Act2[°];GearTorq_Act2[Nm]"]
    lines += [f"{i / 100:.2f}".replace(".", ",") + ";1.234,5;2,5" for i in range(100)]
    (tmp_path / "log.csv").write_text("\n".join(lines), encoding="utf-8")
    with pytest.raises(LogError, match=r"not_a_number, for example line 2: 0,00;1\.234,5;2,5"):
        ingest([tmp_path / "log.csv"], tmp_path / "work")


def test_two_layouts_in_one_run(tmp_path):
    columns = kuka_columns()
    write(tmp_path / "run" / "a.csv", columns)
    columns["Motortemperatur2[°C]"] = np.full(len(TIME), 33.25)
    write(tmp_path / "run" / "b.csv", columns, delimiter="\t", decimal=",")
    ingest([tmp_path / "run"], tmp_path / "work")
    table = samples(tmp_path / "work")
    assert table[table["recording"] == "a"]["motor_temperature"].isna().all()
    assert (table[table["recording"] == "b"]["motor_temperature"] == 33.25).all()


def test_a_long_rest_before_the_motion(tmp_path):
    """The survey skips 30000 rows at rest to find that positions are in rad."""
    rest = np.zeros(30_000)
    time = np.arange(30_000 + len(TIME)) * 0.012
    columns = {
        "t [s]": time,
        "q_2": np.concatenate((rest + np.radians(POSITION[0]), np.radians(POSITION))),
        "torque_2 [Nm]": np.concatenate((rest, TORQUE)),
    }
    summary = ingest([write(tmp_path / "log.csv", columns, digits=12)], tmp_path / "work")
    assert any("read as rad" in note for note in summary.notes)
    assert samples(tmp_path / "work")["position"].min() == pytest.approx(-50, abs=1e-6)


def test_a_gap_is_not_differentiated_across(tmp_path):
    columns = kuka_columns()
    del columns["AxisVel_Act2[°/s]"]
    keep = (TIME < 1.0) | (TIME > 1.6)
    log = write(tmp_path / "log.csv", {name: v[keep] for name, v in columns.items()})
    ingest([log], tmp_path / "work")
    table = samples(tmp_path / "work")
    middle = (table["time"] > 0.5) & (table["time"] < 2.5)
    np.testing.assert_allclose(table["velocity"][middle], 40.0, rtol=1e-6)


@pytest.mark.parametrize("value", [0.0, np.nan])
def test_a_velocity_column_without_values_is_not_used(tmp_path, value):
    columns = kuka_columns()
    columns["AxisVel_Act2[°/s]"] = np.full(len(TIME), value)
    summary = ingest([write(tmp_path / "log.csv", columns)], tmp_path / "work")
    check(samples(tmp_path / "work"), velocity_error=5.0)
    assert any("empty or zero in the rows looked at" in note for note in summary.notes)


def test_joints_that_are_left_out_are_named(tmp_path):
    columns = kuka_columns()
    columns["GearTorq_Act3[Nm]"] = TORQUE
    columns["AxisPos_Act4[°]"] = POSITION
    columns["GearTorq_Act4[Nm]"] = TORQUE * 0
    summary = ingest([write(tmp_path / "log.csv", columns)], tmp_path / "work")
    assert list(summary.samples) == [2]
    notes = " ".join(summary.notes)
    assert "joint 3: no position" in notes
    assert "left out: torque of joint 4: GearTorq_Act4[Nm] holds only zeros" in notes


def test_the_work_folder_among_the_logs_is_not_read(tmp_path):
    write(tmp_path / "log.csv", kuka_columns())
    for _ in range(2):
        summary = ingest([tmp_path], tmp_path / "friction-run")
    assert summary.files_rejected == ()


def told(tmp_path, payload, name="payload [kg]"):
    """Return the payloads of the samples of a log with such a column."""
    columns = {"time": TIME, "q_1 [deg]": POSITION, "qd_1 [deg/s]": VELOCITY, "tau_1 [Nm]": TORQUE}
    log = write(tmp_path / "log.csv", columns | {name: payload}, delimiter=",")
    summary = ingest([log], tmp_path / "work")
    return samples(tmp_path / "work")["payload"].to_numpy(float), " ".join(summary.notes)


def test_what_a_gripper_carries_is_read(tmp_path):
    half = np.where(TIME < 3.0, 0.0, 1500.0)
    found, _ = told(tmp_path, half, "payload (g)")
    np.testing.assert_allclose(found, half / 1000)


def test_a_measured_payload_has_too_many_values_to_tell_moves_apart(tmp_path):
    found, notes = told(tmp_path, 2.0 + 0.01 * np.sin(TIME))
    assert np.isnan(found).all()
    assert "holds no payloads" in notes


@pytest.mark.parametrize(
    ("encoding", "time", "position", "torque"),
    [
        ("gbk", "时间(s)", "关节1位置(deg)", "关节1力矩(Nm)"),
        ("cp932", "時刻(s)", "関節1角度(deg)", "関節1トルク(Nm)"),
        ("big5", "時間(s)", "關節1位置(deg)", "關節1轉矩(Nm)"),
    ],
)
def test_code_pages_of_chinese_and_japanese_loggers(encoding, time, position, torque, tmp_path):
    log = write(tmp_path / "log.csv", {time: TIME, position: POSITION, torque: TORQUE}, encoding)
    summary = ingest([log], tmp_path / "work")
    check(samples(tmp_path / "work"), velocity_error=3.0)
    assert any("names of columns are read as" in note for note in summary.notes)
