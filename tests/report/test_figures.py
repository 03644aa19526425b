# ruff: noqa: TID251
"""All figures: units on the axes, readable text, one colour per speed, captions."""

import pytest
from matplotlib.colors import rgb_to_hsv, to_hex, to_rgb
from matplotlib.text import Text

from frictioncli.report import style
from frictioncli.report.correction_figures import corrected_friction_figure
from frictioncli.report.load_speed_figures import (
    load_figure,
)
from frictioncli.report.residual_figure import residual_figure
from frictioncli.report.thermal_figures import (
    branch_means_figure,
    friction_temperature_figure,
)
from frictioncli.wording import number_text
from tests.report.figure_contents import FIGURE_SPECS, texts


@pytest.mark.parametrize("name", list(FIGURE_SPECS))
def test_axes_say_ampere_where_the_log_has_current(current_log, name):
    entry = FIGURE_SPECS[name]
    assert entry.missing(current_log) == ""
    figure = entry.draw(current_log)
    shown = " ".join(texts(figure))
    assert "N·m" not in shown
    assert ("[A]" in shown) == (name != "fig4")


@pytest.mark.parametrize("name", list(FIGURE_SPECS))
def test_axes_have_units_and_text_is_readable(current_log, name):
    with style.style_context():
        figure = FIGURE_SPECS[name].draw(current_log)
    labels = [axes.get_ylabel() for axes in figure.axes] + [
        axes.get_xlabel() for axes in figure.axes
    ]
    for label in filter(None, labels):
        assert "[" in label or label.startswith("number of corrections"), label
    assert min(text.get_fontsize() for text in figure.findobj(Text)) >= 9


def test_a_speed_has_one_colour_in_all_figures(two_runs):
    wanted = two_runs.style(67.5).colour
    seen = set()
    for draw in (
        load_figure,
        branch_means_figure,
        lambda r: friction_temperature_figure(r, "motor"),
        lambda r: corrected_friction_figure(r, "cool-down"),
    ):
        figure = draw(two_runs)
        named = [t for t in figure.findobj(Text) if t.get_text().startswith("67.5 deg/s")]
        assert named
        seen |= {to_hex(text.get_color()) for text in named}
    # labels are darker than marks, at the same hue
    (label,) = seen
    hues = [rgb_to_hsv(to_rgb(colour))[0] for colour in (label, wanted)]
    assert hues[0] == pytest.approx(hues[1], abs=0.01)
    labelled = [
        line
        for axes in residual_figure(two_runs).axes
        for line in axes.lines
        if line.get_label() == "67.5 deg/s"
    ]
    assert [to_hex(line.get_color()) for line in labelled] == [wanted]


def test_caption_tells_how_far_friction_falls(current_log):
    """The made pairs at 101.2 deg/s: coldest when heating begins, hottest when it ends."""
    own = current_log.thermal_pairs
    own = own[(own["speed"] == 101.2) & (own["phase"] == "heat-up")]
    cold = own.loc[own["motor_temperature"].idxmin(), "friction_torque"]
    hot = own.loc[own["motor_temperature"].idxmax(), "friction_torque"]
    caption = FIGURE_SPECS["fig5"].caption(current_log)
    assert f"At 101.2 deg/s, day-1, heating: {cold:.1f} A at" in caption
    assert f" °C, {hot:.1f} A at " in caption


def test_captions_of_two_days_never_join_them(two_runs):
    """Coldest and hottest pair are those of one run while it heats, for each run."""
    caption = FIGURE_SPECS["fig5"].caption(two_runs)
    for run in two_runs.runs:
        own = two_runs.thermal_pairs[two_runs.thermal_pairs["run"] == run]
        own = own[(own["speed"] == 101.2) & (own["phase"] == "heat-up")]
        own = own.sort_values("motor_temperature")
        cold, hot = own.iloc[0], own.iloc[-1]
        assert (
            f"{run}, heating: {number_text(cold['friction_torque'])} N·m at"
            f" {cold['motor_temperature']:.0f} °C, {number_text(hot['friction_torque'])} N·m at"
            f" {hot['motor_temperature']:.0f} °C" in caption
        )
