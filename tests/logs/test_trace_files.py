"""The files of one KUKA trace: put together by time, read once; text without its factors."""

import shutil

import numpy as np
import pytest

from frictioncli import schemas, tables
from frictioncli.errors import LogError
from frictioncli.logs.ingest import IngestSettings, ingest

from .diadem_files import write_diadem
from .kuka_traces import (
    COARSE,
    POSITION,
    RATIO,
    TIME,
    TORQUE,
    VELOCITY,
    drive,
    interpolator,
    raw,
    read,
    recordings,
    write_file,
    write_trace,
)
from .logs import REAL, write


@pytest.mark.parametrize("native", [True, False])
def test_the_drive_lends_its_velocity_to_the_interpolator(tmp_path, native):
    write_trace(tmp_path / "run", native=native)
    summary, table = read(tmp_path / "run", tmp_path / "work", joints=(3,))
    assert (summary.files_read, summary.files_rejected) == (1, ())
    assert summary.rows_kept == summary.rows_read == len(TIME[COARSE])
    np.testing.assert_allclose(table["time"], TIME[COARSE], atol=1e-9)
    np.testing.assert_allclose(table["position"], POSITION[COARSE], rtol=1e-9)
    np.testing.assert_allclose(table["velocity"], VELOCITY[COARSE], rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(table["torque"], TORQUE[COARSE] / 90, rtol=1e-9)
    assert set(table["recording"]) == {"t"}
    assert summary.torque_side == "motor"
    assert any(": -90.72" in note for note in summary.notes)


@pytest.mark.parametrize("native", [True, False])
def test_a_drive_with_torque_is_the_base_and_its_position_comes_to_the_joint(tmp_path, native):
    write_trace(tmp_path / "run", native=native, torque_of_drive=True)
    summary, table = read(tmp_path / "run", tmp_path / "work", joints=(3,))
    assert (summary.files_read, summary.rows_kept) == (1, len(TIME))
    np.testing.assert_allclose(table["time"], TIME, atol=1e-9)
    np.testing.assert_allclose(table["position"], POSITION, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(table["velocity"], VELOCITY, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(table["torque"], TORQUE / 90, rtol=1e-9)


def test_native_and_text_give_the_same(tmp_path):
    found = []
    for native in (True, False):
        write_trace(tmp_path / str(native) / "run", native=native, torque_of_drive=True)
        found.append(read(tmp_path / str(native) / "run", tmp_path / str(native) / "work")[1])
    for column in ("joint", "time", "position", "velocity", "torque"):
        np.testing.assert_allclose(found[0][column], found[1][column], rtol=1e-9, atol=1e-11)


def test_each_joint_keeps_the_times_of_its_torque(tmp_path):
    """Joint 2 is known from the interpolator only; both joints are one recording."""
    write_trace(tmp_path / "run", torque_of_drive=True)
    summary, table = read(tmp_path / "run", tmp_path / "work")
    assert summary.samples == {2: len(TIME[COARSE]), 3: len(TIME)}
    assert set(table["recording"]) == {"t"}
    second, third = (table[table["joint"] == joint] for joint in (2, 3))
    np.testing.assert_allclose(second["time"], TIME[COARSE], atol=1e-9)
    np.testing.assert_allclose(third["time"], TIME, atol=1e-9)
    np.testing.assert_allclose(second["torque"], TORQUE[COARSE] / 50, rtol=1e-9)
    rows = recordings(tmp_path / "work")
    assert rows["joint"].tolist() in ([2, 3], [3, 2])
    assert set(rows["start"]) == {0.0}
    assert not any("starts" in text for text in summary.warnings)


def test_native_and_text_beside_each_other_are_read_once(tmp_path):
    write_trace(tmp_path / "run")
    write_trace(tmp_path / "run", native=False)
    summary, table = read(tmp_path / "run", tmp_path / "work", joints=(3,))
    assert len(table) == len(TIME[COARSE])
    assert {(file.file, file.reason) for file in summary.files_rejected} == {
        ("t_KRCIpo.csv", "same_recording"),
        ("t_NextGenDrive#3.csv", "same_recording"),
    }
    assert all(".dat" in file.text for file in summary.files_rejected)
    assert recordings(tmp_path / "work")["file"][0].endswith("t_KRCIpo.dat")


def test_a_csv_with_more_than_the_native_file_is_not_the_same(tmp_path):
    write_trace(tmp_path / "run")
    more = {**interpolator(), "Motortemperatur3[°C]": np.full(len(TIME[COARSE]), 33.0)}
    write_file(tmp_path / "run", "t_KRCIpo", more, native=False)
    summary, _ = read(tmp_path / "run", tmp_path / "work", joints=(3,))
    assert summary.files_rejected == ()


def test_a_damaged_native_file_gives_way_to_its_csv(tmp_path):
    """A torque in 1e-3 N·m: no physics tells, but the header beside the equal raw numbers does."""
    columns = {"AxisPos_Act3[°]": POSITION[COARSE], "Istdrehmoment_A3[Nm]": 1000 * TORQUE[COARSE]}
    scales = {"Istdrehmoment_A3[Nm]": (1e-3, 0)}
    header = write_diadem(tmp_path / "run" / "t_KRCIpo.dat", raw(columns), scales=scales)
    write_file(tmp_path / "run", "t_KRCIpo", columns, native=False)
    samples = header.with_suffix(".r64")
    samples.write_bytes(samples.read_bytes()[:-9])
    summary, table = read(tmp_path / "run", tmp_path / "work")
    assert {(file.file, file.reason) for file in summary.files_rejected} == {
        ("t_KRCIpo.dat", "samples_incomplete"),
        ("t_KRCIpo.r64", "format_not_read"),
    }
    np.testing.assert_allclose(table["torque"], TORQUE[COARSE], rtol=1e-9)
    np.testing.assert_allclose(table["position"], POSITION[COARSE], rtol=1e-7)


def test_a_csv_that_is_scaled_already_is_not_scaled_again(tmp_path):
    columns = {"AxisPos_Act3[°]": POSITION[COARSE], "Istdrehmoment_A3[Nm]": TORQUE[COARSE]}
    stored = {**raw(columns), "Istdrehmoment_A3[Nm]": 1000 * TORQUE[COARSE]}
    scales = {"Istdrehmoment_A3[Nm]": (1e-3, 0)}
    write_diadem(tmp_path / "run" / "t_KRCIpo.dat", stored, scales=scales)
    text = {"Zeit[sec]": TIME[COARSE], **columns}
    log = write(tmp_path / "run" / "t_KRCIpo.csv", text, encoding="cp1252", digits=12)
    _, table = read(log, tmp_path / "work")
    np.testing.assert_allclose(table["torque"], TORQUE[COARSE], rtol=1e-9)


def test_temperatures_are_held_not_interpolated(tmp_path):
    steps = 300.0 + np.floor(TIME[COARSE])  # [K]
    columns = {**interpolator(torque=False), "Motortemperatur3[K]": steps}
    write_file(tmp_path / "run", "t_KRCIpo", columns)
    write_file(tmp_path / "run", "t_NextGenDrive#3", drive(torque=True), period=0.004)
    _, table = read(tmp_path / "run", tmp_path / "work")
    shown = table["motor_temperature_reading"].to_numpy()
    last = np.floor(np.arange(len(TIME)) / 3).astype(int)
    np.testing.assert_allclose(shown, steps[last] - 273.15, atol=1e-9)


def test_times_that_the_other_file_lacks_give_no_sample_and_are_counted(tmp_path):
    """The drive's file begins at 0.6 s, ends 0.4 s early, and has a gap from 2 to 2.5 s."""
    write_file(tmp_path / "run", "t_KRCIpo", interpolator(), native=False)
    there = (TIME > 0.598) & (TIME < 5.6) & ((TIME < 2.0) | (TIME > 2.4985))
    columns = {"Zeit[sec]": TIME[there], **{c: v[there] for c, v in raw(drive()).items()}}
    write(tmp_path / "run" / "t_NextGenDrive#3.csv", columns, encoding="cp1252", digits=15)
    summary, table = read(tmp_path / "run", tmp_path / "work", joints=(3,))
    expected = TIME[COARSE][np.isin(np.round(TIME[COARSE] / 0.004), np.round(TIME[there] / 0.004))]
    assert summary.rows_read == len(TIME[COARSE])
    assert summary.rows_rejected == {"outside_other_file": len(TIME[COARSE]) - len(expected)}
    np.testing.assert_allclose(table["time"], expected - expected[0], atol=1e-9)
    rejected = tables.read(tmp_path / "work" / "rejected.parquet", schemas.REJECTED)
    assert set(rejected["reason"]) == {"outside_other_file"}
    assert len(rejected) == summary.rows_rejected["outside_other_file"]


def test_a_joint_that_does_not_move_does_without_its_drive(tmp_path):
    rest = np.full(len(TIME), 10.0)
    still = {**interpolator(torque=False), "AxisPos_Act3[°]": rest[COARSE]}
    columns = {**drive(torque=True), "Istposition[°]": rest * RATIO}
    write_file(tmp_path / "run", "t_KRCIpo", still)
    write_file(tmp_path / "run", "t_NextGenDrive#3", columns, period=0.004)
    summary, table = read(tmp_path / "run", tmp_path / "work")
    np.testing.assert_allclose(table["position"], 10.0)
    assert summary.torque_side == "motor"
    assert any("does not move" in note for note in summary.notes)


def test_a_given_gear_ratio_brings_the_torque_to_the_joint(tmp_path):
    write_trace(tmp_path / "run")
    summary, table = read(tmp_path / "run", tmp_path / "work", joints=(3,), gear_ratio=RATIO)
    assert summary.torque_side == "joint"
    np.testing.assert_allclose(table["torque"], TORQUE[COARSE] / 90 * RATIO, rtol=1e-9)


def test_an_axis_that_is_not_asked_for_is_listed(tmp_path):
    write_trace(tmp_path / "run")
    summary, table = read(tmp_path / "run", tmp_path / "work", joints=(2,))
    assert set(table["joint"]) == {2}
    assert [(file.file, file.reason) for file in summary.files_rejected] == [
        ("t_NextGenDrive#3.dat", "no_torque_channel")
    ]


def test_every_file_of_a_trace_is_among_the_inputs(tmp_path):
    write_trace(tmp_path / "run")
    read(tmp_path / "run", tmp_path / "work", joints=(3,))
    inputs = tables.metadata(tmp_path / "work" / "samples.parquet")["inputs"]
    names = {f"t_{part}.{end}" for part in ("KRCIpo", "NextGenDrive#3") for end in ("dat", "r64")}
    assert set(inputs) == {f"run/{name}" for name in names}


def test_traces_of_the_same_name_in_two_folders_stay_apart(tmp_path):
    for day in ("monday", "tuesday"):
        write_trace(tmp_path / day)
    summary = ingest({"both": tmp_path}, tmp_path / "work", IngestSettings(joints=(3,)))
    assert summary.files_read == 2
    assert len(set(recordings(tmp_path / "work")["recording"])) == 2


def test_tabs_and_blanks_before_units(tmp_path):
    """The layout of the offline trace tool: tab, ``Zeit [s]``, ``AxisPos_Act2 [°]``."""
    columns = {
        "Zeit [s]": TIME[COARSE],
        "AxisPos_CmdIpo2 [°]": POSITION[COARSE] + 1,
        "AxisPos_Act2 [°]": POSITION[COARSE],
        "GearTorq_Act2 [Nm]": TORQUE[COARSE],
    }
    log = write(tmp_path / "trace.asc", columns, delimiter="\t", digits=12)
    _, table = read(log, tmp_path / "work")
    np.testing.assert_allclose(table["position"], POSITION[COARSE], atol=1e-9)
    np.testing.assert_allclose(table["torque"], TORQUE[COARSE], atol=1e-9)


def test_a_converter_with_commas_and_six_digits(tmp_path):
    """The layout of a converter that applies the header's factors: ``Istmoment(Nm)``, ``%g``."""
    columns = {"Zeit(sec)": TIME, "Istposition(°)": POSITION * 90, "Istmoment(Nm)": TORQUE / 90}
    columns["Istgeschwindigkeit(°/s)"] = VELOCITY * 90
    lines = [",".join(columns)]
    lines += [",".join(f"{v:g}" for v in row) for row in zip(*columns.values(), strict=True)]
    log = tmp_path / "t_NextGenDrive#3.csv"
    log.write_text("\n".join(lines), encoding="utf-8")
    _, table = read(log, tmp_path / "work", gear_ratio=90.0)
    assert set(table["joint"]) == {3}
    np.testing.assert_allclose(table["position"], POSITION, rtol=1e-5, atol=1e-5)
    np.testing.assert_allclose(table["velocity"], VELOCITY, rtol=1e-5, atol=1e-5)
    np.testing.assert_allclose(table["torque"], TORQUE, rtol=1e-5)


@pytest.mark.parametrize(
    ("factor", "offset"), [(1.0, 0.0), (1e3, 0.0), (1.0, 273.15), (1e3, 273.15)]
)
def test_raw_drive_values_without_any_header(tmp_path, factor, offset):
    """Positions in 1e-6 deg, velocities in 1e-3 deg/s, temperatures in °C, K or a thousandth."""
    warm = 35 + TIME / 10
    columns = {
        "Zeit[sec]": TIME,
        "Istposition[°]": np.round(POSITION * 90e6),
        "Istgeschwindigkeit[°/s]": VELOCITY * 90e3,
        "Istmoment[Nm]": TORQUE / 90,
        "Motortemperatur[°C]": factor * (warm + offset),
    }
    log = write(tmp_path / "t_NextGenDrive#3.csv", columns, encoding="cp1252", digits=9)
    summary, table = read(log, tmp_path / "work", gear_ratio=90.0)
    np.testing.assert_allclose(table["position"], POSITION, atol=1e-7)
    np.testing.assert_allclose(table["velocity"], VELOCITY, atol=1e-9)
    np.testing.assert_allclose(table["motor_temperature_reading"], warm, atol=1e-6)
    assert any("read as mdeg/s" in note for note in summary.notes)


@pytest.mark.skipif(not REAL.is_dir(), reason=f"no real logs beside the project: {REAL}")
def test_a_real_trace_from_native_files_equals_that_from_text(tmp_path):
    for kind, endings in (("native", (".dat", ".r64")), ("text", (".csv",))):
        (tmp_path / kind).mkdir()
        for path in (REAL / "kuka-kr3" / "PTP_Vel").iterdir():
            if path.suffix in endings:
                shutil.copy(path, tmp_path / kind)
    found = [read(tmp_path / k, tmp_path / "work" / k) for k in ("native", "text")]
    assert [summary.rows_kept for summary, _ in found] == [550, 550]
    one, other = (table.sort_values(["recording", "joint", "time"]) for _, table in found)
    assert one["recording"].tolist() == other["recording"].tolist()
    begins = [t.groupby(["recording", "joint"])["time"].transform("min") for t in (one, other)]
    np.testing.assert_allclose(one["time"] - begins[0], other["time"] - begins[1], atol=1e-9)
    for column in ("position", "velocity", "torque"):
        np.testing.assert_allclose(one[column], other[column], rtol=1e-9, atol=1e-9)


def test_samples_of_no_joint_are_refused_in_words(tmp_path):
    write_file(tmp_path / "run", "t_NextGenDrive#3", drive(), period=0.004)
    with pytest.raises(LogError, match=r"no torque channel.*Istposition"):
        read(tmp_path / "run", tmp_path / "work")
