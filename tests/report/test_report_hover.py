"""Values that figures tell: titles of the points they belong to, and no wrong ones."""

import re
import xml.etree.ElementTree as ElementTree

import numpy as np

from frictioncli.report.epsilon_figures import error_against_corrections
from frictioncli.report.load_and_speed import at_reference_temperature, friction_against_speed
from frictioncli.report.style import panels, styled, svg
from frictioncli.report.tooltips import tell


def drawn(figure, name="figure"):
    with styled(name):
        return svg(figure, name, "title")


def titles(text):
    ElementTree.fromstring(text)
    return re.findall(r"<title>([^<]*)</title>", text)


def test_each_marker_gets_its_own_text():
    figure, (axes,) = panels(1, height=3.0)
    (line,) = axes.plot([0, 1, 2], [5, 3, 4], "o")
    tell(line, ["a < b", 'second "quoted"', "third & last"])
    text = drawn(figure)
    assert titles(text) == ["a &lt; b", 'second "quoted"', "third &amp; last"]
    markers = re.findall(r'<use [^>]*y="([\d.]+)"[^>]*><title>([^<]*)', text)
    heights = {title: float(y) for y, title in markers}
    # SVG counts downwards: 5 is the highest, 3 the lowest
    assert heights["a &lt; b"] < heights["third &amp; last"] < heights['second "quoted"']


def test_a_marker_that_is_not_drawn_takes_no_others_text():
    figure, (axes,) = panels(1, height=3.0)
    (line,) = axes.plot([0, 1, 2], [5, np.nan, 4], "o")
    tell(line, ["first", "second", "third"])
    text = drawn(figure)
    assert titles(text) == []
    assert "told" not in text


def test_bars_tell_their_error(two_runs):
    """The made evaluation has 4/n and 5/n at n corrections, 1.3 times that equally spaced."""
    with styled():
        found = titles(drawn(error_against_corrections(two_runs)))
    assert found.count("heating, 6 corrections: ε = 0.667 N·m") == 2
    assert found.count("cooling, 14 corrections: ε = 0.357 N·m") == 2
    assert found.count("equally spaced, heating, 2 corrections: ε = 2.60 N·m") == 2


def test_points_of_figure_8_tell_friction(two_runs):
    with styled():
        found = titles(drawn(friction_against_speed(two_runs)))
    carried = at_reference_temperature(two_runs)
    assert len(found) == len(carried)
    slow = carried[carried["speed"] == 2.3]["carried"].iloc[0]
    assert f"2.3 deg/s: {slow:.1f} N·m" in found
