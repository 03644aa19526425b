"""What is said of an effect that was found, with its numbers."""

from types import SimpleNamespace

import numpy as np
import pytest

from frictioncli.diagnosis.documents.cause_words import over_runs, words_for
from frictioncli.diagnosis.documents.extended_document import ParameterRecord
from frictioncli.diagnosis.documents.parameters import statement
from frictioncli.effects import BY_NAME
from frictioncli.effects.dress_pack import PUSHING
from frictioncli.effects.stribeck import EXTRAPOLATED


def said(effect, interval, estimate=None):
    if estimate is None:
        estimate = sum(interval) / 2
    parameters = {
        one.name: ParameterRecord(estimate=estimate, ci95=interval, unit=one.unit)
        for one in (*effect.shape, *effect.coefficients)
    }
    return statement(effect, parameters)


@pytest.mark.parametrize("name", ["rest_recovery", "stribeck", "payload_change"])
def test_the_torque_of_an_effect_may_be_certain_where_its_coefficients_are_not(name):
    effect = BY_NAME[name]
    assert "(5.0 to 8.0)" in said(effect, (5.0, 8.0))
    without = said(effect, (-77.0, 90.0))
    assert without.startswith(effect.summary)
    assert without.endswith("but not its parameters.")
    assert "90" not in without.removeprefix(effect.summary)
    # nor any order of magnitude, as of a spring whose rest angle the data do not tell
    assert said(effect, (2e-16, 2e16)) == without


def test_a_size_that_may_be_a_hundred_times_as_large_is_not_stated():
    """An interval of a logarithm may reach from next to nothing to more than any joint has."""
    effect = BY_NAME["run_in"]
    assert "(1 to 50)" in said(effect, (1.0, 50.0))
    assert said(effect, (1e-3, 1e17)).endswith("but not its parameters.")


def test_a_stiffness_of_which_only_the_sign_is_known_is_not_stated():
    """An interval of the logarithm: a spring is there, with any stiffness."""
    spring = BY_NAME["dress_pack"]
    assert "1.2" in said(spring, (0.4, 3.6), 1.2)
    text = said(spring, (1e-10, 8e9), 0.8)
    assert text.startswith(spring.summary)
    assert text.endswith("but not its parameters.")


def test_boundary_friction_below_the_slowest_move_is_said_to_be_extrapolated():
    parameters = {
        "velocity": ParameterRecord(estimate=2.3, ci95=(1.0, 8.7), unit="deg/s"),
        "boundary_torque": ParameterRecord(estimate=73.0, ci95=(12.0, 459.0), unit="N·m"),
    }
    moves = SimpleNamespace(speed=np.array([4.0, 20.0]))
    diagnosis = SimpleNamespace(base=SimpleNamespace(table=moves))
    effect = BY_NAME["stribeck"]
    assert words_for(diagnosis, effect, parameters) == EXTRAPOLATED
    text = statement(effect, parameters, EXTRAPOLATED)
    assert "extrapolated to standstill, it is 73 N·m" in text
    moves.speed[0] = 2.0
    assert words_for(diagnosis, effect, parameters) is None


@pytest.mark.parametrize(
    ("stiffness", "counted", "by_load_channel", "pushes"),
    [
        ((-3.1, -2.0), 1.0, False, True),
        ((2.0, 3.1), -1.0, False, True),
        ((2.0, 3.1), 1.0, False, False),
        ((-3.1, 0.2), 1.0, False, False),
        ((-3.1, -2.0), 1.0, True, False),
    ],
)
def test_a_spring_that_pushes_the_joint_on_is_no_cable(stiffness, counted, by_load_channel, pushes):
    """Held 1 rad further, it needs less torque: what pulls back would need more."""
    parameters = {"stiffness": ParameterRecord(estimate=2.5, ci95=stiffness, unit="N·m/rad")}
    problem = SimpleNamespace(
        table=SimpleNamespace(speed=np.array([4.0])),
        counted=counted,
        has_load_channel=by_load_channel,
    )
    effect = BY_NAME["dress_pack"]
    assert (words_for(SimpleNamespace(base=problem), effect, parameters) == PUSHING) == pushes
    assert "counterbalance" in statement(effect, parameters)


def test_an_order_is_no_coefficient():
    assert "7" in said(BY_NAME["position_ripple"], (-2.0, 16.0))


@pytest.mark.parametrize(
    ("runs", "text"),
    [
        (
            8,
            " The time between runs does not count; from the first of 8 runs to the last it is"
            " 2.1 N·m.",
        ),
        (2, " The time between runs does not count."),
        (1, ""),
    ],
)
def test_a_drift_over_several_runs_is_stated_as_a_change_from_the_first_to_the_last(runs, text):
    """Checks of an hour, in each of which friction grows by 0.3 N·m; a week between does not count.

    The clock of the log goes on from one run to the next.
    """
    parameters = {
        "rate": ParameterRecord(estimate=0.3, ci95=(0.2, 0.4), unit="N·m/h"),
        "time_constant": ParameterRecord(estimate=1e6, ci95=None, unit="h"),
    }
    run = np.repeat(np.arange(runs), 10)
    table = SimpleNamespace(run=run, clock=3600.0 * run + 360.0 * np.tile(np.arange(10), runs))
    diagnosis = SimpleNamespace(base=SimpleNamespace(all_runs=table), torque_unit="N·m")
    assert over_runs(diagnosis, parameters) == text
