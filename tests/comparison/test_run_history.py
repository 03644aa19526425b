"""Runs of several folders in the order of time, and folders that cannot be compared."""

from dataclasses import replace
from datetime import datetime, timedelta

import numpy as np
import pytest

from frictioncli.comparison.run_history import ComparedFolder, distinct_names, run_history_of
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
    started_at = {run: MONDAY + timedelta(days=day) for run, day in (days or {}).items()}
    return ComparedFolder(
        name=name, torques=rows, model=model, started_at=started_at, ambient=ambient or {}
    )


def part(table, run):
    return table[table["run"] == run]


def test_dates_decide_the_order_and_the_distance(table, model):
    late = folder("late", part(table, "d01"), model, days={"d01": 28})
    early = folder("early", part(table, "d02"), model, days={"d02": 0})
    found = run_history_of([late, early])
    assert found.dated
    assert [run.label for run in found.runs] == ["early", "late"]
    assert found.folders == ("early", "late")
    np.testing.assert_allclose(found.time, [0.0, 28.0])


def test_without_a_date_the_order_is_the_one_given(table, model):
    one = folder("b", part(table, "d01"), model, days={"d01": 28})
    two = folder("a", part(table, "d02"), model)
    found = run_history_of([one, two])
    assert not found.dated
    assert [run.label for run in found.runs] == ["b", "a"]
    np.testing.assert_allclose(found.time, [0.0, 1.0])


def test_equal_dates_are_no_dates(table, model):
    same = {"d01": 0, "d02": 0, "d03": 0}
    assert not run_history_of([folder("all", table, model, days=same)]).dated


def test_runs_of_a_folder_follow_each_other_in_natural_order(table, model):
    names = {"d01": "day2", "d02": "day10", "d03": "day1"}
    renamed = table.assign(run=table["run"].map(names))
    found = run_history_of([folder("all", renamed, model)])
    assert [run.label for run in found.runs] == ["day1", "day2", "day10"]
    # the rows of each run keep together under its number
    first = found.torques[found.torques["run"] == "0"]["friction_torque"].to_numpy()
    np.testing.assert_array_equal(first, part(table, "d03")["friction_torque"].to_numpy())


def test_the_ambient_temperature_of_the_manifest_comes_first(table, model):
    stated = folder("all", table, model, ambient={"d01": 12.0, "d02": 15.0, "d03": 20.0})
    assert run_history_of([stated]).ambient_source == "manifest"
    np.testing.assert_allclose(run_history_of([stated]).ambient, [12.0, 15.0, 20.0])
    unstated = run_history_of([folder("all", table, model, ambient={"d01": 12.0})])
    assert unstated.ambient_source == "lowest motor temperature"
    np.testing.assert_allclose(unstated.ambient, 22.0)


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
        run_history_of([one, two])


def test_a_run_named_twice_is_refused(table, model):
    one = folder("one", part(table, "d01"), model)
    copy = folder("copy", part(table, "d01").assign(run="other"), model)
    with pytest.raises(
        OptionError, match=r"copy, run other: the same measurements as one, run d01"
    ):
        run_history_of([one, copy])


def test_one_run_is_not_enough(table, model):
    with pytest.raises(NotEnoughData, match="one run only"):
        run_history_of([folder("one", part(table, "d01"), model)])


def test_names_are_as_short_as_they_can_be():
    assert distinct_names(["/a/x", "/a/y"]) == ["x", "y"]
    assert distinct_names(["/a/run", "/b/run", "/b/walk"]) == ["a/run", "b/run", "b/walk"]
    with pytest.raises(OptionError, match="named twice"):
        distinct_names(["/a/x", "/a/x"])
