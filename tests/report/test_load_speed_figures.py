"""Figures 3 and 8: friction against load and against speed."""

from dataclasses import replace

import numpy as np
import pytest

from frictioncli.report.load_speed_figures import (
    friction_at_reference_temperature,
    load_figure,
    representative_pairs,
    speed_figure,
)
from tests.report.figure_contents import FIGURE_SPECS, at_zero_load, data_lines, texts


def test_load_figure_shows_the_parabola_and_takes_the_shift_away(two_runs):
    figure = load_figure(two_runs)
    curves, shifted = figure.axes[0], figure.axes[1]
    parabola = next(line for line in shifted.lines if line.get_label() == "α L²")
    load = np.asarray(parabola.get_xdata())
    np.testing.assert_allclose(parabola.get_ydata(), 0.0014 * load**2)
    first = data_lines(curves)[1]
    rise = first.get_ydata()[0] - min(first.get_ydata())
    assert rise == pytest.approx(0.0014 * first.get_xdata()[0] ** 2, abs=0.001)
    points = [line for line in data_lines(shifted) if line is not parabola]
    assert abs(np.mean([np.mean(line.get_ydata()) for line in points]) - 1.12) < 0.3


def test_load_figure_names_speed_and_temperature_of_each_curve(two_runs):
    shown = texts(load_figure(two_runs))
    assert "2.3 deg/s, 25 °C" in shown
    assert "19.1 deg/s, 65 °C" in shown


def test_curves_span_cold_and_hot_where_there_is_no_sweep(two_runs):
    pairs = two_runs.thermal_pairs
    chosen = representative_pairs(pairs[pairs["run"] == "day-1"])
    assert len(chosen) == 8
    assert chosen.groupby("speed")["motor_temperature"].agg(np.ptp).min() > 35


def test_friction_is_carried_to_20_degrees_by_equation_15(two_runs):
    """40 N·m at 65 °C and 67.5 deg/s is 40 + 15.66 (e^-1.12 - e^-3.64) 8.2158 = 78.60 N·m."""
    one = two_runs.pairs.iloc[:1].assign(speed=67.5, temperature=65.0, friction_torque=40.0)
    carried = friction_at_reference_temperature(replace(two_runs, pairs=one))
    assert carried["carried"].iloc[0] == pytest.approx(78.60, abs=0.01)


def test_speed_figure_shows_all_speeds_and_the_model(two_runs):
    axes = speed_figure(two_runs).axes[0]
    drawn = [line for line in axes.lines if line.get_linestyle() == "None"]
    at = np.concatenate([np.asarray(line.get_xdata(), float) for line in drawn])
    for speed in (2.3, 5, 10, 19.1, 30, 43, 67.5, 85, 101.2):
        assert np.min(np.abs(at - speed)) < 1e-9
    # branches stand beside each other, so that no point hides another
    pairs = two_runs.pairs[two_runs.pairs["run"] == "day-1"]
    heating = (pairs["phase"] == "heat-up") & (pairs["speed"] == 101.2)
    assert np.sum(np.isclose(at, 101.2 - 0.012 * 101.2)) == heating.sum() > 3
    means = next(line for line in axes.lines if line.get_markersize() == 24)
    np.testing.assert_allclose(sorted(means.get_xdata()), [19.1, 43, 67.5, 101.2])
    curve = next(line for line in axes.lines if line.get_label() == "model (16), L = 0")
    np.testing.assert_allclose(curve.get_ydata(), at_zero_load(np.asarray(curve.get_xdata()), 20))


def test_without_temperature_speed_is_drawn_as_measured(without_temperature):
    carried = friction_at_reference_temperature(without_temperature)
    assert (carried["carried"] == carried["friction_torque"]).all()
    assert "could not be converted" in FIGURE_SPECS["fig8"].caption(without_temperature)
    speed_figure(without_temperature)
