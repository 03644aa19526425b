"""Quantized motor temperatures are interpolated between the changes of their register."""

from datetime import UTC, datetime, timedelta

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from frictioncli import schemas, tables
from frictioncli.logs.ingest import ingest
from frictioncli.logs.samples import quantized_temperature
from frictioncli.logs.samples.temperature_register import TemperatureRegister, run_knots

from .logs import kuka_columns, write


def interpolated(time, reading, longest=2.0):
    changes = quantized_temperature.find_changes(time, reading, longest=longest)
    step = quantized_temperature.find_step(np.unique(reading))
    whole = quantized_temperature.Recordings(time[:1], time[-1:], reading[-1:])
    knots = quantized_temperature.interpolation_knots(changes, step=step, recordings=whole)
    return quantized_temperature.interpolate_temperature(knots, time, reading)


def test_a_ramp_is_rebuilt_exactly():
    time = np.arange(0, 1000, 0.5)
    truth = 20.2 + 0.01 * time
    error = interpolated(time, np.round(truth)) - truth
    assert np.max(np.abs(error)) < 0.01
    assert np.max(np.abs(np.round(truth) - truth)) > 0.49


def test_warming_and_cooling():
    time = np.arange(0, 20000, 1.0)
    truth = 25 + 20 * (1 - np.exp(-time / 3000))
    truth = np.where(time < 10000, truth, truth[10000] * np.exp(-(time - 10000) / 8000))
    found = interpolated(time, np.round(truth))
    raw_error = np.sqrt(np.mean((np.round(truth) - truth) ** 2))
    assert np.sqrt(np.mean((found - truth) ** 2)) < 0.4 * raw_error


def test_flicker_makes_no_spikes():
    time = np.arange(0, 2000, 1.0)
    rng = np.random.default_rng(3)
    truth = 30.0 + 0.002 * time
    found = interpolated(time, np.round(truth + rng.normal(0, 0.02, len(time))))
    assert np.max(np.abs(np.diff(found))) < 0.1
    assert np.max(np.abs(found - truth)) < 0.1


def test_changes_across_a_pause_are_not_dated():
    time = np.array([0.0, 1.0, 300.0, 301.0])
    reading = np.array([20.0, 20.0, 21.0, 22.0])
    changes = quantized_temperature.find_changes(time, reading, longest=2.0)
    np.testing.assert_array_equal(changes.time, [300.5])
    np.testing.assert_array_equal(changes.before + changes.after, [43.0])


@pytest.mark.parametrize(
    ("levels", "step"),
    [
        ([20.0, 21.0, 25.0], 1.0),
        ([26.85, 27.85, 30.85], 1.0),
        ([20.0, 20.5, 22.0], 0.5),
        ([20.0, 20.0625, 21.0], None),
        ([20.0, 21.0, 21.7], None),
        ([20.0], None),
    ],
)
def test_step(levels, step):
    found = quantized_temperature.find_step(np.array(levels))
    assert found == (None if step is None else pytest.approx(step))


@settings(max_examples=60)
@given(
    slope=st.floats(0.002, 0.02),
    start=st.floats(15, 60),
    sign=st.sampled_from([-1, 1]),
    pause=st.floats(0, 3000),
)
def test_rebuilt_stays_in_the_band_of_the_reading(slope, start, sign, pause):
    time = np.concatenate((np.arange(0, 1500, 1.0), 1500 + pause + np.arange(0, 1500, 1.0)))
    truth = start + sign * slope * time
    reading = np.round(truth)
    found = interpolated(time, reading)
    assert np.max(np.abs(found - reading)) <= 0.5 + 1e-9
    raw = np.sqrt(np.mean((reading - truth) ** 2))
    assert np.sqrt(np.mean((found - truth) ** 2)) < 0.25 * raw


def test_two_recordings_minutes_apart(tmp_path):
    """With a manifest the temperature runs on through the pause between recordings."""
    began = datetime(2024, 5, 17, 9, 30, tzinfo=UTC)
    lines = ["file;started_at"]
    for number, offset in enumerate((0.0, 300.0), start=1):
        columns = kuka_columns(180.0)
        truth = 290.0 + 0.03 * (columns["Zeit[sec]"] + offset)
        columns["MotorTemp_Act2[K]"] = np.round(truth)
        write(tmp_path / "run" / f"s{number}.csv", columns)
        lines.append(f"s{number}.csv;{(began + timedelta(seconds=offset)).isoformat()}")
    (tmp_path / "run" / "manifest.csv").write_text("\n".join(lines))
    summary = ingest([tmp_path / "run"], tmp_path / "work")
    table = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    truth = 290.0 - 273.15 + 0.03 * table["time"]
    assert summary.time_known
    assert (table["motor_temperature"] - truth).abs().max() < 0.02
    assert (table["motor_temperature_reading"] - truth).abs().max() > 0.49
    assert any("steps of 1 °C" in note for note in summary.notes)


def test_runs_of_one_register_share_a_note(tmp_path):
    for number, slope in enumerate((0.03, 0.05), start=1):
        columns = kuka_columns(180.0)
        columns["MotorTemp_Act2[K]"] = np.round(290.0 + slope * columns["Zeit[sec]"])
        write(tmp_path / f"day{number}" / "log.csv", columns)
    summary = ingest([tmp_path / "day1", tmp_path / "day2"], tmp_path / "work")
    (note,) = (one for one in summary.notes if "steps of 1 °C" in one)
    assert "between 5 to 9 of them in each of 2 runs" in note


def test_fine_resolution_is_left_alone(tmp_path):
    columns = kuka_columns()
    columns["Motortemperatur2[°C]"] = np.round(30 + columns["Zeit[sec]"] / 16, 2)
    ingest([write(tmp_path / "log.csv", columns)], tmp_path / "work")
    table = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    np.testing.assert_array_equal(table["motor_temperature"], table["motor_temperature_reading"])


def test_a_long_rest_before_the_first_change_stays_at_the_reading():
    """An hour at 18.1 °C, then warming: the slope of warming says nothing of the rest."""
    time = np.arange(0, 5000, 1.0)
    truth = 18.1 + 0.01 * np.maximum(time - 3600, 0)
    found = interpolated(time, np.round(truth))
    assert np.max(np.abs(found - truth)[time < 3500]) < 0.11
    assert np.max(np.abs(found - truth)[time > 3700]) < 0.11


def test_where_a_joint_is_heated_in_pauses_the_readings_of_short_recordings_are_not_shifted():
    """10 min of heating are not logged, then 60 s are, in which the motor hardly warms.

    No recording but the first and the last has a change. A line between these would be degrees off
    and, held within half a step of the readings, always at the edge of them.
    """
    pauses = 600.0 * np.arange(12)
    level = 24.3 + 25.0 * (1 - np.exp(-pauses / 2400.0))
    registers, inside, truth, found = [], [], [], []
    for start, warm in zip(pauses, level, strict=True):
        time = np.arange(0.0, 60.0, 0.1)
        true = warm + (0.02 if start in (0.0, pauses[-1]) else 0.0) * time
        one = TemperatureRegister()
        one.update(time, np.round(true), 2.0)
        registers.append((start, one))
        inside.append((start + time, np.round(true)))
        truth.append(true)
    first, *_ = knots = run_knots(registers, starts_known=True)
    assert all(one is first for one in knots)
    assert sum(len(one.changes) for _, one in registers) == 2
    for (time, reading), true in zip(inside, truth, strict=True):
        found.append(quantized_temperature.interpolate_temperature(first, time, reading) - true)
    error = np.array(found)[1:-1].mean(axis=1)
    rounding = np.array([(r - t).mean() for (_, r), t in zip(inside, truth, strict=True)])[1:-1]
    np.testing.assert_allclose(error, rounding, atol=0.05)
