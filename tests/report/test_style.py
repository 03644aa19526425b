# ruff: noqa: TID251
"""Style of the figures: colours, labels, and no change of global settings."""

import matplotlib
import pytest

from frictioncli.report import style
from tests.report.figure_contents import FIGURE_SPECS


def test_labels_are_moved_apart_and_keep_their_order():
    with style.style_context():
        _, (axes,) = style.panels(1, height=3.0)
        axes.plot([0, 1], [0, 100])
        style.label_right(axes, [(50.1, "b", "k"), (50.0, "a", "k"), (50.2, "c", "k")], height=3.0)
    places = {text.get_text(): text.xyann[1] for text in axes.texts}
    gap = 110 * 0.18 / 3.0
    assert places["b"] - places["a"] == pytest.approx(gap)
    assert places["c"] - places["b"] == pytest.approx(gap)
    assert places["b"] == pytest.approx(50.1)


def test_drawing_leaves_global_settings_alone(two_runs):
    before = dict(matplotlib.rcParams)
    with style.style_context("salt"):
        FIGURE_SPECS["fig5"].draw(two_runs)
    assert dict(matplotlib.rcParams) == before


def test_speeds_differ_in_colour(two_runs):
    colours = [look.colour for look in two_runs.styles.values()]
    assert len(set(colours)) == len(colours)
