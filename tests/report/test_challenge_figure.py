"""Pictures of planted effects: the share found with its interval, and what is drawn of it."""

import pandas as pd
import pytest

from frictioncli.report.challenge_figure import challenge_figure, found_shares

NAN = float("nan")


def rows(sizes, found, **columns):
    table = {
        "effect": "stribeck",
        "unit": "A",
        "status": "done",
        "size": sizes,
        "right_in_set": found,
        "right_alone": False,
        "wrong": "",
        "claimed": 0.5,
        "size_found_low": NAN,
        "size_found_high": NAN,
    }
    return pd.DataFrame(table | columns)


def test_intervals_of_the_chance_are_those_of_the_literature():
    """Values of Wilson's interval for 1 of 1, 0 of 1 and 8 of 10."""
    one, none, many = found_shares(
        rows([1.0, 2.0] + [4.0] * 10, [True, False] + [True] * 8 + [False] * 2)
    )
    assert (one.trials, one.found) == (1, 1)
    assert (one.low, one.high) == pytest.approx((0.2065, 1.0), abs=1e-3)
    assert (none.low, none.high) == pytest.approx((0.0, 0.7935), abs=1e-3)
    assert (many.low, many.high) == pytest.approx((0.4902, 0.9433), abs=1e-3)


def test_sizes_that_are_nearly_the_same_are_one():
    shares = found_shares(rows([1.0, 1.05, 2.0], [True, False, True]))
    assert [one.trials for one in shares] == [2, 1]
    assert shares[0].size == pytest.approx((1.0 * 1.05) ** 0.5)


def test_the_figure_shows_each_trial_the_claim_and_the_size_found():
    table = rows([0.5, 1.0, 2.0], [False, True, True])
    table["right_alone"] = [False, False, True]
    table["wrong"] = ["drift", "", ""]
    table["size_found_low"], table["size_found_high"] = 0.5, 1.0
    panel = challenge_figure(table).axes[0]
    labels = {text.get_text() for text in panel.get_legend().get_texts()}
    assert {"named", "named in a set", "not named", "another name, wrong", "claimed"} <= labels
    marks = {line.get_label(): line.get_xydata().tolist() for line in panel.lines}
    assert marks["named"] == [[2.0, 1.0]]
    assert marks["named in a set"] == [[1.0, 1.0]]
    assert marks["not named"] == [[0.5, 0.0]]
    assert marks["another name, wrong"] == [[0.5, 0.0]]
    assert panel.get_xlabel().endswith("[A]")


def test_one_refused_size_among_others_is_left_out():
    table = rows([0.5, NAN], [True, False])
    table.loc[1, "status"] = "cannot"
    panel = challenge_figure(table).axes[0]
    assert "not named" not in {text.get_text() for text in panel.get_legend().get_texts()}
