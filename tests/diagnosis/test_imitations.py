"""Effects of the measurement that stand for a cause without a name; causes refuted in turn."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.search import cause_selection
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.cause_selection import (
    refuted_by_new_run,
    refuted_lag,
    uncertain_causes,
)
from frictioncli.diagnosis.search.judging import JudgedCauses
from frictioncli.diagnosis.search.named_causes import without_imitations
from frictioncli.diagnosis.thermal.refine import restricted
from frictioncli.effects import BY_NAME


def cause(name, standing, p_value=1e-20, size=1.0):
    width = len(BY_NAME[name].coefficients)
    return Cause(
        fit=EffectFit(BY_NAME[name], {}, np.full(width, size), np.eye(width), 100.0),
        test=SimpleNamespace(p_value=p_value, log_bayes_factor=50.0),
        effects=(name,),
        probabilities={name: 1.0},
        size=size,
        visible=size,
        standing=standing,
    )


def judged(*causes):
    return JudgedCauses(found=None, causes=causes, timing=None)


NOISE = cause("torque_delay", "undetermined", p_value=1.0, size=0.001)
IMITATION = cause("torque_delay", "named", size=0.024)


@pytest.mark.parametrize(
    ("lost", "measured", "named"),
    [
        # there beyond doubt, but too small for a name: the delay was noise beside it
        (cause("inertia", "visible"), NOISE, False),
        # it may be noise itself, or impossible: what looks like it is the delay
        (cause("inertia", "visible", p_value=1e-3), NOISE, True),
        (cause("inertia", "undetermined"), NOISE, True),
        # the delay was there beside it, too
        (cause("inertia", "visible"), cause("torque_delay", "visible"), True),
    ],
)
def test_what_was_noise_beside_a_cause_stays_noise_when_that_loses_its_name(lost, measured, named):
    first = judged(measured, cause("thermal_lag", "named"), lost)
    found = without_imitations(judged(IMITATION, cause("thermal_lag", "named")), first, 0.05)
    assert ("torque_delay" in {one.fit.effect.name for one in found.named}) is named
    assert found.causes[0] is (IMITATION if named else measured)


def test_the_new_run_refutes_the_worst_first_and_the_others_without_it(monkeypatch):
    """A drift that goes the wrong way spoils what Stribeck friction beside it predicts."""
    misfits = {
        frozenset({"drift", "stribeck"}): 3.0,
        frozenset({"drift"}): 2.6,
        frozenset({"stribeck"}): 1.0,
        frozenset(): 2.0,
    }
    monkeypatch.setattr(
        cause_selection,
        "missed_of_new_run",
        lambda fits, *rest: misfits[frozenset(one.effect.name for one in fits)],
    )
    step = SimpleNamespace(problem=None, predicting_fit=lambda: None)
    causes = [cause("stribeck", "named"), cause("drift", "named")]
    (refuted,) = refuted_by_new_run(causes, step, None)
    assert refuted.fit.effect.name == "drift"
    assert refuted.standing == "visible"
    assert "3 times" in refuted.reason


def test_the_new_run_does_not_refute_a_lag_of_which_a_network_has_some_parts(monkeypatch):
    """What a lag adds there depends on its temperature, in which the base is linear already."""
    lag = cause("thermal_lag", "named")
    lag = replace(lag, fit=replace(lag.fit, effect=restricted([0])))
    monkeypatch.setattr(cause_selection, "missed_of_new_run", lambda fits, *rest: 1.0 + len(fits))
    step = SimpleNamespace(problem=None, predicting_fit=lambda: None)
    (refuted,) = refuted_by_new_run([lag, cause("drift", "named")], step, None)
    assert refuted.effects == ("drift",)


@pytest.mark.parametrize(
    ("others", "times"), [((), "2.5 times"), (("drift",), "2 times"), (("stribeck",), "")]
)
def test_a_lag_that_spoils_the_new_run_is_refuted_by_the_measured_temperature(
    monkeypatch, others, times
):
    """What warmed the gear before the run is not logged; the misfits are 5 with the lag."""
    without = {(): 2.0, ("drift",): 2.5, ("stribeck",): 4.1}

    def missed(fits, problem, new, weighted_fit):
        assert (problem, new) == ("measured", "measured")
        return without[tuple(one.effect.name for one in fits)]

    def missed_with(fits):
        assert [one.effect.name for one in fits] == ["thermal_lag", *others]
        return 5.0

    monkeypatch.setattr(cause_selection, "missed_of_new_run", missed)
    step = SimpleNamespace(predicting_fit=lambda: None)
    causes = [cause("thermal_lag", "named"), *(cause(one, "named") for one in others)]
    reason = refuted_lag(causes, step, missed_with, ("measured", "measured"))
    assert times in reason
    assert bool(reason) == bool(times)
    assert refuted_lag(causes[1:], step, missed_with, ("measured", "measured")) == ""


@pytest.mark.parametrize(
    ("rest_time", "error", "is_uncertain"),
    [(86_300.0, 20.0, True), (86_300.0, 0.5, False), (3_600.0, 20.0, False)],
)
def test_friction_that_recovers_in_no_rest_needs_an_excess_that_is_known(
    monkeypatch, rest_time, error, is_uncertain
):
    """Else it is friction that rises steadily; a rest of hours may leave the excess uncertain."""
    recovering = cause("rest_recovery", "named")
    shape = {"pairs": 27.0, "rest_time": rest_time, "at_start": 0.0}
    values = np.array([3.0, 0.1])
    fit = replace(recovering.fit, effect=BY_NAME["rest_recovery"], shape=shape, coefficients=values)
    extension = SimpleNamespace(
        effects=(fit,),
        errors=np.array([9.0, error, 1.0]),
        place=lambda _: slice(1, 3),
        may_be_zero=lambda _: False,
    )
    monkeypatch.setattr(cause_selection, "extend", lambda *_: extension)
    found = uncertain_causes([replace(recovering, fit=fit)], None, None)
    assert found == ({"rest_recovery"} if is_uncertain else set())
