"""Figures and words on planted effects, from rows made by hand."""

import pandas as pd
import pytest

from frictioncli.challenge_schema import CHALLENGE
from frictioncli.report.challenge_section import planted_text
from frictioncli.report.challenge_words import (
    can_show,
    claim_ratios,
    found_text,
    mark,
    summary,
)

ROW = {column.name: None for column in CHALLENGE.columns} | {
    "joint": 1,
    "effect": "drift",
    "seed": 0,
    "purpose": "share",
    "status": "done",
    "unit": "A",
    "asked": 1.0,
    "size": 1.0,
    "share": 0.1,
    "claimed": 0.5,
    "names": "",
    "structure": "",
    "already": False,
    "right_in_set": False,
    "right_alone": False,
    "wrong": "",
}
FOUND = {"right_in_set": True, "right_alone": True, "names": "drift"}


def row(**changes):
    return ROW | changes


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({}, "not found"),
        ({"claimed": 1.5}, "not found, below the size claimed"),
        (FOUND, "found"),
        (FOUND | {"right_alone": False}, "found in a set"),
        (FOUND | {"already": True}, "already there"),
        (FOUND | {"wrong": "inertia"}, "found, WRONG: inertia"),
        ({"status": "cannot"}, "not visible in these data"),
    ],
)
def test_outcome_in_words(changes, told):
    assert mark(row(**changes)) == told


@pytest.mark.parametrize(
    ("low", "high", "told"),
    [
        (None, None, ""),
        (1.0, 1.25, "1 to 1.2"),
        (None, 0.5, "below 0.5"),
        (3.0, None, "above 3"),
    ],
)
def test_least_size_in_words(low, high, told):
    assert found_text(row(size_found_low=low, size_found_high=high)) == told


def test_shares_count_what_the_log_can_show_and_has_not_already():
    rows = [
        row(**FOUND),
        row(),
        row(claimed=2.0),
        row(**FOUND, already=True),
        row(status="cannot", size=None),
        row(**FOUND, purpose="search", wrong="inertia"),
        row(purpose="as_logged", effect="none"),
    ]
    assert [can_show(one) for one in rows[:3]] == [True, True, False]
    told = summary(rows)
    assert told[0].startswith("found at the usual size: 1 of 2 effects")
    assert told[1] == "trials with a wrong new name: 1 of 5 trials"


def test_claims_are_compared_with_the_size_found_and_fail_where_none_was():
    rows = [
        row(size_found=0.4, size_found_low=0.35, size_found_high=0.45),
        row(effect="inertia", size_found=None, size_found_low=4.0),
        row(effect="stribeck"),
    ]
    assert claim_ratios(rows) == pytest.approx({"drift": 1.25, "inertia": 0.0})
    told = summary(rows)[-1]
    assert "the size found: 1 of 2 effects" in told
    # one shape may be much easier or harder than four of five
    assert told.endswith("(of 1 shape; it is claimed for four of five, try --draws 5)")


def test_of_several_shapes_the_size_counts_at_which_four_of_five_are_found():
    sizes = [0.4, 0.1, None, 0.25, 0.2]
    rows = [row(seed=seed, size_found=size, size_found_low=0.05) for seed, size in enumerate(sizes)]
    assert claim_ratios(rows) == pytest.approx({"drift": 0.5 / 0.4})
    assert summary(rows)[-1].endswith("1 of 1 effect")
    rows[0]["size_found"] = None
    assert claim_ratios(rows) == {"drift": 0.0}


def test_the_page_has_no_part_without_planted_effects_and_marks_wrong_names():
    assert planted_text(pd.DataFrame()).table is None
    rows = pd.DataFrame(
        [row(purpose="as_logged", effect="none"), row(**FOUND), row(wrong="inertia")]
    )
    table = planted_text(rows).table
    assert table.marked == (1,)
    assert table.rows[0][:3] == ("drift", "drift", "found")
    assert table.rows[1][3:5] == ("1.00 A", "0.50 A")
