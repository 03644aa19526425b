"""Temperatures that fall out for a moment are no temperatures of the joint."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from frictioncli import schemas, tables
from frictioncli.logs.ingest import ingest
from frictioncli.logs.samples.temperature_dropouts import without_dropouts
from frictioncli.stages.pair import pair

from .logs import kuka_columns, write

TIME = np.arange(0.0, 600.0, 0.5)
WARM = 35.0 + 0.01 * TIME


@pytest.mark.parametrize("value", [0.0, 85.0, -20.0])
def test_readings_that_jump_away_and_back_are_left_out(value):
    reading = WARM.copy()
    gone = slice(400, 406), slice(700, 701), slice(900, 1000)
    for one in gone:
        reading[one] = value
    found = without_dropouts(TIME, reading)
    missing = np.zeros(len(TIME), bool)
    for one in gone:
        missing[one] = True
    assert np.array_equal(np.isnan(found), missing)
    assert np.array_equal(found[~missing], WARM[~missing])


def test_a_joint_that_cooled_in_a_pause_keeps_its_readings():
    """Two short recordings in the cold, between two warm ones a minute apart."""
    time = np.concatenate([start + np.arange(0.0, 10.0, 0.5) for start in (0, 3600, 3620, 7200)])
    reading = np.repeat([45.0, 25.0, 25.0, 45.0], 20)
    assert without_dropouts(time, reading) is reading


def test_a_sensor_that_is_changed_for_good_keeps_its_readings():
    reading = np.where(TIME < 300.0, WARM, WARM - 15.0)
    assert without_dropouts(TIME, reading) is reading


@given(
    st.lists(st.floats(20.0, 60.0), min_size=3, max_size=40),
    st.lists(st.floats(0.01, 300.0), min_size=40, max_size=40),
)
def test_what_is_left_is_what_was_read(readings, steps):
    reading = np.array(readings)
    found = without_dropouts(np.cumsum(steps)[: len(reading)], reading)
    kept = np.isfinite(found)
    assert np.array_equal(found[kept], reading[kept])
    assert kept[0]
    assert kept[-1]


def test_a_pair_has_the_temperature_of_its_other_samples(tmp_path):
    columns = kuka_columns()
    time = columns["Zeit[sec]"]
    columns["Motortemperatur2[°C]"] = 41.0 + 0.1 * time
    whole = tmp_path / "whole"
    ingest([write(tmp_path / "log.csv", columns)], whole)
    pair(whole)
    columns["Motortemperatur2[°C]"][(time > 1.0) & (time < 1.6)] = 0.0
    ingest([write(tmp_path / "log.csv", columns)], tmp_path / "work")
    pair(tmp_path / "work")
    samples = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    assert samples["motor_temperature"].min() > 40.0
    expected, found = (
        tables.read(one / "pairs.parquet", schemas.PAIRS)["motor_temperature"].to_numpy()
        for one in (whole, tmp_path / "work")
    )
    assert len(found) == len(expected) > 0
    np.testing.assert_allclose(found, expected, atol=0.05)
