# ruff: noqa: TID251
"""Axes that the page shows values of under the pointer."""

import json

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from frictioncli.report.pointer_values import panels_text


def drawn_panels(figure):
    FigureCanvasAgg(figure).draw()
    return json.loads(panels_text(figure))


@pytest.fixture
def figure():
    return Figure(figsize=(5, 4))


def test_edges_and_limits_give_back_each_point(figure):
    axes = figure.add_axes((0.2, 0.3, 0.5, 0.6))
    axes.set(xlim=(10, 60), ylim=(-3, 9), xlabel="motor temperature Tm [°C]", ylabel="τ [N·m]")
    ((edges, across, up),) = drawn_panels(figure)
    assert [across, up] == [["motor temperature Tm [°C]", 10, 60, 0], ["τ [N·m]", -3, 9, 0]]
    left, upper, right, lower = edges
    # the point (35, 0) in points of the SVG, which has its origin at the upper left
    x, y = axes.transData.transform((35.0, 0.0)) * 72 / figure.dpi
    assert (x - left) / (right - left) == pytest.approx((35 - 10) / 50, abs=1e-3)
    assert (lower - (4 * 72 - y)) / (lower - upper) == pytest.approx(3 / 12, abs=1e-3)


def test_a_shared_axis_has_the_name_of_its_sibling(figure):
    above, below = figure.subplots(2, 1, sharex=True)
    below.set(xlabel="time t [min]", ylabel="T [°C]")
    above.set(ylabel="torque u [N·m]")
    assert [across[0] for _, across, _ in drawn_panels(figure)] == ["time t [min]"] * 2


def test_a_logarithmic_axis_says_so(figure):
    axes = figure.subplots()
    axes.set(xscale="log", xlim=(1, 100), xlabel="speed [deg/s]", ylabel="τ [N·m]")
    axes.set_xticks([1, 10, 100], ["1", "10", "100"])
    ((_, across, _),) = drawn_panels(figure)
    assert across == ["speed [deg/s]", 1, 100, 1]


def test_axes_of_categories_and_without_a_name_are_left_out(figure):
    categories, unnamed = figure.subplots(1, 2)
    categories.set(xlabel="time [h]", ylabel="speed [deg/s]")
    categories.set_yticks(np.arange(3) + 0.5, ["2.3–4.2", "7.6", "12.4"])
    unnamed.set(xlabel="time [h]")
    assert drawn_panels(figure) == []
