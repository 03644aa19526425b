# ruff: noqa: TID251
"""Each figure shows the numbers of its table, in the paper's terms and with units."""

from dataclasses import replace

import matplotlib
import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import to_hex
from matplotlib.text import Text

from frictioncli.report import style
from frictioncli.report.correction_figures import corrected_friction_figure
from frictioncli.report.evaluation_figure import (
    error_figure,
    setting_text,
    shown_counts,
    uncertainty_text,
)
from frictioncli.report.figures import FIGURES
from frictioncli.report.labels import figure_text
from frictioncli.report.load_speed_figures import (
    friction_at_reference_temperature,
    load_figure,
    representative_pairs,
    speed_figure,
)
from frictioncli.report.residual_figure import residual_figure, residuals
from frictioncli.report.thermal_figures import (
    branch_means_figure,
    friction_temperature_figure,
    temperature_figure,
)

ENTRIES = {entry.name: entry for entry in FIGURES}


def data_lines(axes):
    """Lines that hold data, not the empty ones that stand for a legend entry."""
    return [line for line in axes.lines if len(line.get_xdata()) > 0]


def texts(figure):
    return [text.get_text() for text in figure.findobj(Text) if text.get_text()]


def at_zero_load(speed, temperature):
    """Equation (16) at L = 0 with the published parameters, written out by hand."""
    return 10.57 + (3.48 + 15.66 * np.exp(-0.056 * temperature)) * np.sqrt(speed)


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


def test_friction_is_carried_to_20_degrees_by_equation_15(two_runs):
    """40 N·m at 65 °C and 67.5 deg/s is 40 + 15.66 (e^-1.12 - e^-3.64) 8.2158 = 78.60 N·m."""
    one = two_runs.pairs.iloc[:1].assign(speed=67.5, temperature=65.0, friction_torque=40.0)
    carried = friction_at_reference_temperature(replace(two_runs, pairs=one))
    assert carried["carried"].iloc[0] == pytest.approx(78.60, abs=0.01)


def test_speed_figure_shows_all_speeds_and_the_model(two_runs):
    axes = speed_figure(two_runs).axes[0]
    means = next(line for line in axes.lines if line.get_label() == "mean of the pairs at a speed")
    np.testing.assert_allclose(
        sorted(means.get_xdata()), [2.3, 5, 10, 19.1, 30, 43, 67.5, 85, 101.2]
    )
    curve = next(line for line in axes.lines if line.get_label() == "model (16), L = 0")
    np.testing.assert_allclose(curve.get_ydata(), at_zero_load(np.asarray(curve.get_xdata()), 20))


@pytest.mark.parametrize("phase", ["heat-up", "cool-down"])
def test_every_correction_has_its_line_and_value(two_runs, phase):
    figure = corrected_friction_figure(two_runs, phase)
    schedule = two_runs.schedule
    own = schedule[(schedule["run"] == "day-1") & (schedule["phase"] == phase)]
    own = own.sort_values("time")
    tried = own[own["corrected"]]
    marks = [line for line in figure.axes[0].lines if len(set(line.get_xdata())) == 1]
    assert [line.get_xdata()[0] for line in marks] == pytest.approx(list(tried["time"] / 60))
    shown = texts(figure)
    for row in tried.itertuples():
        value = f"{row.temperature_correction:+.1f} °C".replace("-", "−")
        assert ("failed" if row.failed else value) in shown
    parameter = next(line for line in figure.axes[1].lines if line.get_label() == "T = Tm + ΔT")
    np.testing.assert_allclose(parameter.get_ydata(), own["temperature_parameter"])


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
    assert shown_counts(many) == list(range(1, 15))
    assert shown_counts(both) == [*range(1, 14), 40]


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


def test_residuals_vanish_where_the_model_holds(two_runs):
    torques = two_runs.torques
    exact = at_zero_load(torques["speed"], torques["motor_temperature"])
    exact = exact + 0.0014 * torques["load_torque"] ** 2
    ideal = replace(two_runs, torques=torques.assign(friction_torque=exact))
    np.testing.assert_allclose(residuals(ideal)["residual"], 0.0, atol=1e-9)
    measured = residuals(two_runs)
    np.testing.assert_allclose(
        measured["residual"], (torques["friction_torque"] - exact).to_numpy(), atol=1e-9
    )


@pytest.mark.parametrize("name", list(ENTRIES))
def test_axes_say_ampere_where_the_log_has_current(current_log, name):
    entry = ENTRIES[name]
    assert entry.missing(current_log) == ""
    figure = entry.draw(current_log)
    shown = " ".join(texts(figure))
    assert "N·m" not in shown
    assert ("[A]" in shown) == (name != "fig4")


@pytest.mark.parametrize("name", list(ENTRIES))
def test_axes_have_units_and_text_is_readable(current_log, name):
    with style.style_context():
        figure = ENTRIES[name].draw(current_log)
    labels = [axes.get_ylabel() for axes in figure.axes] + [
        axes.get_xlabel() for axes in figure.axes
    ]
    for label in filter(None, labels):
        assert "[" in label or label.startswith("number of corrections"), label
    assert min(text.get_fontsize() for text in figure.findobj(Text)) >= 9


def test_a_speed_has_one_colour_in_all_figures(two_runs):
    wanted = two_runs.style(67.5).colour
    for draw in (
        load_figure,
        branch_means_figure,
        lambda r: friction_temperature_figure(r, "motor"),
        lambda r: corrected_friction_figure(r, "cool-down"),
    ):
        figure = draw(two_runs)
        named = [t for t in figure.findobj(Text) if t.get_text().startswith("67.5 deg/s")]
        assert {to_hex(text.get_color()) for text in named} == {wanted}
    labelled = [
        line
        for axes in residual_figure(two_runs).axes
        for line in axes.lines
        if line.get_label() == "67.5 deg/s"
    ]
    assert [to_hex(line.get_color()) for line in labelled] == [wanted]


def test_speeds_differ_in_colour(two_runs):
    colours = [look.colour for look in two_runs.styles.values()]
    assert len(set(colours)) == len(colours)


@pytest.mark.parametrize("name", ["fig4", "fig5", "fig6", "fig7", "fig9", "fig10", "fig11"])
def test_without_temperature_there_is_a_statement(without_temperature, name):
    missing = ENTRIES[name].missing(without_temperature)
    assert "temperature" in missing
    assert "It needs a channel" in missing


def test_without_temperature_speed_is_drawn_as_measured(without_temperature):
    carried = friction_at_reference_temperature(without_temperature)
    assert (carried["carried"] == carried["friction_torque"]).all()
    assert "could not be carried" in ENTRIES["fig8"].caption(without_temperature)
    speed_figure(without_temperature)


def test_without_a_schedule_the_statement_names_the_command(two_runs):
    bare = replace(
        two_runs, schedule=two_runs.schedule.iloc[:0], evaluation=two_runs.evaluation.iloc[:0]
    )
    assert "frictioncli simulate" in ENTRIES["fig9"].missing(bare)
    assert "frictioncli evaluate" in ENTRIES["fig11"].missing(bare)


def test_sweep_alone_has_no_phases(two_runs):
    pairs = two_runs.pairs[two_runs.pairs["phase"] == "sweep"]
    sweep = replace(two_runs, pairs=pairs)
    assert "no heating or cooling phase" in ENTRIES["fig5"].missing(sweep)
    assert ENTRIES["fig8"].missing(sweep) == ""


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


def test_names_are_drawn_as_they_are():
    assert figure_text("a$b") == r"a\$b"
    assert figure_text("x\x01日") == "x??"
    assert len(figure_text("n" * 500)) == 32


def test_drawing_leaves_global_settings_alone(two_runs):
    before = dict(matplotlib.rcParams)
    with style.style_context("salt"):
        ENTRIES["fig5"].draw(two_runs)
    assert dict(matplotlib.rcParams) == before


def test_caption_tells_how_far_friction_falls(current_log):
    """The made pairs at 101.2 deg/s: coldest while cooling ends, hottest while it begins."""
    own = current_log.thermal_pairs
    own = own[own["speed"] == 101.2]
    cold = own.loc[own["motor_temperature"].idxmin(), "friction_torque"]
    hot = own.loc[own["motor_temperature"].idxmax(), "friction_torque"]
    caption = ENTRIES["fig5"].caption(current_log)
    assert f"At 101.2 deg/s it is {cold:.1f} A at 26 °C and {hot:.1f} A at 64 °C" in caption


def test_residuals_need_the_temperature_of_the_model(two_runs):
    unknown = replace(two_runs, pairs=two_runs.pairs.assign(temperature=np.nan))
    assert "motor temperature Tm, which no pair has" in ENTRIES["residuals"].missing(unknown)
