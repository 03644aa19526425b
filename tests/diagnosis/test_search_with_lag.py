"""A search that is repeated about the temperature of the gear: which estimate stays."""

from types import SimpleNamespace

import pytest

from frictioncli.diagnosis.thermal import refine
from frictioncli.effects import EFFECTS

MEASURED, FIRST, SECOND = "measured temperature", "first estimate", "beside the causes"


def found(*names):
    causes = [
        SimpleNamespace(
            fit=SimpleNamespace(effect=SimpleNamespace(name=name)), visible_interval=(1.0, 2.0)
        )
        for name in names
    ]
    return SimpleNamespace(causes=causes)


@pytest.fixture
def searched(monkeypatch):
    """Return the causes and the estimate that a search ends with, from what it finds about each."""

    def about(causes):
        def estimated(problem, new, accepted=()):
            of = SECOND if accepted else FIRST
            return SimpleNamespace(problem=of, estimate=None)

        monkeypatch.setattr(refine, "_is_far_off", lambda problem: True)
        monkeypatch.setattr(refine, "_explains_most", lambda estimate: True)
        monkeypatch.setattr(refine, "refine_thermal", estimated)
        monkeypatch.setattr(refine, "_as_refined", lambda result, refined: result)
        result, lag = refine.search_with_lag(
            MEASURED, None, EFFECTS, lambda problem, effects: found(*causes[problem])
        )
        return [cause.fit.effect.name for cause in result.causes], lag.problem

    return about


def test_the_second_estimate_is_beside_the_causes_of_the_first(searched):
    both = ("thermal_lag", "step_change")
    assert searched({FIRST: both, SECOND: both}) == (list(both), SECOND)


def test_an_estimate_about_which_the_lag_is_impossible_is_not_taken(searched):
    """A drift that was fitted beside the lag took it the wrong way."""
    both = ("thermal_lag", "drift")
    assert searched({FIRST: both, SECOND: ("drift", "step_change")}) == (list(both), FIRST)


def test_a_lag_that_is_found_alone_needs_no_second_estimate(searched):
    assert searched({FIRST: ("thermal_lag",)}) == (["thermal_lag"], FIRST)
