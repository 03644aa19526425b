"""Blocks about the place of structure without a name, and what rows tell of it."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from frictioncli.design.information import Information
from frictioncli.design.limits import Limits
from frictioncli.design.located_forms import form_basis
from frictioncli.design.place_blocks import blocks_about
from frictioncli.design.precision import information_on
from frictioncli.design.predicted_rows import constant_speed_bins
from frictioncli.design.steps import HeatStep, RestStep
from frictioncli.diagnosis.empirical.term import FormFunction
from frictioncli.diagnosis.fit.columns import base_rows
from frictioncli.model.noise import Noise
from tests.diagnosis.dense_noise import problem

LIMITS = Limits(low=0.0, high=180.0, slowest=2.0, fastest=100.0, hottest=60.0)
RANGES = {
    "position": (0.0, 180.0),
    "speed": (20.0, 100.0),
    "temperature": (25.0, 60.0),
    "load": (0.0, 95.0),
}


def peak(axis, centre, width, **more):
    kind = "bump" if axis == "position" else "moving_peak" if "shift" in more else "peak"
    return FormFunction(
        kind=kind,
        axes=("speed", "temperature") if "shift" in more else (axis,),
        channel="friction",
        shape={"centre": centre, "width": width} | more,
        coefficients={"peak": 2.0},
        formula="",
    )


def test_speeds_lie_on_both_flanks_of_a_peak_cold_and_warm():
    cold, warm = blocks_about([peak("speed", 30.0, 0.2)], LIMITS, seed=0)
    assert isinstance(warm.steps[0], HeatStep)
    assert warm.steps[1] == cold.steps[0]
    speeds = np.array(cold.steps[0].speeds)
    away = np.log(speeds / 30.0) / 0.2
    assert len(speeds) == 8
    assert away.min() == pytest.approx(-2.5, abs=0.1)
    assert away.max() == pytest.approx(2.5, abs=0.1)
    assert list(speeds) != sorted(speeds)


def test_speeds_follow_a_peak_that_moves_with_temperature():
    still = blocks_about([peak("speed", 30.0, 0.2)], LIMITS, seed=0)[0].steps[0].speeds
    moving = blocks_about([peak("speed", 30.0, 0.2, shift=0.02)], LIMITS, seed=0)[0]
    # up to 60 °C, 20 K above the temperature at which it is at 30 deg/s
    assert max(moving.steps[0].speeds) / max(still) == pytest.approx(np.exp(0.4), rel=0.02)
    assert min(moving.steps[0].speeds) < min(still)


@pytest.mark.parametrize("centre", [20.0, 90.0, 170.0])
def test_short_moves_pass_an_angle_at_constant_speed(centre):
    (block,) = blocks_about([peak("position", centre, 3.0, lag=0.0)], LIMITS, seed=0)
    (series,) = block.steps
    assert LIMITS.low <= series.low < centre < series.high <= LIMITS.high
    assert series.high - series.low <= 30.0
    assert len(series.speeds) >= 4
    for speed in series.speeds:
        bins = constant_speed_bins(speed, series.low, series.high, 1.0)
        assert bins.min() <= centre - 3.0 + 1.0
        assert bins.max() >= centre + 3.0 - 1.0


def test_a_temperature_is_passed_on_both_flanks_and_again_cooling():
    through, at_it = blocks_about([peak("temperature", 45.0, 2.0)], LIMITS, seed=0)
    until = [one.until for one in through.steps if isinstance(one, HeatStep)]
    assert until == pytest.approx([40.0, 42.5, 45.0, 47.5, 50.0])
    assert isinstance(through.steps[-2], RestStep)
    assert at_it.steps[0].until == pytest.approx(45.0)
    # what the joint may not reach is not proposed
    assert blocks_about([peak("temperature", 70.0, 2.0)], LIMITS, seed=0) == ()


def test_what_has_no_place_within_the_limits_gets_no_block():
    assert blocks_about([peak("load", 40.0, 5.0)], LIMITS, seed=0) == ()
    assert blocks_about([peak("position", 300.0, 5.0, lag=0.0)], LIMITS, seed=0) == ()
    assert blocks_about([], LIMITS, seed=0) == ()


def test_what_rows_tell_of_a_column_is_what_base_and_noise_leave_of_it():
    """With white noise and a free base: half ln(1 + squares left / variance)."""
    data = replace(problem(3), temperature_error=0.0)
    white = Noise(point=0.5, pair=0.0, drift=0.0, drift_time=600.0)
    form = peak("speed", 70.0, 0.2)
    both = form.at(data.table)
    column = type(both)(both.friction[:, np.newaxis], both.load[:, np.newaxis])
    prior = np.full(base_rows(data)[0].shape[1], 1e-12)
    nothing = SimpleNamespace(causes=())
    told = information_on(Information(data, (white, white), data.all_runs), nothing, prior, column)
    base, torque = np.vstack(base_rows(data)), np.vstack(column)[:, 0]
    scaled = base / np.linalg.norm(base, axis=0)
    left = torque - scaled @ np.linalg.lstsq(scaled, torque, rcond=1e-12)[0]
    assert told == pytest.approx(0.5 * np.log1p(left @ left / 0.5**2), rel=1e-3)


def test_columns_of_a_form_are_its_derivatives_and_what_may_change_it():
    table = problem(3).table
    form = peak("temperature", 45.0, 2.0)
    columns = form_basis([form], table, RANGES).friction
    # height, place, width; height and place by angle, speed and load
    assert columns.shape == (len(table.speed), 3 + 2 * 3)
    away = (table.temperature - 45.0) / 2.0
    slope = 2.0 * np.exp(-np.square(away) / 2) * away / 2.0
    step = np.ptp(RANGES["temperature"]) / 23
    assert columns[:, 1] == pytest.approx(slope * step, abs=0.1 * np.max(np.abs(slope * step)))
    unit = 2 * table.position / 180.0 - 1
    assert columns[:, 3] == pytest.approx(columns[:, 0] * unit)
