# ruff: noqa: TID251
"""Figures 4 to 7: the thermal cycle, and friction against temperature."""

import numpy as np
import pytest
from matplotlib.colors import to_hex

from frictioncli.report.thermal_figures import (
    branch_means_figure,
    friction_temperature_figure,
    temperature_figure,
)
from tests.report.figure_contents import at_zero_load, data_lines, texts


def test_temperature_figure_writes_the_duration_of_each_phase(two_runs):
    """Heating pairs lie 5490 s apart, cooling pairs 17490 s: 92 min, and 4 h 52 min."""
    figure = temperature_figure(two_runs)
    shown = texts(figure)
    assert "heating, 92 min" in shown
    assert "cooling, 4 h 52 min" in shown
    motor = next(line for line in figure.axes[0].lines if line.get_label() == "motor Tm")
    own = two_runs.pairs[two_runs.pairs["run"] == "day-1"]
    np.testing.assert_allclose(motor.get_xdata(), own["time"] / 60)
    np.testing.assert_allclose(motor.get_ydata(), own["motor_temperature"])


@pytest.mark.parametrize("kind", ["motor", "housing"])
def test_heating_is_filled_and_cooling_hollow(two_runs, kind):
    axes = friction_temperature_figure(two_runs, kind).axes[0]
    lines = data_lines(axes)
    assert [len(line.get_xdata()) for line in lines] == [10, 30] * 4
    for heating, cooling in zip(lines[::2], lines[1::2], strict=True):
        assert to_hex(heating.get_markerfacecolor()) == to_hex(heating.get_color())
        assert to_hex(cooling.get_markerfacecolor()) == "#ffffff"
        assert heating.get_color() == cooling.get_color()
    own = two_runs.thermal_pairs
    own = own[(own["run"] == "day-1") & (own["speed"] == 101.2) & (own["phase"] == "heat-up")]
    np.testing.assert_allclose(lines[-2].get_xdata(), own[f"{kind}_temperature"])
    np.testing.assert_allclose(lines[-2].get_ydata(), own["friction_torque"])


def test_model_curve_of_the_means_follows_the_equation(two_runs):
    axes = branch_means_figure(two_runs).axes[0]
    points, curve = data_lines(axes)[-2:]
    np.testing.assert_allclose(
        curve.get_ydata(), at_zero_load(101.2, np.asarray(curve.get_xdata())), rtol=1e-12
    )
    # heating lags by +3 °C of friction, cooling by as much the other way: the mean is the model's
    assert np.abs(points.get_ydata() - at_zero_load(101.2, points.get_xdata())).max() < 3
