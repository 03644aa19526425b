"""Cells of the residual maps by move and angle, against the maps themselves."""

import re

import numpy as np
import pytest

from frictioncli.report import style
from frictioncli.report.data_points import data_points
from frictioncli.report.figure_files import svg
from frictioncli.report.residual_maps import residual_map_figure
from tests.report.test_data_points import unpacked

MAPS = [("temperature", "speed"), ("clock", "position"), ("position", "speed")]


@pytest.fixture(scope="module")
def figure(diagnosed):
    with style.style_context():
        return residual_map_figure(diagnosed, diagnosis=diagnosed.diagnosis)


def cells_of(points, name):
    """Return the number of the cell of each point of the chart, forward or reverse."""
    own, length = points["cells"][name], np.array(points["length"])
    if "move" in own:
        return np.repeat(own["move"], length)
    return np.searchsorted(own["edges"][1:-1], unpacked(points["columns"]["angle"]), side="right")


@pytest.mark.parametrize("number", range(len(MAPS)))
def test_points_of_a_cell_have_its_mean(diagnosed, figure, number):
    """Half the sum of both directions is the load's residual, half the difference friction's."""
    points = data_points(diagnosed)
    across, up = (cells_of(points, name) for name in MAPS[number])
    forward, reverse = (
        unpacked(points["columns"][f"base_{way}"]) for way in ("forward", "reverse")
    )
    shown = np.ma.filled(figure.axes[2 * number].collections[0].get_array().astype(float), np.nan)
    assert shown.shape == tuple(
        len(points["cells"][name]["texts"]) for name in reversed(MAPS[number])
    )
    seen = np.repeat(points["cells"]["speed"]["move"], points["length"]) >= 0
    for row, column in zip(*np.nonzero(np.isfinite(shown)), strict=True):
        inside = seen & (across == column) & (up == row)
        missed = (forward - reverse)[inside].mean() / 2
        assert missed == pytest.approx(shown[row, column], abs=2e-3)


def test_moves_that_the_maps_do_not_show_are_in_no_cell(diagnosed):
    points = data_points(diagnosed, most_rows=3000)
    runs = [points["runs"][number] for number in points["run"]]
    held_out = diagnosed.diagnosis.document.held_out
    assert points["step"] > 1
    for name in ("clock", "temperature", "speed"):
        inside = np.array(points["cells"][name]["move"]) >= 0
        assert inside.tolist() == [run != held_out for run in runs]


def test_cells_say_their_limits(diagnosed):
    cells = data_points(diagnosed)["cells"]
    assert cells["speed"]["texts"][3] == "19.1 deg/s"
    warm, cold = cells["temperature"]["texts"][0], cells["temperature"]["texts"][-1]
    assert warm.startswith("heating, ")
    assert warm.removeprefix("heating, ") == cold.removeprefix("cooling, ")
    low, high = map(float, re.findall(r"[\d.]+", cells["position"]["texts"][0]))
    assert low < high


def test_without_a_diagnosis_there_are_no_cells(two_runs):
    assert data_points(two_runs)["cells"] == {}


def test_each_map_carries_its_axes(figure):
    with style.style_context():
        text = svg(figure, "maps", "maps")
    found = set(re.findall(r'id="maps-cells-([^"]*)"', text))
    assert found == {
        f"{across}-{up}-{channel}-{model}"
        for across, up in MAPS
        for channel in ("friction", "load")
        for model in ("base", "extended")
    }
