"""Channels that are read, and of which the values say that they may be something else."""

import numpy as np
import pytest

from frictioncli import schemas, tables
from frictioncli.errors import LogError
from frictioncli.logs.ingest import IngestSettings, ingest

from .logs import back_and_forth, write


def swings(seed=0):
    """Return time [s], position [deg], gravity and friction [N·m] of a joint that swings."""
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, 60.0, 0.02)
    position = 60 * np.sin(2 * np.pi * time / 12)
    sign = np.sign(np.cos(2 * np.pi * time / 12))
    gravity = 30 * np.cos(np.radians(position)) + rng.normal(0, 0.05, len(time))
    return time, position, gravity, 4.0 * sign + rng.normal(0, 0.05, len(time))


def warnings_of(folder, columns, settings=None):
    log = write(folder / "log.csv", columns)
    return ingest([log], folder / "work", settings or IngestSettings()).warnings


def test_a_torque_behind_the_gear_shows_no_friction(tmp_path):
    time, position, gravity, _ = swings()
    (warning,) = warnings_of(tmp_path, {"t": time, "q_deg": position, "tau_Nm": gravity})
    assert "tau_Nm, hardly shows friction" in warning
    assert "sensor behind the gear" in warning


def test_a_torque_with_friction_passes(tmp_path):
    time, position, gravity, friction = swings()
    columns = {"t": time, "q_deg": position, "tau_Nm": gravity + friction}
    assert warnings_of(tmp_path, columns) == ()


def test_a_current_without_direction_shows_no_friction(tmp_path):
    time, position, _, friction = swings()
    columns = {"t": time, "q_deg": position, "current": np.abs(friction)}
    (warning,) = warnings_of(tmp_path, columns)
    assert "never negative" in warning


def test_joints_at_rest_have_no_say_in_the_choice_of_torques(tmp_path):
    """Five of six joints only tremble; the current of the sixth bears friction, its sensor none."""
    time, position, gravity, friction = swings()
    columns = {"t": time, "pos_6": position, "torque_6": gravity, "current_6": gravity + friction}
    rng = np.random.default_rng(1)
    for joint in range(1, 6):
        columns[f"pos_{joint}"] = 10.0 + rng.normal(0, 0.02, len(time))
        columns[f"torque_{joint}"] = 1 + rng.normal(0, 0.1, len(time))
        columns[f"current_{joint}"] = 1 + rng.normal(0, 0.1, len(time))
    summary = ingest([write(tmp_path / "log.csv", columns)], tmp_path / "work")
    assert summary.torque_unit == "A"
    assert summary.warnings == ()


def test_a_load_that_changes_with_the_direction_is_no_load(tmp_path):
    """Servos call their own torque, in per mille, load."""
    time, position, gravity, friction = swings()
    torque = gravity + friction
    columns = {"t": time, "q_deg": position, "current": torque / 10, "load": np.round(8 * torque)}
    (warning,) = warnings_of(tmp_path, columns)
    assert "load is not used as load" in warning
    table = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    assert table["load"].isna().all()


def test_nothing_shows_the_unit_of_a_speed_without_position(tmp_path):
    time, _, velocity, torque = back_and_forth()
    (warning,) = warnings_of(tmp_path, {"t": time, "speed": velocity, "torque_Nm": torque})
    assert "taken as deg/s" in warning
    assert warnings_of(tmp_path, {"t": time, "rpm": velocity, "torque_Nm": torque}) == ()


def test_a_column_named_rpm_is_in_rpm(tmp_path):
    time, _, velocity, torque = back_and_forth()
    warnings_of(tmp_path, {"t": time, "rpm": velocity / 6, "torque_Nm": torque})
    table = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    np.testing.assert_allclose(table["velocity"], velocity, atol=1e-6)


def test_a_motor_that_turns_on_may_be_logged_in_radians(tmp_path):
    time, position, _, torque = back_and_forth()
    columns = {"t": time, "position": position, "torque_Nm": torque}
    (warning,) = warnings_of(tmp_path, columns)
    assert "--position-unit rad" in warning
    forced = IngestSettings(position_unit="rad")
    assert not any("read as deg" in text for text in warnings_of(tmp_path, columns, forced))


def test_gravity_or_round_turning_points_show_degrees(tmp_path):
    time, position, gravity, friction = swings()
    columns = {"t": time, "position": 0.9 * position + 4, "torque_Nm": gravity + friction}
    # from -50 to 58, with the gravity of these angles
    columns["torque_Nm"] = 30 * np.cos(np.radians(columns["position"])) + friction
    assert warnings_of(tmp_path, columns) == ()
    # without gravity, but from -60 to 60
    columns |= {"position": position, "torque_Nm": friction}
    assert warnings_of(tmp_path, columns) == ()
    columns["position"] = 0.9 * position
    (warning,) = warnings_of(tmp_path, columns)
    assert "--position-unit rad" in warning


@pytest.mark.parametrize(("end", "unit"), [(100.0, "deg"), (1.0, "rad")])
def test_positions_relative_to_the_range(end, unit, tmp_path):
    time, position, gravity, friction = swings()
    relative = np.clip(position / 59 * end, -end, end)
    columns = {"t": time, "pos_1": relative, "pos_2": 0.9 * relative}
    columns |= {"torque_1_Nm": gravity + friction, "torque_2_Nm": gravity + friction}
    (warning,) = warnings_of(tmp_path, columns)
    assert f"ends exactly at ±{end:g}" in warning
    assert f"read as {unit}" in warning
    columns |= {"pos_1": 0.7 * relative, "pos_2": 0.6 * relative}
    assert warnings_of(tmp_path, columns) == ()
    columns = {name.replace("pos", "observation.state"): one for name, one in columns.items()}
    assert all("stays within" in warning for warning in warnings_of(tmp_path, columns))


def test_counts_that_no_velocity_explains_are_refused(tmp_path):
    time, position, velocity, torque = back_and_forth()
    counts = np.round(position * 4096 / 360) + 2048
    columns = {"t": time, "position": counts, "velocity": velocity / 6 / 0.229, "torque_Nm": torque}
    with pytest.raises(LogError, match=r"whole numbers .*counts\?; give the angle of one pulse"):
        warnings_of(tmp_path, columns)


def test_the_size_of_a_count_given_as_advised_is_taken(tmp_path):
    time, position, _, torque = back_and_forth()
    columns = {"t": time, "position": np.round(position * 4096 / 360) + 2048, "torque_Nm": torque}
    (tmp_path / "scale.toml").write_text("[scale]\nposition = 0.0879\n")
    settings = IngestSettings(map_file=tmp_path / "scale.toml")
    warnings_of(tmp_path, columns, settings)
    table = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    assert np.ptp(table["position"]) == pytest.approx(np.ptp(position), rel=1e-2)


def test_a_current_of_hundreds_may_be_in_milliampere(tmp_path):
    time, position, _, torque = back_and_forth()
    columns = {"t": time, "q_deg": position, "current": 100 * torque}
    (warning,) = warnings_of(tmp_path, columns)
    assert "--torque-unit mA" in warning


def test_columns_of_the_same_name_are_told(tmp_path):
    lines = ["t,q_deg,tau_Nm,tau_Nm"]
    for t, q, _, u in np.stack(back_and_forth(), axis=1):
        lines.append(f"{t:.4f},{q:.6f},{u:.3f},0")
    (tmp_path / "log.csv").write_text("\n".join(lines))
    summary = ingest([tmp_path / "log.csv"], tmp_path / "work")
    assert any("several columns are named tau_Nm" in warning for warning in summary.warnings)


@pytest.mark.parametrize(("per_second", "unit"), [(1e3, "ms"), (1e6, "us"), (1e9, "ns")])
def test_whole_times_with_long_steps_are_no_seconds(per_second, unit, tmp_path):
    time, position, _, torque = back_and_forth(period=0.01)
    columns = {"t": np.round(time * per_second), "q_deg": position, "tau_Nm": torque}
    summary = ingest([write(tmp_path / "log.csv", columns)], tmp_path / "work")
    assert f"t is read as {unit}" in summary.notes
    table = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    np.testing.assert_allclose(table["time"], time, atol=1e-9)


def test_times_that_count_rows_or_milliseconds(tmp_path):
    """Both pieces of advice lead to the right times."""
    time, position, _, torque = back_and_forth(period=0.01)
    columns = {"time": np.arange(len(time)), "q_deg": position, "tau_Nm": torque}
    (warning,) = warnings_of(tmp_path, columns)
    assert "--time-unit ms" in warning
    assert warnings_of(tmp_path, columns, IngestSettings(time_unit="ms")) == ()
    (tmp_path / "scale.toml").write_text("[scale]\ntime = 0.01\n")
    warnings_of(tmp_path, columns, IngestSettings(map_file=tmp_path / "scale.toml"))
    table = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    np.testing.assert_allclose(table["time"], time, atol=1e-9)


def test_velocity_shows_that_a_time_that_grows_by_one_is_in_milliseconds(tmp_path):
    time, position, velocity, torque = back_and_forth(period=0.001)
    columns = {"time": np.arange(len(time)), "q_deg": position, "qd_deg_s": velocity}
    assert warnings_of(tmp_path, columns | {"tau_Nm": torque}) == ()


def test_large_whole_torques_may_be_in_other_units(tmp_path):
    time, position, _, torque = back_and_forth()
    (warning,) = warnings_of(tmp_path, {"t": time, "q_deg": position, "torque": 1000 * torque})
    assert "mN·m" in warning


def test_counts_and_counts_per_second_are_not_explained_by_microseconds(tmp_path):
    """A drive's raw values: no unit of time is so short that the rows are nanoseconds apart."""
    time, position, velocity, torque = back_and_forth()
    counts = np.round(position * 2**17 / 3.6)
    columns = {"t": time, "position": counts, "velocity": np.round(velocity * 2**17 / 3.6)}
    with pytest.raises(LogError, match=r"counts\?; give the angle of one pulse"):
        warnings_of(tmp_path, columns | {"torque_Nm": torque})


def test_a_position_that_repeats_its_command_is_no_measured_one(tmp_path):
    """Simulators and mock drives return the command, at once or some rows later."""
    time, position, gravity, friction = swings()
    columns = {"t": time, "actual_q_1_deg": position, "target_q_1_deg": position}
    columns["tau_1_Nm"] = gravity + friction
    (warning,) = warnings_of(tmp_path, columns)
    assert "actual_q_1_deg repeats its command in 100 % of the rows" in warning
    (warning,) = warnings_of(tmp_path, columns | {"target_q_1_deg": np.roll(position, -2)})
    assert "repeats its command" in warning
    # a drive follows some milliseconds later
    columns["target_q_1_deg"] = 60 * np.sin(2 * np.pi * (time + 0.005) / 12)
    assert warnings_of(tmp_path, columns) == ()


def test_a_torque_without_noise_is_that_of_a_model(tmp_path):
    time, position, _, _ = swings()
    speed = np.cos(2 * np.pi * time / 12)
    model = 30 * np.cos(np.radians(position)) + np.sign(speed) * (2 + np.abs(speed))
    (warning,) = warnings_of(tmp_path, {"t": time, "q_deg": position, "tau_Nm": model})
    assert "tau_Nm has no noise: simulated" in warning
    noise = np.random.default_rng(2).normal(0, 0.01, len(time))
    assert warnings_of(tmp_path, {"t": time, "q_deg": position, "tau_Nm": model + noise}) == ()


def test_of_two_positions_the_one_that_changes_is_read(tmp_path):
    time, position, gravity, friction = swings()
    columns = {"t": time, "joint_6/pos": 0 * time, "joint_6/position [deg]": position}
    columns["joint_6/torque/Nm"] = gravity + friction
    assert warnings_of(tmp_path, columns) == ()
    table = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    assert set(table["joint"]) == {6}
    np.testing.assert_allclose(table["position"], position, atol=1e-6)


def test_seconds_that_a_name_calls_milliseconds(tmp_path):
    time, position, gravity, friction = swings()
    columns = {"time_ms": time, "q_deg": position, "tau_Nm": gravity + friction}
    (warning,) = warnings_of(tmp_path, columns)
    assert "--time-unit s" in warning
    assert warnings_of(tmp_path, columns, IngestSettings(time_unit="s")) == ()
    assert warnings_of(tmp_path, columns | {"time_ms": 1e3 * time}) == ()
