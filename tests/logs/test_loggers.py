"""Logs of KUKA variables and of Universal Robots, written from their descriptions."""

import struct
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from frictioncli import schemas, tables
from frictioncli.logs.formats import open_log
from frictioncli.logs.ingest import IngestSettings, ingest
from frictioncli.logs.log_source import CsvHints, Refusal

from .containers import (
    COLUMNS,
    POSITION,
    TEMPERATURE,
    TIME,
    TORQUE,
    VELOCITY,
    assert_same_as_csv,
    without,
)
from .containers import samples as samples_of
from .logs import back_and_forth, text_of, write

KELVIN = np.round(TEMPERATURE + 273.15)


def check(table):
    np.testing.assert_allclose(table["time"], TIME, atol=1e-6)
    np.testing.assert_allclose(table["position"], POSITION, atol=1e-6)
    np.testing.assert_allclose(table["torque"], TORQUE, atol=1e-6)


def variable_log(cell, header="timestamp;AXIS_ACT;TORQUE_A2;CURR_A2;MOT_TEMP_A2;BRAKE_SIG"):
    """Return a log of KUKA variables; ``cell`` writes the axis structure from two angles."""
    rows = [
        f"{t:.3f};{cell(45.2, q)};{tau:.6f};{tau:.2f};{kelvin:.0f};63"
        for t, q, tau, kelvin in zip(TIME, POSITION, TORQUE, KELVIN, strict=True)
    ]
    return "\n".join([header, *rows, ""])


CELLS = {
    "full": lambda a, b: f"{{E6AXIS: A1 {a:.3f}, A2 {b:.9f}, A3 0.0, E1 0.0}}",
    "unnamed": lambda a, b: f"{{A1 {a}, A2 {b:.9f}}}",
    "bare": lambda a, b: f"A1 {a} A2 {b:.9f}",
    "quoted": lambda a, b: f'"A1 {a}, A2 {b:.9f}"',
    "exponents": lambda a, b: f"{{E6AXIS: A1 {a:.3e}, A2 {b:.12e}}}",
    "decimal commas": lambda a, b: f"A1 {a} A2 {b:.9f}".replace(".", ","),
}


@pytest.mark.parametrize("cell", CELLS)
def test_axis_structures_in_a_cell(tmp_path, cell):
    (tmp_path / "log.csv").write_text(variable_log(CELLS[cell]), encoding="cp1252")
    source = open_log(tmp_path / "log.csv", CsvHints())
    assert source.columns[1:3] == ("AXIS_ACT_A1", "AXIS_ACT_A2")
    table = samples_of(tmp_path / "log.csv", tmp_path / "work")
    check(table)
    # integer Kelvin: within half a step of the truth
    assert np.all(np.abs(table["motor_temperature"] - TEMPERATURE) < 1.0)


def test_rows_with_decimal_commas_among_others(tmp_path):
    lines = variable_log(CELLS["full"]).split("\n")
    lines[5:200] = [line.replace(".", ",") for line in lines[5:200]]
    (tmp_path / "log.csv").write_text("\n".join(lines), encoding="utf-8")
    check(samples_of(tmp_path / "log.csv", tmp_path / "work"))


def test_names_of_variables_with_dollar_and_index(tmp_path):
    header = "timestamp;$AXIS_ACT;$TORQUE_AXIS_ACT[2];$CURR_ACT[2];$MOT_TEMP[2];$BRAKE_SIG"
    (tmp_path / "log.csv").write_text(variable_log(CELLS["full"], header), encoding="utf-8")
    summary = ingest([tmp_path / "log.csv"], tmp_path / "work", IngestSettings(joints=(2,)))
    assert summary.torque_unit == "N·m"
    check(tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES))


def test_dates_as_time(tmp_path):
    begin = datetime(2024, 5, 6, 7, 8, 9, tzinfo=UTC)
    text = variable_log(CELLS["bare"])
    for t in TIME:
        stamp = (begin + timedelta(seconds=float(t))).isoformat().removesuffix("+00:00")
        text = text.replace(f"\n{t:.3f};", f"\n{stamp};", 1)
    (tmp_path / "log.csv").write_text(text, encoding="utf-8")
    check(samples_of(tmp_path / "log.csv", tmp_path / "work"))


def test_damaged_rows_are_counted(tmp_path):
    lines = variable_log(CELLS["full"]).split("\n")
    lines[3] = lines[3].replace("A2 ", "")
    lines[4] = lines[4].rpartition(";")[0]
    lines[5] = lines[5].replace(";63", ";63;")
    lines[6] = "x" + lines[6]
    lines[7] = ""
    (tmp_path / "log.csv").write_text("\n".join(lines), encoding="utf-8")
    summary = ingest([tmp_path / "log.csv"], tmp_path / "work")
    assert summary.rows_rejected == {"wrong_field_count": 3, "not_a_number": 1}
    assert summary.rows_read == len(TIME) - 1
    rejected = tables.read(tmp_path / "work" / "rejected.parquet", schemas.REJECTED)
    assert rejected["row"].tolist() == [4, 5, 6, 7]
    assert rejected["text"].tolist() == lines[3:7]


def test_rows_with_lost_bytes_are_rejected(tmp_path):
    """NUL bytes replace lost characters in a number, in a structure, or in a whole row."""
    lines = variable_log(CELLS["full"]).split("\n")
    lines[2] = lines[2].replace("{E6AXIS", "{E6\0AXIS")
    lines[4] = lines[4].replace("A1 ", "A1\0 ")
    lines[5] = lines[5].replace(";63", ";6\x003")
    lines[6] = "\0" * len(lines[6])
    lines[7] = "A1\0 1 A2 2;" + lines[7]
    (tmp_path / "log.csv").write_text("\n".join(lines), encoding="utf-8")
    summary = ingest([tmp_path / "log.csv"], tmp_path / "work")
    assert summary.rows_rejected == {"not_a_number": 5}
    assert summary.rows_read == len(TIME)
    rejected = tables.read(tmp_path / "work" / "rejected.parquet", schemas.REJECTED)
    assert rejected["row"].tolist() == [3, 5, 6, 7, 8]
    samples = samples_of(tmp_path / "log.csv", tmp_path / "again")
    np.testing.assert_allclose(samples["position"], np.delete(POSITION, [1, 3, 4, 5, 6]), atol=1e-6)


def test_structures_are_found_after_a_damaged_first_row(tmp_path):
    lines = variable_log(CELLS["full"]).split("\n")
    lines[1] = lines[1].replace("A1 ", "\0A1 ")
    (tmp_path / "log.csv").write_text("\n".join(lines), encoding="utf-8")
    samples = samples_of(tmp_path / "log.csv", tmp_path / "work")
    np.testing.assert_allclose(samples["position"], POSITION[1:], atol=1e-6)


def test_damage_at_an_axis_at_rest_does_not_change_the_unit(tmp_path):
    """Values of an axis that stays at zero give no scale by which damage could be detected."""
    lines = variable_log(lambda a, b: f"A1 0.0 A2 {b:.9f}").split("\n")
    for line, damage in enumerate(("292277026596", "-1e308", "9223372036854775807", "9e12"), 9):
        lines[line] = lines[line].replace("A1 0.0", f"A1 {damage}")
    (tmp_path / "log.csv").write_text("\n".join(lines), encoding="utf-8")
    check(samples_of(tmp_path / "log.csv", tmp_path / "work"))


def test_a_header_that_names_other_fields_is_refused(tmp_path):
    text = variable_log(CELLS["full"], header="timestamp;AXIS_ACT;TORQUE_A2")
    (tmp_path / "log.csv").write_text(text, encoding="utf-8")
    found = open_log(tmp_path / "log.csv", CsvHints())
    assert isinstance(found, Refusal)
    assert "header names 3 columns but the rows have 6 fields" in found.text


@settings(max_examples=60)
@given(
    angles=st.lists(st.floats(-360, 360), min_size=2, max_size=8),
    form=st.sampled_from(["{{E6AXIS: {}}}", "{{{}}}", "{}"]),
    between=st.sampled_from([", ", " ", ","]),
    sign=st.sampled_from([".", ","]),
    size=st.integers(50, 500),
)
def test_any_structure_gives_its_numbers(tmp_path_factory, angles, form, between, sign, size):
    path = tmp_path_factory.mktemp("cells") / "log.csv"
    members = (f"A{i} {angle:.6f}".replace(".", sign) for i, angle in enumerate(angles, 1))
    row = f"0.5;{form.format(between.join(members))};7"
    path.write_text("\n".join(["t;AXIS_ACT;x"] + [row] * 5), encoding="utf-8")
    source = open_log(path, CsvHints())
    assert source.columns == ("t", *(f"AXIS_ACT_A{i + 1}" for i in range(len(angles))), "x")
    parts = list(source.batches(range(len(angles) + 2), size))
    for i, angle in enumerate([0.5, *angles, 7]):
        found = np.concatenate([part.values[i] for part in parts])
        np.testing.assert_allclose(found, [angle] * 5, atol=1e-6)
    assert [line for part in parts for line in part.lines] == [2, 3, 4, 5, 6]


RTDE = {
    "timestamp": (TIME + 4021.128, "DOUBLE", "d"),
    "actual_q_0": (TIME * 0, "DOUBLE", "d"),
    "actual_q_1": (np.radians(POSITION), "DOUBLE", "d"),
    "actual_qd_0": (TIME * 0, "DOUBLE", "d"),
    "actual_qd_1": (np.radians(VELOCITY), "DOUBLE", "d"),
    "actual_current_0": (TIME * 0, "DOUBLE", "d"),
    "actual_current_1": (TORQUE, "DOUBLE", "d"),
    "joint_temperatures_1": (TEMPERATURE, "DOUBLE", "d"),
    "robot_mode": (TIME * 0 - 3, "INT32", "i"),
    "status_bits": (TIME * 0 + 2**31 + 5, "UINT32", "I"),
    "digital_out": (TIME * 0 + 2**40, "UINT64", "Q"),
    "tool_mode": (TIME * 0 + 253, "UINT8", "B"),
    "running": (TIME * 0 + 1, "BOOL", "?"),
}


def rtde_bytes():
    """Return what ``record.py --binary`` writes: names, types, then big-endian rows."""
    form = ">" + "".join(code for _, _, code in RTDE.values())
    rows = zip(*(v.tolist() for v, _, _ in RTDE.values()), strict=True)
    codes = [code for _, _, code in RTDE.values()]
    packed = (
        struct.pack(form, *(v if c == "d" else int(v) for v, c in zip(row, codes, strict=True)))
        for row in rows
    )
    head = f"{' '.join(RTDE)}\n{' '.join(kind for _, kind, _ in RTDE.values())}\n"
    return head.encode() + b"".join(packed)


def test_universal_robots_binary_recording(tmp_path):
    (tmp_path / "robot_data.csv").write_bytes(rtde_bytes())
    source = open_log(tmp_path / "robot_data.csv", CsvHints())
    values = next(source.batches(range(len(RTDE)), 1 << 20)).values
    for column, (expected, _, _) in enumerate(RTDE.values()):
        np.testing.assert_array_equal(values[column], expected)
    columns = {name.replace("torque", "current"): values for name, values in COLUMNS.items()}
    columns["current_2 [A]"] = columns.pop("current_2 [Nm]")
    assert_same_as_csv(tmp_path / "robot_data.csv", tmp_path, columns)


@pytest.mark.parametrize("size", [1, 100, 5000, 1 << 20])
def test_an_interrupted_binary_recording_loses_one_row(tmp_path, size):
    (tmp_path / "robot_data.csv").write_bytes(rtde_bytes()[:-7])
    source = open_log(tmp_path / "robot_data.csv", CsvHints())
    parts = list(source.batches([0, 6], size))
    found = np.concatenate([part.values[6] for part in parts])
    np.testing.assert_array_equal(found, [*TORQUE[:-1], np.nan])
    assert parts[-1].lines[-1] == len(TIME)
    summary = ingest([tmp_path / "robot_data.csv"], tmp_path / "work")
    assert summary.rows_rejected == {"missing_value": 1}


def test_a_binary_recording_whose_lines_disagree_is_refused(tmp_path):
    (tmp_path / "robot_data.csv").write_bytes(b"timestamp actual_q_0\nDOUBLE\n" + bytes(80))
    found = open_log(tmp_path / "robot_data.csv", CsvHints())
    assert isinstance(found, Refusal)
    assert "names 2 columns (timestamp, actual_q_0) and 1 types" in found.text


def test_universal_robots_text_recording_on_windows(tmp_path):
    """The line ends of csv.writer are converted again in text mode: a blank line after each row."""
    names = [name for name, (_, kind, _) in RTDE.items() if kind == "DOUBLE"]
    text = text_of({name: RTDE[name][0] for name in names}, delimiter=" ", digits=13)
    (tmp_path / "robot_data.csv").write_bytes(text.replace("\n", "\r\r\n").encode())
    columns = {name.replace("torque", "current"): values for name, values in COLUMNS.items()}
    columns["current_2 [A]"] = columns.pop("current_2 [Nm]")
    assert_same_as_csv(tmp_path / "robot_data.csv", tmp_path, columns)


@pytest.mark.parametrize(
    ("seconds", "nanoseconds"),
    [
        ("tsec", "tnsec"),
        ("ZeitInSec", "ZeitInNanoSec"),
        ("header.stamp.sec", "header.stamp.nanosec"),
        ("stamp_secs", "stamp_nsecs"),
    ],
)
def test_time_in_seconds_and_nanoseconds(tmp_path, seconds, nanoseconds):
    stamps = np.round((TIME + 0.987654321) * 1e9).astype(np.int64)
    columns = {
        "index": np.arange(len(TIME), dtype=float),
        seconds: (stamps // 10**9).astype(float),
        nanoseconds: (stamps % 10**9).astype(float),
        "position_2 [deg]": POSITION,
        "torque_2 [Nm]": TORQUE,
    }
    log = write(tmp_path / "log.csv", columns, delimiter=",", digits=13)
    source = open_log(log, CsvHints())
    assert f"time from {seconds} and {nanoseconds}" in source.form
    assert_same_as_csv(log, tmp_path, without(COLUMNS, "velocity", "motor_temperature"))


def test_seconds_alone_are_unchanged(tmp_path):
    log = write(tmp_path / "log.csv", {"sec": TIME, "position": POSITION, "torque": TORQUE})
    assert open_log(log, CsvHints()).columns == ("sec", "position", "torque")


def test_rows_of_other_topics_are_counted_and_do_not_refuse_a_log(tmp_path):
    """A CSV of PlotJuggler with topics joined by time: two rows of another topic for each row."""
    time, position, velocity, torque = back_and_forth()
    header = "__time,/imu/temperature,/joint_states/joint_2/position,/joint_states/joint_2/effort"
    lines = [header]
    for t, q, u in zip(time, np.radians(position), torque, strict=True):
        lines.append(f"{t:.6f},,{q:.9f},{u:.6f}")
        lines += [f"{t + shift:.6f},31.5,," for shift in (0.003, 0.007)]
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "log.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    summary = ingest([tmp_path / "run"], tmp_path / "work")
    assert summary.rows_kept == len(time)
    assert summary.rows_rejected == {"no_values": 2 * len(time)}
    table = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    assert set(table["joint"]) == {2}
    assert table["position"].to_numpy() == pytest.approx(position, abs=1e-6)
    steady = np.abs(np.abs(velocity) - 40) < 1e-9
    inner = steady & np.roll(steady, 4) & np.roll(steady, -4)
    assert table["velocity"].to_numpy()[inner] == pytest.approx(velocity[inner], abs=0.01)


def test_a_drive_that_logs_the_torque_it_asks_for(tmp_path):
    """Monitor data of Yaskawa's drives: feedback speed, and the torque reference in % of rated."""
    time, position, velocity, torque = back_and_forth()
    columns = {"Time [s]": time, "Feedback Position [deg]": position}
    columns |= {"Feedback Speed [min-1]": velocity / 6, "Torque Reference [%]": torque}
    log = write(tmp_path / "trace.csv", columns)
    summary = ingest([log], tmp_path / "work")
    assert summary.torque_unit == "%"
    assert any("what the drive asks of its motor" in note for note in summary.notes)
    # where a torque was measured, it is read instead
    log = write(tmp_path / "trace.csv", columns | {"torque [Nm]": torque})
    assert ingest([log], tmp_path / "work").torque_unit == "N·m"


def test_names_of_vesc_tool(tmp_path):
    time, position, velocity, torque = back_and_forth()
    columns = {"ms_today": 1e3 * time + 36e6, "current_motor": torque, "position": position}
    columns |= {"temp_motor": 30 + time, "erpm": 7 * velocity / 6}
    log = write(tmp_path / "vesc.csv", columns)
    ingest([log], tmp_path / "work")
    table = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    np.testing.assert_allclose(table["time"], time, atol=1e-6)
    np.testing.assert_allclose(table["motor_temperature"], 30 + time, atol=1e-6)
