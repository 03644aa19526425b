"""The recommended setting of the corrections, on phases with known errors."""

from dataclasses import replace

import numpy as np
import pytest

from frictioncli.report.grid_replay import Events, ReplayedPhase
from frictioncli.report.recommendation import recommended_setting
from frictioncli.report.target_error import target_error, target_text

TARGET = 2.0


def phase(uncorrected, errors, counts):
    nothing = np.zeros(0)
    return ReplayedPhase(
        run="day-1",
        name="heat-up",
        delta=0.05,
        time=nothing,
        speed=nothing,
        temperature=nothing,
        term=nothing,
        error=nothing,
        uncorrected=uncorrected,
        epsilon=np.array(errors),
        events=tuple(
            Events(time=np.zeros(n), correction=np.zeros(n), failed=np.zeros(n, bool))
            for n in counts
        ),
    )


def test_the_fewest_corrections_that_reach_the_target_in_every_phase():
    heating = phase(7.0, [0.5, 1.9, 1.8, 3.0], [20, 8, 8, 3])
    cooling = phase(6.0, [0.4, 1.5, 1.7, 1.9], [20, 7, 7, 3])
    # the last reaches it in cooling only; of the two with 15 the third has the smaller worst error
    assert recommended_setting([heating, cooling], TARGET) == 2


def test_no_correction_where_the_target_is_reached_without():
    assert recommended_setting([phase(1.9, [0.1], [5])], TARGET) is None
    assert recommended_setting([phase(2.1, [0.1], [5])], TARGET) == 0


def test_the_smallest_error_where_no_setting_reaches_the_target():
    assert recommended_setting([phase(9.0, [4.0, 3.0, 8.0], [5, 9, 3])], TARGET) == 1


def test_no_correction_where_all_settings_make_it_worse():
    assert recommended_setting([phase(3.0, [3.5, 4.0], [5, 9])], TARGET) is None


@pytest.mark.parametrize(
    ("unit", "friction", "target", "text"),
    [
        ("N·m", 60.0, 2.0, "2 N·m, as in the paper"),
        ("N·m", 2.5, 0.1, "0.1 N·m, 4 % of the mean friction"),
        ("A", 60.0, 2.4, "2.4 A, 4 % of the mean friction"),
    ],
)
def test_the_target_is_small_beside_the_friction(two_runs, unit, friction, target, text):
    rows = two_runs.torques.assign(friction_torque=friction)
    model = replace(two_runs.model, torque_unit=unit)
    joint = replace(two_runs, torques=rows, model=model)
    assert target_error(joint) == pytest.approx(target)
    assert target_text(joint) == text
