"""Runs of several folders in the order of time, and what cannot be compared."""

from dataclasses import replace
from datetime import datetime, timedelta

import numpy as np
import pytest

from frictioncli.comparison.days import Folder, distinct_names, in_order
from frictioncli.errors import NotEnoughData, OptionError
from frictioncli.model.fitting import fit_joint
from frictioncli.model.settings import FitSettings
from tests.equation_16 import daily_torques

MONDAY = datetime(2026, 1, 5, 8)


@pytest.fixture(scope="module")
def table():
    return daily_torques(3)


@pytest.fixture(scope="module")
def model(table):
    return fit_joint(table, {}, FitSettings())


def folder(name, rows, model, *, days=None, ambient=None):
    begun = {run: MONDAY + timedelta(days=day) for run, day in (days or {}).items()}
    return Folder(name=name, torques=rows, model=model, begun=begun, ambient=ambient or {})


def part(table, run):
    return table[table["run"] == run]


def test_dates_decide_the_order_and_the_distance(table, model):
    late = folder("late", part(table, "d01"), model, days={"d01": 28})
    early = folder("early", part(table, "d02"), model, days={"d02": 0})
    found = in_order([late, early])
    assert found.dated
    assert [day.label for day in found.days] == ["early", "late"]
    assert found.folders == ("early", "late")
    np.testing.assert_allclose(found.time, [0.0, 28.0])


def test_without_a_date_the_order_is_the_one_given(table, model):
    one = folder("b", part(table, "d01"), model, days={"d01": 28})
    two = folder("a", part(table, "d02"), model)
    found = in_order([one, two])
    assert not found.dated
    assert [day.label for day in found.days] == ["b", "a"]
    np.testing.assert_allclose(found.time, [0.0, 1.0])


def test_equal_dates_are_no_dates(table, model):
    same = {"d01": 0, "d02": 0, "d03": 0}
    assert not in_order([folder("all", table, model, days=same)]).dated


def test_runs_of_a_folder_follow_each_other_in_natural_order(table, model):
    names = {"d01": "day2", "d02": "day10", "d03": "day1"}
    renamed = table.assign(run=table["run"].map(names))
    found = in_order([folder("all", renamed, model)])
    assert [day.label for day in found.days] == ["day1", "day2", "day10"]
    # the rows of each run keep together under its number
    first = found.torques[found.torques["run"] == "0"]["friction_torque"].to_numpy()
    np.testing.assert_array_equal(first, part(table, "d03")["friction_torque"].to_numpy())


def test_the_manifest_tells_the_surroundings_before_the_log_does(table, model):
    told = folder("all", table, model, ambient={"d01": 12.0, "d02": 15.0, "d03": 20.0})
    assert in_order([told]).surroundings_from == "manifest"
    np.testing.assert_allclose(in_order([told]).surroundings, [12.0, 15.0, 20.0])
    untold = in_order([folder("all", table, model, ambient={"d01": 12.0})])
    assert untold.surroundings_from == "lowest motor temperature"
    np.testing.assert_allclose(untold.surroundings, 22.0)


@pytest.mark.parametrize(
    ("attribute", "value", "said"),
    [
        ("joint", 3, "joint 3, expected 2"),
        ("torque_unit", "A", "torques in A, expected N·m"),
        ("torque_side", "motor", "side of the motor, expected joint"),
        ("temperature", "mean", "temperature mean, expected motor"),
    ],
)
def test_what_is_not_the_same_joint_is_refused(table, model, attribute, value, said):
    one = folder("one", part(table, "d01"), model)
    two = folder("two", part(table, "d02"), replace(model, **{attribute: value}))
    with pytest.raises(OptionError, match=f"two: .*{said}"):
        in_order([one, two])


def test_a_run_named_twice_is_refused(table, model):
    one = folder("one", part(table, "d01"), model)
    copy = folder("copy", part(table, "d01").assign(run="other"), model)
    with pytest.raises(
        OptionError, match=r"copy, run other: the same measurements as one, run d01"
    ):
        in_order([one, copy])


def test_one_run_is_not_enough(table, model):
    with pytest.raises(NotEnoughData, match="one run only"):
        in_order([folder("one", part(table, "d01"), model)])


def test_names_are_as_short_as_they_can_be():
    assert distinct_names(["/a/x", "/a/y"]) == ["x", "y"]
    assert distinct_names(["/a/run", "/b/run", "/b/walk"]) == ["a/run", "b/run", "b/walk"]
    with pytest.raises(OptionError, match="named twice"):
        distinct_names(["/a/x", "/a/x"])
