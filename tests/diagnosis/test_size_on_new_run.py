"""A step that the base absorbs on the first day is named by what it leaves of the second one."""

import numpy as np
import pytest

from frictioncli.diagnosis.diagnose import diagnose_joint
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.simulator.settings import SynthesisSettings
from tests.diagnosis.rules_of_names import keeps_the_rules
from tests.simulation.changed_table import hours, with_friction_step
from tests.simulation.torque_table import simulate_torques

pytestmark = pytest.mark.slow

MARGIN = 0.6
"""More than the base surely leaves of 1.8 N·m on the first day. [N·m]"""


@pytest.fixture(scope="module")
def two_days():
    return simulate_torques(SynthesisSettings(seed=3, runs=2, joint_kind="plain"))


def with_step(table, second_day):
    """Return the days with 1.8 N·m more after three hours, and so many times that on the second."""
    first = (table["run"] == "day1").to_numpy()
    later = (hours(table) > 3.0) & first
    return with_friction_step(
        with_friction_step(table, later, 1.8), np.logical_not(first), 1.8 * second_day
    )


def test_a_step_that_lasts_is_named(two_days):
    diagnosis = diagnose_joint(
        with_step(two_days, 1.0), "motor", "N·m", DiagnosisSettings(margin=MARGIN)
    )
    (cause,) = diagnosis.causes
    assert cause.fit.effect.name == "step_change"
    assert cause.holds_on_new_run
    assert cause.visible_interval[0] < MARGIN
    assert cause.fit.coefficients == pytest.approx([1.8], abs=0.3)
    assert diagnosis.gain.after < 1.4 * diagnosis.floor
    keeps_the_rules(diagnosis)


@pytest.mark.parametrize("second_day", [0.0, -1.0])
def test_a_step_that_the_second_day_lacks_is_not(two_days, second_day):
    diagnosis = diagnose_joint(
        with_step(two_days, second_day), "motor", "N·m", DiagnosisSettings(margin=MARGIN)
    )
    assert diagnosis.causes == ()
    (cause,) = (one for one in diagnosis.visible if one.fit.effect.name == "step_change")
    assert cause.standing == "visible"
