# ruff: noqa: TID251
"""The pictures of a diagnosis show the numbers of its files and of the measured rows."""

import re
from itertools import pairwise

import numpy as np
import pandas as pd
import pytest
from matplotlib.container import ErrorbarContainer
from matplotlib.patches import Rectangle
from matplotlib.text import Text

from frictioncli.report import style
from frictioncli.report.binning import (
    bin_means,
    bin_numbers,
    group_boundaries,
    merge_close_values,
    residual_series,
)
from frictioncli.report.evidence_figure import evidence_figure, shown_probabilities
from frictioncli.report.residual_maps import MapAxis, cell_means, colour_limit, residual_map_figure
from frictioncli.report.results import read_results
from frictioncli.report.simulation_figures import gain_figure, simulated_rows, simulation_figure
from tests.report.test_report_diagnosis import SHIFT, boundary, diagnosed


@pytest.fixture(scope="module")
def work(tmp_path_factory, write_work):
    return diagnosed(write_work(tmp_path_factory.mktemp("pictured"), schedule=False))


@pytest.fixture(scope="module")
def results(work):
    return read_results(work).joints[0]


@pytest.fixture(scope="module")
def diagnosis(results):
    return results.diagnosis


def texts(figure):
    return [text.get_text() for text in figure.findobj(Text) if text.get_text()]


def points_of(panel):
    """Heights of all points with error bars."""
    return np.concatenate(
        [bars[0].get_ydata() for bars in panel.containers if isinstance(bars, ErrorbarContainer)]
    )


def test_evidence_shows_residuals_the_term_and_what_is_left(results, diagnosis):
    with style.style_context():
        figure = evidence_figure(results, diagnosis=diagnosis, index=0)
    left, middle, right, bars = figure.axes
    table, raw = diagnosis.seen.problem.table, diagnosis.seen.before["friction"]
    curves = [
        line
        for line in middle.lines
        if line.get_marker() == "None" and len(set(np.asarray(line.get_ydata()))) > 1
    ]
    assert curves
    for curve in curves:
        np.testing.assert_allclose(curve.get_ydata(), boundary(np.asarray(curve.get_xdata())))
    slowest = raw[table.speed == table.speed.min()].mean()
    assert np.isclose(points_of(left), slowest).any()
    np.testing.assert_allclose(points_of(middle), points_of(left) - SHIFT, atol=1e-9)
    assert np.ptp(points_of(middle) - points_of(right)) > 1.0
    widths = [patch.get_width() for patch in bars.patches]
    np.testing.assert_allclose(widths, [97.0, 2.0, 1.0])
    assert bars.patches[0].get_facecolor() != bars.patches[1].get_facecolor()
    said = texts(figure)
    assert "friction: measured − simulated [N·m]" in said
    assert "speed |φ'| [deg/s]" in said
    assert "probability [%]" in said
    assert {"stribeck", "drift", "all others"} <= set(said)


def test_bars_show_the_whole_credible_set_first():
    shares = {"a": 0.3, "b": 0.25, "c": 0.2, "d": 0.1, "e": 0.06, "f": 0.05, "g": 0.03}
    shown = shown_probabilities(shares, ["a", "b", "c", "d", "e", "f", "g"])
    assert [name for name, _ in shown] == ["a", "b", "c", "d", "e", "f", "g", "all others"]
    assert shown[-1][1] == pytest.approx(0.01)
    assert shown_probabilities({"a": 0.01, "b": 0.99}, ["a"]) == [("a", 0.01), ("b", 0.99)]


def test_errors_are_taken_over_pairs():
    rows = pd.DataFrame(
        {
            "bin": [0, 0, 0, 0, 0, 0, 1, 1],
            "pair": [1, 1, 2, 2, 3, 3, 4, 4],
            "at": [1.0] * 6 + [2.0] * 2,
            "mean": [1.0, 3.0, 4.0, 4.0, 5.0, 7.0, 0.0, 2.0],
            "term": [0.5] * 8,
        }
    )
    found = bin_means(rows)
    np.testing.assert_allclose(found.mean, [4.0, 1.0])
    assert found.error[0] == pytest.approx(np.std([2, 4, 6], ddof=1) / np.sqrt(3))
    assert np.isnan(found.error[1])
    np.testing.assert_allclose(found.term, 0.5)


def test_bins_follow_what_was_measured():
    speed = np.array([10.0, 10.05, 50.0, 99.0])
    assert bin_numbers("speed", speed).tolist() == [0, 0, 1, 2]
    assert merge_close_values(speed)[0] == merge_close_values(speed)[1] == pytest.approx(10.025)
    assert bin_numbers("order", np.arange(10.0)).tolist() == [0, 1, 2, 3, 4, 4, 5, 5, 6, 6]
    assert group_boundaries(np.arange(5.0), 2).tolist() == [2.5]
    assert set(bin_numbers("temperature", np.linspace(20, 60, 500))) == set(range(12))


def test_rows_are_split_where_an_effect_would_cancel(diagnosis):
    table = diagnosis.seen.problem.table
    warm, cool = residual_series(table, "motor_temperature", "friction")
    assert not (warm.rows & cool.rows).any()
    hours = table.time / 3600
    assert warm.rows[(hours > 0.6) & (hours < 1.6)].all()
    assert cool.rows[(hours > 2.4) & (hours < 6.0)].all()
    above, below = residual_series(table, "clock", "load")
    assert (table.load[above.rows] > 0).all()
    assert (table.load[below.rows] <= 0).all()
    assert len(residual_series(table, "clock", "friction")) == 1


def test_maps_hold_cell_means_about_zero(results, diagnosis):
    with style.style_context():
        figure = residual_map_figure(results, diagnosis=diagnosis)
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
    said = texts(figure)
    assert "friction, base model: measured − simulated" in said
    assert "load, base model: measured − simulated" in said
    assert {"speed [deg/s]", "temperature Tm [°C]", "joint angle φ [deg]", "time [h]"} <= set(said)


def test_empty_cells_are_not_zero_and_noise_is_pale():
    across = MapAxis("a", np.array([0.5, 0.6, 2.5, 2.6]), np.arange(4.0))
    up = MapAxis("b", np.zeros(4), np.array([0.0, 1.0]))
    mean, error = cell_means(across, up, np.array([1.0, 3.0, -1.0, 1.0]), np.array([0, 0, 1, 1]))
    np.testing.assert_allclose(mean, [[2.0, np.nan, 0.0]])
    scatter = np.sqrt(4 / 2)
    np.testing.assert_allclose(error, [[scatter / np.sqrt(2), np.nan, scatter / np.sqrt(2)]])
    assert colour_limit([(mean, error)]) == pytest.approx(4.0)


def test_simulated_torque_is_measured_less_the_misfit(results, diagnosis):
    rows = simulated_rows(results, diagnosis).sort_values(["run", "pair", "position"])
    torques = results.torques.sort_values(["run", "time", "pair", "position"])
    np.testing.assert_allclose(np.sort(rows["forward"]), np.sort(torques["torque_forward"]))
    np.testing.assert_allclose(np.sort(rows["reverse"]), np.sort(torques["torque_reverse"]))
    missed = np.concatenate([one.torque(one.before) for one in (diagnosis.seen, diagnosis.new)])
    shown = np.concatenate(
        [rows[name] - rows[f"{name}_simulated"] for name in ("forward", "reverse")]
    )
    np.testing.assert_allclose(np.sort(shown), np.sort(missed), atol=1e-9)
    with style.style_context():
        figure = simulation_figure(results, diagnosis=diagnosis)
    said = texts(figure)
    assert "torque u [N·m]" in said
    assert "measured − simulated [N·m]" in said
    assert "time, run after run [h]" in said
    assert "day-2 (new)" in said
    first = figure.axes[0].lines[0]
    own = rows[rows["speed"].round(1) == 19.1]
    means = own.groupby(["run", "pair"]).agg(time=("time", "first"), torque=("forward", "mean"))
    np.testing.assert_allclose(first.get_ydata(), means.sort_values("time")["torque"])


def test_gain_shows_the_new_run_and_the_noise_floor(results, diagnosis):
    with style.style_context():
        figure = gain_figure(
            results, diagnosis=diagnosis, floor=diagnosis.document.gain.noise_floor
        )
    new = diagnosis.new
    label = next(text for text in texts(figure) if text.startswith("base model"))
    rms = np.sqrt(np.mean(np.square(new.before["friction"]) + np.square(new.before["load"])))
    assert float(re.findall(r"RMS ([\d.]+)", label)[0]) == pytest.approx(rms, rel=5e-3)
    assert "noise floor, 0.700 N·m" in texts(figure)
    left, right = figure.axes
    band = next(patch for patch in left.patches if isinstance(patch, Rectangle))
    assert (band.get_x(), band.get_width()) == pytest.approx((-0.7, 1.4))
    curve = right.lines[0]
    half = np.searchsorted(curve.get_xdata(), 0.5)
    size = np.abs(new.torque(new.before))
    wanted = 100 * np.mean(size > curve.get_xdata()[half])
    assert curve.get_ydata()[half] == pytest.approx(wanted)
