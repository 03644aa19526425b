"""Courses over the runs and their attribution to effects."""

import numpy as np
import pytest

from frictioncli.comparison.causes import cause_of, reconcile_channels, time_courses
from frictioncli.comparison.day_to_day import LevelModel

TIME = np.arange(10.0)
QUIET = LevelModel.of(np.zeros((10, 10)), np.zeros(10), 0.3)


def cause_at(levels, channel="friction", model=QUIET):
    return cause_of(np.asarray(levels, dtype=float), model, TIME, channel)


def test_every_course_goes_from_nothing_to_the_whole_change():
    found = list(time_courses(np.array([0.0, 3.0, 4.0, 9.0])))
    assert {course.effect for course in found} == {"drift", "step_change", "run_in"}
    for course in found:
        assert course.values[0] == pytest.approx(0.0)
        assert course.values[-1] == pytest.approx(1.0)


def test_a_line_is_a_drift():
    found = cause_at(np.linspace(0, 6, 10))
    assert found.effects == ("drift",)
    assert found.change.value == pytest.approx(6.0)
    assert found.change_point is None


def test_a_jump_is_a_step_with_its_change_point():
    found = cause_at([0, 0.1, -0.1, 0, 5, 5.1, 4.9, 5, 5.1, 4.9])
    assert found.effects == ("step_change",)
    assert found.change_point == 4
    assert found.change.value == pytest.approx(5.0, abs=0.1)


def test_a_fall_that_slows_down_is_running_in_and_a_rise_is_not():
    course = -6 * np.expm1(-4 * TIME / 9) / np.expm1(-4)
    assert cause_at(course).effects == ("run_in",)
    assert "run_in" not in cause_at(-course).probabilities


def test_two_runs_cannot_tell_a_drift_from_a_step():
    model = LevelModel.of(np.zeros((2, 2)), np.zeros(2), 0.3)
    found = cause_of(np.array([0.0, 6.0]), model, np.array([0.0, 90.0]), "friction")
    assert set(found.effects) == {"drift", "step_change"}
    assert found.probabilities["drift"] == pytest.approx(0.5)
    assert found.change_point is None


def test_a_load_that_jumps_is_a_payload():
    found = cause_at([0, 0, 0, 20, 20, 20, 20, 20, 20, 20], "load")
    assert found.effects == ("payload_change",)
    assert found.change_point == 3


def test_the_same_share_in_both_is_the_scale_of_the_torque():
    friction, load = cause_at(np.linspace(0, 5, 10)), cause_at(np.linspace(0, 5.3, 10), "load")
    (cause,) = reconcile_channels(friction, load)
    assert cause.effects == ("torque_constant",)
    assert "scale of the logged torque" in cause.claim


def test_other_shares_are_two_causes():
    friction, load = cause_at(np.linspace(0, 5, 10)), cause_at(np.linspace(0, 30, 10), "load")
    assert reconcile_channels(friction, load) == (friction, load)
    assert reconcile_channels(friction, None) == (friction,)
    assert reconcile_channels(None, None) == ()
