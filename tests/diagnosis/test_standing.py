"""What may be said of a cause: one rule after the other, on causes made by hand."""

from dataclasses import replace

import numpy as np
import pytest

from frictioncli.diagnosis.data.hidden_temperature import HiddenTemperature
from frictioncli.diagnosis.fit.hypotheses import EffectFit, HypothesisTest, physical_bounds
from frictioncli.diagnosis.noise.significance import NullDistribution
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.confounded import confounded
from frictioncli.diagnosis.search.shown import Shown
from frictioncli.diagnosis.search.standing import (
    with_standing,
    without_cancelling,
    without_linear_lag,
)
from frictioncli.effects import BY_NAME
from tests.diagnosis.dense_noise import problem
from tests.diagnosis.wave_effects import A, B, effect

MARGIN, ALPHA = 0.2, 0.05
GRADUAL = ("drift", "run_in", "coulomb_temperature", "torque_constant")
WAVE = effect("a", [(1.0, A)], lower=0.0)


@pytest.fixture(scope="module")
def joint():
    return problem(1)


def cause(one=WAVE, coefficients=(1.0,), errors=(0.1,), interval=(0.5, 0.9), shape=None, **test):
    """Return a cause with an interval of its visible size. [N·m]"""
    values, covariance = np.array(coefficients, float), np.diag(np.square(errors))
    told = {"p_value": 1e-9, "log_bayes_factor": 20.0, "statistic": 50.0} | test
    return Cause(
        fit=EffectFit(one, shape or {}, values, covariance, told["statistic"]),
        test=HypothesisTest(
            name=one.name,
            shape=shape or {},
            coefficients=values,
            covariance=covariance,
            freedom=len(values),
            null=NullDistribution(coefficients=len(values), freedom=100.0),
            size_scale=0.1,
            **told,
        ),
        effects=(one.name,),
        probabilities={one.name: 1.0},
        size=0.7,
        visible=0.7,
        visible_interval=interval,
    )


def standing(joint, *causes):
    judged = without_cancelling(with_standing(causes, joint, MARGIN, ALPHA), joint)
    return [(one.standing, one.reason) for one in judged]


@pytest.mark.parametrize(
    ("interval", "expected"),
    [
        ((0.21, 0.9), "named"),
        ((0.19, 0.9), "visible"),
        ((0.0, 0.9), "undetermined"),
        ((0.05, 0.19), "negligible"),
        ((0.0, 0.1), "negligible"),
    ],
)
def test_a_name_needs_a_lower_bound_above_the_margin(joint, interval, expected):
    ((found, reason),) = standing(joint, cause(interval=interval))
    assert found == expected
    assert ("0.2" in reason) == (found != "named")


@pytest.mark.parametrize("test", [{"p_value": 0.06}, {"log_bayes_factor": 2.9}])
def test_what_noise_may_explain_is_undetermined_whatever_its_size(joint, test):
    ((found, reason),) = standing(joint, cause(interval=(5.0, 6.0), **test))
    assert (found, "noise" in reason) == ("undetermined", True)


@pytest.mark.parametrize(("p_value", "expected"), [(5e-4, "named"), (5e-3, "undetermined")])
def test_a_change_needs_more_significance_than_another_effect(joint, p_value, expected):
    """Drift looks like a change at some moment more often than p-values say."""
    step = BY_NAME["step_change"]
    shape = {"moment": 0.3, "end": 1.0}
    ((found, _),) = standing(joint, cause(step, (1.0,), (0.1,), shape=shape, p_value=p_value))
    assert found == expected
    ((found, _),) = standing(joint, cause(p_value=p_value))
    assert found == "named"


def test_what_physics_forbids_is_not_named(joint):
    """Below 0, by more than its error; on a bound alone; a coefficient that may be nothing."""
    for coefficient, error, word in (
        (-0.5, 0.1, "impossible"),
        (0.0, 0.0, "bound"),
        (0.1, 0.1, "zero"),
    ):
        ((found, reason),) = standing(joint, cause(coefficients=(coefficient,), errors=(error,)))
        assert found == "undetermined"
        assert word in reason
    ((found, _),) = standing(joint, cause(coefficients=(-0.1,), errors=(0.2,)))
    assert found == "undetermined"


@pytest.mark.parametrize("name", ["load_velocity", "load_temperature"])
def test_bounds_of_the_square_of_the_load_grow_where_the_load_is_small(joint, name):
    """At a tenth of the load, the same torque takes a hundred times the coefficient."""
    most = float(np.max(np.abs(joint.table.load)))

    def bound(load):
        table = replace(joint.table, load=joint.table.load * load / most)
        return physical_bounds(BY_NAME[name], replace(joint, table=table))[1][0]

    assert bound(4.0) == pytest.approx(100 * bound(40.0))
    assert bound(8.0) == pytest.approx(25 * bound(40.0))
    assert bound(90.0) == bound(40.0)


def test_bounds_in_torque_grow_with_the_friction_of_the_joint(joint):
    """A joint of 30 N·m may drift one and a half times as fast as one of 20 N·m or less."""
    drift = BY_NAME["drift"]
    share = np.mean(joint.friction) / 20.0
    assert share > 1.2
    lower, upper = physical_bounds(drift, joint)
    (parameter,) = drift.coefficients
    assert (lower[0], upper[0]) == pytest.approx((parameter.lower * share, parameter.upper * share))
    weak = replace(joint, friction=joint.friction / 10)
    assert physical_bounds(drift, weak)[1][0] == parameter.upper
    # units without torque stay
    lag = BY_NAME["thermal_lag"]
    for one, high in zip(lag.coefficients, physical_bounds(lag, joint)[1], strict=True):
        assert high == pytest.approx(one.upper * (share if "torque" in one.unit else 1.0))
    shape = {axis.name: axis.at(0.5) for axis in drift.shape}
    for factor, expected in ((1.1, "named"), (1.1 * share, "undetermined")):
        one = cause(drift, (factor * parameter.upper,), (0.01,), shape=shape)
        ((found, _),) = standing(joint, one)
        assert found == expected


@pytest.mark.parametrize(
    ("name", "shown", "expected"),
    [
        ("position_ripple", Shown(1.0, 0.6), "named"),
        ("position_ripple", Shown(1.0, 0.4), "undetermined"),
        ("position_ripple", Shown(0.4, 1.0), "undetermined"),
        # by the square of the speed, slower moves show little of it
        ("quadratic_drag", Shown(1.0, 0.4), "named"),
        ("torque_delay", Shown(0.5, 0.0), "named"),
        ("torque_delay", Shown(0.2, 0.0), "undetermined"),
    ],
)
def test_what_the_residuals_do_not_show_has_no_name(joint, name, shown, expected):
    """Of a ripple slower moves must show it, too: a finer one would be there at one speed only."""
    effect = BY_NAME[name]
    shape = {axis.name: 20.0 for axis in effect.shape}
    values = [0.02 if name == "torque_delay" else 1e-4] * len(effect.coefficients)
    one = replace(cause(effect, values, np.divide(values, 10), shape=shape), shown=shown)
    ((found, reason),) = standing(joint, one)
    assert found == expected
    assert ("show" in reason) == (expected != "named")


def test_a_payload_that_one_direction_of_motion_has_is_not_determined(joint):
    shape = {"moment": 0.3, "end": 1.0}
    one = cause(BY_NAME["payload_change"], (3.0, 1.0), (0.1, 0.1), shape=shape)
    assert standing(joint, one)[0][0] == "named"
    ((found, reason),) = standing(joint, replace(one, shown=Shown(one_direction=True)))
    assert (found, "one direction" in reason) == ("undetermined", True)


def test_two_causes_that_cancel_are_not_both_named(joint):
    """One is the other's negative, but for a little: the weaker has no name."""
    against = effect("against", [(-1.0, A), (0.3, B)])
    strong = cause(statistic=90.0)
    weak = cause(against, statistic=40.0)
    other = cause(effect("other", [(1.0, B)]), statistic=30.0)
    found = standing(joint, weak, strong, other)
    assert [one[0] for one in found] == ["undetermined", "named", "named"]
    assert "cancel" in found[0][1]
    assert strong.fit.effect.name in found[0][1]


@pytest.mark.parametrize(
    ("held", "expected"),
    [
        ((True, True), "named"),
        ((True, None), "undetermined"),
        ((None, True), "undetermined"),
        ((False, True), "undetermined"),
    ],
)
def test_two_causes_that_cancel_are_both_named_if_both_hold_on_the_run_kept_out(
    joint, held, expected
):
    against = effect("against", [(-1.0, A), (0.3, B)])
    both = (cause(against, statistic=40.0), cause(statistic=90.0))
    judged = [replace(one, holds_on_new_run=own) for one, own in zip(both, held, strict=True)]
    assert [one[0] for one in standing(joint, *judged)] == [expected, "named"]


def test_causes_that_only_overlap_in_part_keep_their_names(joint):
    half = effect("half", [(-1.0, A), (1.5, B)])
    assert [one[0] for one in standing(joint, cause(), cause(half))] == ["named", "named"]


def test_causes_of_two_channels_cannot_cancel(joint):
    """Friction and load of one amount, of opposite sign."""
    payload = BY_NAME["dress_pack"]
    shape = {axis.name: axis.at(0.5) for axis in payload.shape}
    found = standing(joint, cause(), cause(payload, (-1.0,), (0.01,), shape=shape))
    assert found[0][0] == "named"


def test_what_is_not_named_cancels_nothing(joint):
    against = effect("against", [(-1.0, A)])
    found = standing(joint, cause(), cause(against, interval=(0.0, 0.1), statistic=99.0))
    assert [one[0] for one in found] == ["named", "negligible"]


def test_a_load_channel_has_a_margin_in_its_own_unit(joint):
    # the margin of friction, here 0.2, may be a current: it says nothing of a load in N·m
    own = replace(joint, has_load_channel=True, load=np.full_like(joint.load, 100.0))
    in_load = replace(WAVE, channel="load")
    small = cause(in_load, interval=(0.21, 0.49))
    assert standing(own, small)[0][0] == "negligible"
    assert standing(joint, small)[0][0] == "named"
    assert standing(own, cause(in_load, interval=(0.51, 0.9)))[0][0] == "named"
    assert standing(own, cause(interval=(0.21, 0.49)))[0][0] == "named"


@pytest.mark.parametrize(
    ("inertial", "unequal", "possible"),
    [(1.0, 0.9, True), (1.0, 1.2, True), (1.0, 2.0, False), (-1.0, 2.0, False), (-1.0, -0.9, True)],
)
def test_half_a_difference_of_torques_of_one_sign_is_at_most_their_mean(
    joint, inertial, unequal, possible
):
    """With accelerations a and b of one sign, |a - b| <= |a + b|, whatever the torque's sign."""
    shape = {"distance": 10.0, "growth": 0.0}
    one = cause(BY_NAME["inertia"], (inertial, unequal), (0.1, 0.1), shape=shape)
    ((_, reason),) = standing(joint, one)
    assert ("its unequal braking would exceed" in reason) != possible


def warming(joint, share):
    """Return a joint that warms up over time, or that does so in a share of the pairs only."""
    means = joint.layout.means(np.column_stack([joint.table.clock, joint.table.temperature]))
    order = np.argsort(np.argsort(means[:, 0]))
    warm = 20.0 + 30.0 * order / order.max()
    cooling = order > share * order.max()
    warm = np.where(cooling, 2 * warm[~cooling].max() - warm, warm)[joint.layout.row_pair]
    table = replace(joint.table, temperature=warm, measured_temperature=warm)
    return replace(joint, table=table)


def beyond_doubt(joint, name):
    """Return a cause of this name within its bounds, with small errors."""
    effect = BY_NAME[name]
    lower, upper = physical_bounds(effect, joint)
    middle = tuple(0.3 * low + 0.7 * high for low, high in zip(lower, upper, strict=True))
    errors = tuple(0.01 * abs(one) for one in middle)
    return cause(effect, middle, errors, shape={axis.name: axis.lower for axis in effect.shape})


@pytest.mark.parametrize("name", GRADUAL)
def test_temperature_and_time_that_go_together_give_no_name(joint, name):
    one = beyond_doubt(joint, name)
    ((apart, _),) = standing(warming(joint, 0.5), one)
    ((together, reason),) = standing(warming(joint, 1.0), one)
    assert (apart, together) == ("named", "undetermined")
    assert "temperature and time change together" in reason


@pytest.mark.parametrize("name", ["drift", "run_in", "rest_recovery"])
def test_what_changes_gradually_has_no_name_in_a_log_without_temperature(joint, name):
    """The joint may have warmed up. One that is logged, of motor or housing, tells."""
    nowhere = np.full(len(joint.table.time), np.nan)
    without = replace(joint.table, motor_temperature=nowhere, housing_temperature=nowhere)
    one = beyond_doubt(joint, name)
    ((found, reason),) = standing(replace(joint, table=without), one)
    assert (found, "no temperature" in reason) == ("undetermined", True)
    at_housing = replace(without, housing_temperature=np.zeros_like(nowhere))
    for table in (joint.table, at_housing):
        ((found, reason),) = standing(replace(joint, table=table), one)
        assert "no temperature" not in reason


def test_where_moves_may_carry_two_loads_no_cause_of_friction_has_a_name(joint):
    """What the load adds in one direction is in the friction of both."""
    doubtful = replace(joint, doubt="its moves may carry two loads")
    for name in ("direction_asymmetry", "stribeck", "dress_pack"):
        assert confounded(BY_NAME[name], doubtful) == doubtful.doubt
        assert not confounded(BY_NAME[name], joint)
    assert not confounded(BY_NAME["torque_delay"], doubtful)


@pytest.mark.parametrize(("pause", "expected"), [(30.0, "named"), (600.0, "undetermined")])
def test_without_temperature_a_step_across_a_pause_may_be_one_of_temperature(
    joint, pause, expected
):
    """A joint warms up gradually while it is logged, and unseen between two recordings."""
    nowhere = np.full(len(joint.table.time), np.nan)
    pair = joint.layout.row_pair
    begun = pair >= len(joint.layout.time) // 2
    table = replace(joint.table, clock=20.0 * pair + pause * begun)
    without = replace(table, motor_temperature=nowhere, housing_temperature=nowhere)
    one = replace(joint, table=without, all_runs=without)
    step = replace(beyond_doubt(joint, "step_change"), visible_interval=(0.5, 0.9))
    step = replace(step, fit=replace(step.fit, shape={"moment": 0.5, "end": 1.0}))
    ((found, reason),) = standing(one, step)
    assert found == expected
    assert ("no temperature" in reason) == (expected != "named")
    assert standing(replace(joint, table=table, all_runs=table), step)[0][0] == "named"
    assert not confounded(BY_NAME["linear_viscous"], one)


@pytest.mark.parametrize("name", ["load_velocity", "torque_delay", "linear_viscous"])
def test_an_effect_of_a_speed_that_differs_between_runs_only_has_no_name(joint, name):
    """The day, the payload or the pose may be what differs; what needs no speed has its name."""
    pairs = len(joint.layout.time)
    run = (np.arange(pairs) >= pairs // 2).astype(int)
    effect = BY_NAME[name]
    coefficients = tuple(0.5 * min(one.upper, 1.0) for one in effect.coefficients)
    shape = {axis.name: axis.at(0.5) for axis in effect.shape}
    told = cause(effect, coefficients, tuple(0.01 * one for one in coefficients), shape=shape)
    ((found, _),) = standing(joint, told)
    assert found == "named"
    for speed, expected in ((20.0 + 20.0 * run, "undetermined"), (joint.layout.speed, "named")):
        apart = replace(joint, layout=replace(joint.layout, run=run, speed=speed))
        ((found, reason),) = standing(apart, told)
        assert found == expected
        assert ("every run has its own speed" in reason) == (expected != "named")
        ((found, _),) = standing(apart, cause())
        assert found == "named"


def test_friction_wholly_at_a_measured_temperature_is_no_fit_on_a_bound(joint):
    """All friction follows the housing: that share is 1, and the others are 0, whatever they are
    bounded by.
    """
    lag = BY_NAME["thermal_lag"]
    at_housing = cause(lag, (0.0, 0.0, 1.0, 0.0), (0.0,) * 4, shape={"time_constant": 120.0})
    assert standing(joint, at_housing) == [("named", "")]
    ((found, reason),) = standing(joint, cause(coefficients=(0.0,), errors=(0.0,)))
    assert found == "undetermined"
    assert "on a bound" in reason


@pytest.mark.parametrize(("periods", "expected"), [(1.27, "undetermined"), (1.6, "named")])
def test_a_ripple_that_hardly_repeats_is_any_smooth_function(joint, periods, expected):
    """At the least order that a stroke shows, two harmonics follow friction to the fourth power."""
    stroke = float(np.ptp(joint.table.position))
    ripple = cause(
        BY_NAME["position_ripple"],
        (1.0, 0.5, 0.2, 0.1),
        (0.1,) * 4,
        shape={"order": 360.0 * periods / stroke},
    )
    ((found, reason),) = standing(joint, ripple)
    assert found == expected
    assert ("smooth" in reason) == (expected != "named")


def test_a_lag_has_a_name_only_as_a_temperature_of_the_gear(joint):
    """Its linear form knows no bounds: heat of -21 °C had a name."""
    lag = replace(
        cause(
            BY_NAME["thermal_lag"], coefficients=(-0.1, -21.0, 0.0, 0.4), errors=(3.6, 120, 1, 1)
        ),
        standing="named",
    )
    other = replace(cause(), standing="named")
    left, kept = without_linear_lag([lag, other], joint)
    assert (left.standing, kept.standing) == ("visible", "named")
    assert "temperature of the gear" in left.reason
    hidden = HiddenTemperature.of(600.0, np.array([1.0, 0.0, 0.0, 0.0]), 1.0)
    assert without_linear_lag([lag], replace(joint, hidden=hidden)) == (lag,)
