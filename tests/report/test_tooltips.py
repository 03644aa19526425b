"""Values that figures set_tooltips: titles of the points they belong to, and no wrong ones."""

import re
import xml.etree.ElementTree as ElementTree

import numpy as np

from frictioncli.report.evaluation_figure import error_figure
from frictioncli.report.figure_files import svg
from frictioncli.report.load_speed_figures import friction_at_reference_temperature, speed_figure
from frictioncli.report.style import panels, style_context
from frictioncli.report.tooltips import set_tooltips


def drawn(figure, name="figure"):
    with style_context(name):
        return svg(figure, name, "title")


def titles(text):
    ElementTree.fromstring(text)
    return re.findall(r"<title>([^<]*)</title>", text)


def test_each_marker_gets_its_own_text():
    figure, (axes,) = panels(1, height=3.0)
    (line,) = axes.plot([0, 1, 2], [5, 3, 4], "o")
    set_tooltips(line, ["a < b", 'second "quoted"', "third & last"])
    text = drawn(figure)
    assert titles(text) == ["a &lt; b", 'second "quoted"', "third &amp; last"]
    markers = re.findall(r'<use [^>]*y="([\d.]+)"[^>]*><title>([^<]*)', text)
    heights = {title: float(y) for y, title in markers}
    # SVG counts downwards: 5 is the highest, 3 the lowest
    assert heights["a &lt; b"] < heights["third &amp; last"] < heights['second "quoted"']


def test_a_marker_that_is_not_drawn_takes_no_others_text():
    figure, (axes,) = panels(1, height=3.0)
    (line,) = axes.plot([0, 1, 2], [5, np.nan, 4], "o")
    set_tooltips(line, ["first", "second", "third"])
    text = drawn(figure)
    assert titles(text) == []
    assert "tooltips" not in text


def test_bars_tell_their_error(two_runs):
    """The made evaluation has 4/n and 5/n at n corrections, 1.3 times that equally spaced."""
    with style_context():
        found = titles(drawn(error_figure(two_runs)))
    assert found.count("heating, 6 corrections: ε = 0.667 N·m") == 2
    assert found.count("cooling, 14 corrections: ε = 0.357 N·m") == 2
    assert found.count("equally spaced, heating, 2 corrections: ε = 2.60 N·m") == 2


def test_points_of_figure_8_tell_friction(two_runs):
    with style_context():
        found = titles(drawn(speed_figure(two_runs)))
    carried = friction_at_reference_temperature(two_runs)
    assert len(found) == len(carried)
    slow = carried[carried["speed"] == 2.3]["carried"].iloc[0]
    assert f"2.3 deg/s: {slow:.1f} N·m" in found
