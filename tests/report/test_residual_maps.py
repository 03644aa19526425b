"""Maps hold the mean residual per cell."""

from itertools import pairwise

import numpy as np
import pytest

from frictioncli.report import style
from frictioncli.report.binning import (
    merge_close_values,
)
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
    edges = np.linspace(table.temperature.min(), table.temperature.max(), 10)
    for speed, row in ((19.1, 3), (101.2, 8)):
        for column, (low, high) in enumerate(pairwise(edges)):
            chosen = (table.speed == speed) & (table.temperature >= low)
            chosen &= (table.temperature < high) | (column == 8)
            wanted = missed[chosen].mean() if chosen.any() else np.nan
            np.testing.assert_allclose(shown[row, column], wanted)
    shown = texts(figure)
    assert "friction, base model: measured − simulated" in shown
    assert "load, base model: measured − simulated" in shown
    assert {"speed [deg/s]", "temperature Tm [°C]", "joint angle φ [deg]", "time [h]"} <= set(shown)


def test_empty_cells_are_not_zero_and_noise_is_pale():
    across = MapAxis("a", np.array([0.5, 0.6, 2.5, 2.6]), np.arange(4.0))
    up = MapAxis("b", np.zeros(4), np.array([0.0, 1.0]))
    mean, error = cell_means(across, up, np.array([1.0, 3.0, -1.0, 1.0]), np.array([0, 0, 1, 1]))
    np.testing.assert_allclose(mean, [[2.0, np.nan, 0.0]])
    scatter = np.sqrt(4 / 2)
    np.testing.assert_allclose(error, [[scatter / np.sqrt(2), np.nan, scatter / np.sqrt(2)]])
    assert colour_limit([(mean, error)]) == pytest.approx(4.0)
