"""Late torque gets the name of its reason, where that can be told."""

from dataclasses import replace

import numpy as np
import pytest

from frictioncli.diagnosis.data.build_problem import build_problems
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.ramps.evidence import RampEstimate
from frictioncli.diagnosis.ramps.timing import TorqueTiming
from frictioncli.diagnosis.ramps.timing_rivals import TimingRivals
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.timing_causes import judged_by_timing, late_torque
from frictioncli.effects import BY_NAME
from tests.equation_16 import TRUTH, friction, table


def cause(name, coefficients, errors, **fields):
    fit = EffectFit(BY_NAME[name], {}, np.array(coefficients), np.diag(np.square(errors)), 100.0)
    return (
        Cause(fit=fit, test=None, effects=(name,), probabilities={name: 1.0}, size=1.0, visible=0.5)
        if not fields
        else replace(cause(name, coefficients, errors), **fields)
    )


def causes(shift, second, *, shift_error=0.001, second_error=1e-4, standing="negligible"):
    """What pairs show of late torque, and a friction effect beside it."""
    return (
        cause("torque_delay", [shift], [shift_error]),
        cause("torque_filter", [second, 0.0], [second_error, 1e-6], standing=standing),
        cause("drift", [0.1], [0.01]),
    )


def starts(shift, smear, *, error=0.0005, smear_error=3e-5):
    rivals = TimingRivals(np.array([shift, smear]), np.diag(np.square([error, smear_error])))
    values = ((shift, error), (smear, smear_error))
    both = [RampEstimate(one, one - 1.96 * sd, one + 1.96 * sd) for one, sd in values]
    return TorqueTiming(
        shift=both[0], smear=both[1], rivals=rivals, rms=0.1, starts=50, period=0.012
    )


def names(judged):
    return [one.effects for one in judged]


def test_a_delay_keeps_its_name():
    found, rivals = judged_by_timing(causes(0.012, 7.2e-5), starts(0.012, 0.0))
    assert names(found) == [("torque_delay",), ("torque_filter",), ("drift",)]
    delay, time_constant = rivals.estimates()
    assert delay.low < 0.012 < delay.high
    assert time_constant.value < 0.002


def test_a_filter_gives_its_name_to_what_is_late_and_is_listed_once():
    found, rivals = judged_by_timing(causes(0.0385, 0.0014), starts(0.0402, 0.00163))
    assert names(found) == [("torque_filter",), ("drift",)]
    assert found[0].fit.effect.name == "torque_delay"
    assert found[0].probabilities["torque_filter"] > 0.95
    time_constant = rivals.estimates()[1]
    assert time_constant.low < 0.04 < time_constant.high


def test_a_filter_that_is_named_for_itself_stays():
    judged, _ = judged_by_timing(causes(0.04, 0.0016, standing="named"), starts(0.04, 0.0016))
    assert names(judged) == [("torque_filter",), ("torque_filter",), ("drift",)]


def test_a_delay_and_a_filter_are_two():
    found, rivals = judged_by_timing(causes(0.035, 0.00076), starts(0.0355, 0.00032))
    assert rivals.best == "both"
    assert names(found) == [("torque_delay",), ("torque_filter",), ("drift",)]


def test_what_cannot_be_told_apart_is_a_set():
    vague = starts(0.011, 6e-5, smear_error=1e-4)
    (first, *_), _ = judged_by_timing(causes(0.011, 9e-5), vague)
    assert set(first.effects) == {"torque_delay", "torque_filter"}
    assert sum(first.probabilities.values()) == pytest.approx(1.0)


def test_pairs_alone_name_a_filter_only_where_it_is_clear():
    found, _ = judged_by_timing(causes(0.012, 1e-4), None)
    assert names(found)[0] == ("torque_delay",)
    found, _ = judged_by_timing(causes(0.06, 0.0036, shift_error=5e-4, second_error=5e-5), None)
    assert names(found)[0] == ("torque_filter",)


def test_pairs_that_do_not_tell_a_delay_from_a_filter_tell_by_how_much_the_torque_is_late():
    (late, *_), rivals = judged_by_timing(causes(0.024, 4e-4, second_error=4e-4), None)
    assert late.effects == ("torque_delay",)
    assert rivals.estimates()[0].low == 0.0  # of a filter alone
    assert rivals.shift.value == 0.024
    assert 0.018 < rivals.shift.low < 0.022
    assert 0.026 < rivals.shift.high < 0.030


def test_without_the_measurement_s_effects_nothing_changes():
    (_, _, drift) = causes(0.0, 0.0)
    assert judged_by_timing([drift], starts(0.04, 0.0016)) == ((drift,), None)


def test_a_delay_that_the_starts_of_moves_contradict_has_no_name():
    """At least one of both is something else: at starts a gear may wind up, in segments friction
    may go with the angle.
    """
    early, *_ = causes(-0.046, 0.0, shift_error=0.005, standing="named")
    (judged, *_), rivals = judged_by_timing(causes(-0.046, 0.0, shift_error=0.005), starts(0.1, 0))
    assert judged.fit.coefficients == early.fit.coefficients
    assert judged.standing == "undetermined"
    assert "100.0 ms" in judged.reason
    assert rivals is None


@pytest.mark.parametrize(
    ("shift", "error", "contradicts"),
    [
        (0.023, 0.0005, False),  # within a sample
        (0.027, 0.0005, True),
        (0.040, 0.01, False),  # the segments tell little
        (0.040, 0.006, True),
    ],
)
def test_starts_and_segments_may_differ_by_a_sample_and_their_errors(shift, error, contradicts):
    assert starts(0.012, 0.0).contradicts(shift, error) is contradicts


@pytest.mark.parametrize("imprecise", [0.033, -0.004])
def test_starts_that_hardly_tell_a_delay_do_not_decide_it(imprecise):
    """Beside a ripple, whose period a move at 90 deg/s passes in 0.27 s, 23 ms matter."""
    delay, generator = 0.010, np.random.default_rng(4)
    position, speed = np.arange(-52.5, 53.0, 5.0), np.resize([10.0, 25.0, 50.0, 90.0], 80)
    warm = np.linspace(25.0, 50.0, len(speed))
    ways = []
    for way in (1, -1):
        angle = np.radians(position - way * delay * speed[:, np.newaxis])
        load = 60.0 * np.cos(angle)
        torque = friction(
            TRUTH, load=load, speed=speed[:, np.newaxis], temperature=warm[:, np.newaxis]
        )
        torque = torque + 1.5 * np.sin(15 * angle)
        ways.append(load + way * torque + 0.1 * generator.normal(size=load.shape))
    half, mean = (ways[0] - ways[1]) / 2, (ways[0] + ways[1]) / 2
    columns = {
        "speed": speed,
        "time": 60.0 * np.arange(len(speed)),
        "phase": np.full(len(speed), "heat-up"),
        "motor_temperature": warm,
        "housing_temperature": np.full(len(speed), np.nan),
        "motor_temperature_reading": warm,
    }
    rows = table(columns, position=position, friction_torque=half, load_torque=mean[0])
    unknown = dict.fromkeys(("load", "payload"), np.nan)
    rows = rows.assign(
        load_torque=mean.ravel(), torque_forward=ways[0].ravel(), torque_reverse=ways[1].ravel()
    ).assign(**unknown)
    problem = build_problems(rows, "motor")[0]
    late = late_torque(problem, starts(imprecise, 0.0, error=0.008), torques=rows)
    assert late.delay == pytest.approx(delay, abs=0.002)
