"""Numbers, intervals and lists as text."""

import math

from frictioncli.wording import interval_text, list_text, quantity_text


def test_long_lists_are_cut():
    assert list_text(["a"]) == "a"
    assert list_text(list("abcdefg")) == "a, b, c, d, e and 2 more"


def test_estimates_have_the_decimals_of_their_interval():
    assert quantity_text(1.04, (0.96, 1.12), "N·m") == "1.04 N·m (0.96 to 1.12)"
    assert quantity_text(412.3, (371.0, 455.0), "s") == "412 s (371 to 455)"
    assert quantity_text(-0.3, (-0.6, 0.04), "1") == "−0.3 (−0.6 to 0.0)"
    # a share of the width of its unit's last digit is no minus zero
    assert quantity_text(-0.01, (-0.4, 0.4), "A") == "0.0 A (−0.4 to 0.4)"


def test_what_is_not_known_is_not_stated():
    assert quantity_text(2.0, None, "deg/s") == "2.0 deg/s"
    assert quantity_text(2.0, (1.0, math.inf), "deg/s") == "2.0 deg/s"
    # a value on a bound has no width, and is not known exactly
    assert quantity_text(2.0, (2.0, 2.0), "A") == "2.0 A"


def test_short_times_are_in_milliseconds():
    assert quantity_text(0.012, (0.011, 0.013), "s") == "12.0 ms (11.0 to 13.0)"
    assert quantity_text(0.51, (0.3, 0.7), "s") == "0.5 s (0.3 to 0.7)"


def test_intervals_alone():
    assert interval_text(0.0123, 0.0456) == "0.012 to 0.046"
