# ruff: noqa: TID251
"""The figure of a cause shows residuals, the fitted term and probabilities."""

import numpy as np
import pytest
from matplotlib.container import ErrorbarContainer

from frictioncli.report import style
from frictioncli.report.evidence_figure import evidence_figure, shown_probabilities
from tests.report.diagnosis_documents import SHIFT, stribeck_term
from tests.report.figure_contents import texts


def points_of(panel):
    """Heights of all points with error bars."""
    return np.concatenate(
        [bars[0].get_ydata() for bars in panel.containers if isinstance(bars, ErrorbarContainer)]
    )


def test_evidence_shows_residuals_the_term_and_what_is_left(diagnosed, diagnosis):
    with style.style_context():
        figure = evidence_figure(diagnosed, diagnosis=diagnosis, index=0)
    left, middle, right, bars = figure.axes
    table, raw = diagnosis.seen.problem.table, diagnosis.seen.before["friction"]
    curves = [
        line
        for line in middle.lines
        if line.get_marker() == "None" and len(set(np.asarray(line.get_ydata()))) > 1
    ]
    assert curves
    for curve in curves:
        np.testing.assert_allclose(curve.get_ydata(), stribeck_term(np.asarray(curve.get_xdata())))
    slowest = raw[table.speed == table.speed.min()].mean()
    assert np.isclose(points_of(left), slowest).any()
    np.testing.assert_allclose(points_of(middle), points_of(left) - SHIFT, atol=1e-9)
    assert np.ptp(points_of(middle) - points_of(right)) > 1.0
    widths = [patch.get_width() for patch in bars.patches]
    np.testing.assert_allclose(widths, [97.0, 2.0, 1.0])
    assert bars.patches[0].get_facecolor() != bars.patches[1].get_facecolor()
    shown = texts(figure)
    assert "friction: measured − simulated [N·m]" in shown
    assert "speed |φ'| [deg/s]" in shown
    assert "probability [%]" in shown
    assert {"Stribeck friction", "drift", "all others"} <= set(shown)


def test_bars_show_the_whole_credible_set_first():
    shares = {"a": 0.3, "b": 0.25, "c": 0.2, "d": 0.1, "e": 0.06, "f": 0.05, "g": 0.03}
    shown = shown_probabilities(shares, ["a", "b", "c", "d", "e", "f", "g"])
    assert [name for name, _ in shown] == ["a", "b", "c", "d", "e", "f", "g", "all others"]
    assert shown[-1][1] == pytest.approx(0.01)
    assert shown_probabilities({"a": 0.01, "b": 0.99}, ["a"]) == [("a", 0.01), ("b", 0.99)]
