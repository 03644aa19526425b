"""Logs in turns, in counts of an encoder, or in units that nobody knows."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from frictioncli import schemas, tables
from frictioncli.errors import LogError, MappingError
from frictioncli.inspection.map_suggestion.suggest_map import suggested_map
from frictioncli.logs.channels.channel_map import read_map
from frictioncli.logs.ingest import IngestSettings, ingest
from frictioncli.logs.runs.native_scale import ScaledLog

from .logs import back_and_forth, write


def samples_of(folder, columns, **settings):
    path = write(folder / "log.csv", columns)
    summary = ingest([path], folder / "work", IngestSettings(**settings))
    return tables.read(folder / "work" / "samples.parquet", schemas.SAMPLES), summary


@pytest.mark.parametrize("velocity_unit", ["turn/s", "rev/s", "Hz"])
def test_turns_are_read_by_the_header(velocity_unit, tmp_path):
    time, position, velocity, torque = back_and_forth()
    columns = {"time [s]": time, "position [turns]": position / 360}
    columns |= {f"velocity [{velocity_unit}]": velocity / 360, "torque [Nm]": torque}
    samples, summary = samples_of(tmp_path, columns)
    np.testing.assert_allclose(samples["position"], position, atol=1e-5)
    np.testing.assert_allclose(samples["velocity"], velocity, atol=1e-5)
    assert not summary.warnings


def test_a_velocity_in_turns_beside_an_angle_in_degrees(tmp_path):
    time, position, velocity, torque = back_and_forth()
    columns = {"time [s]": time, "position [deg]": position}
    columns |= {"velocity [rev/s]": velocity / 360, "torque [Nm]": torque}
    samples, _ = samples_of(tmp_path, columns)
    np.testing.assert_allclose(samples["velocity"], velocity, atol=1e-5)


def test_no_velocity_is_taken_for_turns_by_its_values(tmp_path):
    """In rad and rad/s a ratio of 6.28 would be turns, in deg and deg/s one of 6 is rpm."""
    time, position, velocity, torque = back_and_forth()
    columns = {"time [s]": time, "position [deg]": position, "velocity": velocity / 6}
    samples, _ = samples_of(tmp_path, columns | {"torque [Nm]": torque})
    np.testing.assert_allclose(samples["velocity"], velocity, atol=1e-5)


def test_an_integrated_velocity_in_hertz_is_in_turns(tmp_path):
    time, _, velocity, torque = back_and_forth()
    columns = {"time [s]": time, "velocity measured [Hz]": velocity / 360, "torque [Nm]": torque}
    samples, _ = samples_of(tmp_path, columns)
    np.testing.assert_allclose(samples["velocity"], velocity, atol=1e-5)


def counted():
    """A log of an encoder with 4096 counts per turn, a drive in 0.229 rpm, and digits of torque."""
    time, position, velocity, torque = back_and_forth()
    return {
        "time [ms]": 1000 * time,
        "position [pulse]": np.round(position * 4096 / 360),
        "velocity [counts/s]": velocity / 6 / 0.229,
        "torque": torque / 0.03,
    }, (position, velocity, torque)


def test_pulses_are_refused_with_what_to_do(tmp_path):
    columns, _ = counted()
    path = write(tmp_path / "log.csv", columns)
    with pytest.raises(LogError, match=r"position \[pulse\] counts pulses.*\[scale\] position"):
        ingest([path], tmp_path / "work")


def test_a_map_scales_counts(tmp_path):
    columns, (position, velocity, torque) = counted()
    channel_map = tmp_path / "map.toml"
    channel_map.write_text(
        "[scale]\nposition = 0.087890625\nvelocity = 0.229\ntorque = 0.03\n"
        '[units]\nvelocity = "rpm"\n',
        encoding="utf-8",
    )
    samples, summary = samples_of(tmp_path, columns, map_file=channel_map)
    np.testing.assert_allclose(samples["position"], position, atol=0.05)
    np.testing.assert_allclose(samples["velocity"], velocity, atol=1e-4)
    np.testing.assert_allclose(samples["torque"], torque, atol=1e-6)
    assert not summary.warnings


def test_a_map_scales_the_velocity_that_is_integrated(tmp_path):
    time, _, velocity, torque = back_and_forth()
    columns = {"time [s]": time, "velocity [digits]": velocity / 0.5, "torque [Nm]": torque}
    channel_map = tmp_path / "map.toml"
    channel_map.write_text("[scale]\nvelocity = 0.5\n", encoding="utf-8")
    path = write(tmp_path / "log.csv", columns)
    with pytest.raises(LogError):
        ingest([path], tmp_path / "refused")
    samples, _ = samples_of(tmp_path, columns, map_file=channel_map)
    np.testing.assert_allclose(samples["velocity"], velocity, atol=1e-5)
    integral = np.concatenate([[0.0], np.cumsum((velocity[1:] + velocity[:-1]) / 2 * 0.012)])
    np.testing.assert_allclose(samples["position"], integral, atol=1e-4)


@pytest.mark.parametrize(
    "value", ["0", "inf", "nan", "1e308", "-1e-308", "9" * 400, "true", '"2"', "[2]"]
)
def test_a_scale_is_a_number(value, tmp_path):
    path = tmp_path / "map.toml"
    path.write_text(f"[scale]\nposition = {value}\n", encoding="utf-8")
    with pytest.raises(MappingError, match=r"\[scale\] position"):
        read_map(path)


@pytest.mark.parametrize(("name", "says"), [("torque [ozf]", "ozf"), ("torque [kip]", "kip")])
def test_an_unknown_unit_of_torque_is_warned_of(name, says, tmp_path):
    time, position, velocity, torque = back_and_forth()
    columns = {"time [s]": time, "position [deg]": position, "velocity [deg/s]": velocity}
    _, summary = samples_of(tmp_path, columns | {name: torque})
    assert any(f"unit '{says}' is not known" in text for text in summary.warnings)


def test_the_unit_of_a_linear_axis_is_not_missing(tmp_path):
    time, position, velocity, torque = back_and_forth()
    columns = {"time [s]": time, "position [mm]": 10 * position}
    columns |= {"velocity [mm/s]": 10 * velocity, "torque [N]": torque}
    samples, summary = samples_of(tmp_path, columns)
    np.testing.assert_allclose(samples["position"], 10 * position, atol=1e-4)
    assert any("position [mm]: unit 'mm' is not known" in text for text in summary.warnings)
    assert not any("has no unit" in text for text in summary.warnings)


def test_joints_share_the_time_that_the_moving_one_shows(tmp_path):
    """Joint 1 stands still and cannot tell ms from s; joint 2 moves in rad and rad/s."""
    time, position, velocity, torque = back_and_forth()
    still = np.full(len(time), 0.3)
    columns = {"time": 1000 * time, "q_1": still, "q_2": np.radians(position)}
    columns |= {"qd_1": 0 * still, "qd_2": np.radians(velocity), "tau_1": 1 + still}
    samples, _ = samples_of(tmp_path, columns | {"tau_2": torque})
    for joint in (1, 2):
        np.testing.assert_allclose(samples[samples["joint"] == joint]["time"], time, atol=1e-6)
    moving = samples[samples["joint"] == 2]
    np.testing.assert_allclose(moving["velocity"], velocity, atol=1e-4)


def test_a_suggested_map_takes_the_units_of_the_header(tmp_path):
    time, position, velocity, torque = back_and_forth(seconds=12.0)
    columns = {"t": time, "enc a [turns]": position / 360, "enc b [turn/s]": velocity / 360}
    text = suggested_map([write(tmp_path / "log.csv", columns | {"drive [A]": torque})])
    assert 'position = "turn"' in text
    assert 'velocity = "turn/s"' in text
    assert 'torque = "A"' in text


def test_a_suggested_map_asks_for_the_size_of_a_pulse(tmp_path):
    columns, _ = counted()
    path = write(tmp_path / "log.csv", columns)
    text = suggested_map([path])
    assert "[scale]\nposition = 0  # fill in: degrees per count" in text
    saved = tmp_path / "map.toml"
    saved.write_text(text, encoding="utf-8")
    with pytest.raises(MappingError, match=r"\[scale\] position = 0; expected"):
        read_map(saved)


def test_a_scaled_log_comes_from_all_files_of_its_trace():
    files = (Path("trace_KRCIpo.csv"), Path("trace_NextGenDrive#3.csv"))
    trace = SimpleNamespace(path=files[0], files=files, columns=("t", "q"), form="2 files")
    assert ScaledLog(trace, ((1.0, 0.0), (2.0, 0.0))).files == files


@pytest.mark.parametrize("has_velocity", [False, True])
def test_estimates_of_an_odrive_are_in_turns(has_velocity, tmp_path):
    """In rad they would be 6.3 times too small; no header of these logs has a unit."""
    time, position, velocity, torque = back_and_forth()
    columns = {"time": time, "pos_estimate": position / 360}
    columns |= {"vel_estimate": velocity / 360} if has_velocity else {}
    log = write(tmp_path / "log.csv", {**columns, "iq_measured": torque}, digits=12)
    ingest([log], tmp_path / "work")
    found = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    np.testing.assert_allclose(found["position"], position, atol=1e-6)
    moves = np.abs(velocity) == np.max(velocity)
    np.testing.assert_allclose(found["velocity"][moves], velocity[moves], rtol=0.02)
