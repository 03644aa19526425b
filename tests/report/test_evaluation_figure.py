"""Figure 11: error against the number of corrections."""

from dataclasses import replace

import numpy as np
import pandas as pd

from frictioncli.correction.evaluation import evaluation_text
from frictioncli.report.evaluation_figure import (
    counts_left_out,
    error_figure,
    error_per_count,
    setting_text,
    shown_counts,
    uncertainty_text,
)
from frictioncli.report.figures import FIGURES
from frictioncli.report.summary import corrections_needed
from tests.report.figure_contents import data_lines, texts


def test_bars_are_as_high_as_the_errors(two_runs):
    """The made errors are 4/n in heating and 5/n in cooling; equal: 1.3, uncertainty: 0.9 times."""
    axes, lowest = error_figure(two_runs).axes
    heating, cooling = axes.containers
    counts = np.array([2, 3, 6, 14, 25])
    np.testing.assert_allclose([bar.get_height() for bar in heating], 4 / counts)
    np.testing.assert_allclose([bar.get_height() for bar in cooling], 5 / counts)
    shown = ["0", "2", "3", "6", "14", "25"]
    assert [tick.get_text() for tick in lowest.get_xticklabels()] == shown
    equal, sure = (
        [line for line in data_lines(axes) if line.get_marker() == marker] for marker in "D^"
    )
    np.testing.assert_allclose(equal[0].get_ydata(), 1.3 * 4 / counts)
    np.testing.assert_allclose(sure[1].get_ydata(), 0.9 * 5 / np.array([1, 6, 14]))
    none = [line.get_ydata()[0] for line in data_lines(axes) if line.get_linestyle() == "--"]
    assert none == [4.0, 5.0]
    assert texts(axes.figure).count("1 failed") == 4


def test_of_many_counts_the_shared_and_then_the_lowest_are_shown(two_runs):
    row = two_runs.evaluation.iloc[[0]]
    many = row.loc[row.index.repeat(60)].assign(corrections=range(1, 61))
    both = pd.concat([many, row.assign(corrections=40, phase="cool-down")])
    assert shown_counts(many) == list(range(1, 17))
    assert shown_counts(both) == [*range(1, 16), 40]


def test_counts_without_room_are_told(two_runs):
    row = two_runs.evaluation[two_runs.evaluation["criterion"] == "first_degree"].iloc[[0]]
    many = row.loc[row.index.repeat(20)].assign(corrections=range(1, 21))
    results = replace(two_runs, evaluation=many)
    assert counts_left_out(results) == [17, 18, 19, 20]
    caption = next(figure for figure in FIGURES if figure.name == "fig11").caption(results)
    assert "Not drawn, for lack of room: 17, 18, 19 and 20 corrections." in caption
    assert "Not drawn" not in next(f for f in FIGURES if f.name == "fig11").caption(two_runs)


def test_one_convention_for_several_settings_of_one_number(two_runs):
    """The bar, the key number and the terminal take the median."""
    row = two_runs.evaluation[two_runs.evaluation["criterion"] == "first_degree"].iloc[[0]]
    errors = [1.0, 1.9, 9.0]
    rows = row.loc[row.index.repeat(3)].assign(epsilon=errors, corrections=5, run="day-1")
    assert error_per_count(rows)["epsilon"].tolist() == [1.9]
    none = two_runs.evaluation[two_runs.evaluation["criterion"] == "none"].iloc[[0]]
    table = pd.concat([rows, none.assign(run="day-1", phase=rows["phase"].iloc[0])])
    assert "5: 1.90" in evaluation_text(table, "N·m")
    small = table.assign(epsilon=table["epsilon"] / 1000)
    assert "5: 0.00190" in evaluation_text(small, "A")
    needed = corrections_needed(replace(two_runs, evaluation=table))
    assert needed is not None
    assert needed.value.startswith("5 in")
    worse = table.assign(epsilon=np.where(table["epsilon"] == 1.9, 2.1, table["epsilon"]))
    needed = corrections_needed(replace(two_runs, evaluation=worse))
    assert needed is not None
    assert needed.value.startswith("no number suffices")


def test_runs_share_the_counts_of_the_axis(two_runs):
    table = two_runs.evaluation
    fewer = table[(table["run"] == "day-1") | (table["corrections"] < 10)]
    upper, lower = error_figure(replace(two_runs, evaluation=fewer)).axes
    shown = ["0", "2", "3", "6", "14", "25"]
    assert [tick.get_text() for tick in lower.get_xticklabels()] == shown
    assert [len(bars) for bars in upper.containers] == [5, 5]
    assert [len(bars) for bars in lower.containers] == [3, 3]


def test_setting_is_told_in_minutes(two_runs):
    assert setting_text(two_runs) == "criterion “first degree”, k = 5, tmax = 60 min"
    assert setting_text(by_uncertainty(two_runs)) == "criterion “uncertainty”, bound = 2 N·m"


def by_uncertainty(results):
    """The same with a schedule by uncertainty."""
    told = {"criterion": "uncertainty", "k": np.nan, "tmax": np.nan, "bound": 2.0}
    return replace(results, schedule=results.schedule.assign(**told))


def test_a_simulated_bound_takes_the_bars_and_the_paper_the_marks(two_runs):
    axes, lowest = error_figure(by_uncertainty(two_runs)).axes
    heating, _ = axes.containers
    np.testing.assert_allclose(
        [bar.get_height() for bar in heating], 0.9 * 4 / np.array([1, 6, 14])
    )
    paper = [line for line in data_lines(axes) if line.get_marker() == "^"]
    np.testing.assert_allclose(paper[0].get_ydata(), 4 / np.array([2, 3, 6, 14, 25]))
    assert lowest.get_xlabel() == "number of corrections (uncertainty)"
    assert uncertainty_text(by_uncertainty(two_runs)).startswith("Bars: ")


def test_the_caption_says_what_the_paper_s_bound_reaches(two_runs):
    text = uncertainty_text(two_runs)
    assert text.startswith("Triangles: ")
    assert text.endswith(
        "with 2 N·m, heating 6 corrections, ε 0.600 N·m; cooling 6 corrections, ε 0.750 N·m."
    )
    without = two_runs.evaluation[two_runs.evaluation["criterion"] != "uncertainty"]
    assert uncertainty_text(replace(two_runs, evaluation=without)) == ""
