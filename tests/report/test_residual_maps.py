"""Maps hold the mean residual per cell."""

from itertools import pairwise

import numpy as np
import pytest

from frictioncli.report import style
from frictioncli.report.binning import is_warming, merge_close_values
from frictioncli.report.residual_maps import MapAxis, cell_means, colour_limit, residual_map_figure
from tests.report.figure_contents import texts


def test_maps_hold_cell_means_about_zero(diagnosed, diagnosis):
    with style.style_context():
        figure = residual_map_figure(diagnosed, diagnosis=diagnosis)
    table, missed = diagnosis.seen.problem.table, diagnosis.seen.before["friction"]
    mesh = figure.axes[0].collections[0]
    assert mesh.norm.vmin == -mesh.norm.vmax
    shown = np.ma.filled(mesh.get_array().astype(float), np.nan)
    assert shown.shape[0] == len(np.unique(merge_close_values(table.speed)))
    # rising temperature in the left half, falling in the right one, mirrored
    edges = np.linspace(table.temperature.min(), table.temperature.max(), 10)
    warming = is_warming(table)
    assert warming.any()
    assert not warming.all()
    for speed, row in ((19.1, 3), (101.2, 8)):
        for column, (low, high) in enumerate(pairwise(edges)):
            for branch, place in ((warming, column), (~warming, 17 - column)):
                inside = (table.temperature > low + 1e-9) & (table.temperature < high - 1e-9)
                chosen = (table.speed == speed) & branch & inside
                if chosen.any():
                    np.testing.assert_allclose(shown[row, place], missed[chosen].mean(), atol=0.2)
    shown = texts(figure)
    assert {"friction, base model", "load, base model", "friction, extended model"} <= set(shown)
    assert "measured − simulated [N·m]" in shown
    axes = {"speed [deg/s]", "Tm [°C], heating | cooling", "joint angle φ [deg]", "time [h]"}
    assert axes <= set(shown)


def test_empty_cells_are_not_zero_and_noise_is_pale():
    across = MapAxis("a", np.array([0.5, 0.6, 2.5, 2.6]), np.arange(4.0))
    up = MapAxis("b", np.zeros(4), np.array([0.0, 1.0]))
    mean, error = cell_means(across, up, np.array([1.0, 3.0, -1.0, 1.0]), np.array([0, 0, 1, 1]))
    np.testing.assert_allclose(mean, [[2.0, np.nan, 0.0]])
    scatter = np.sqrt(4 / 2)
    np.testing.assert_allclose(error, [[scatter / np.sqrt(2), np.nan, scatter / np.sqrt(2)]])
    assert colour_limit([(mean, error)]) == pytest.approx(4.0)
