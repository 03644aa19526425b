"""Causes of which a new run shows that they are back, as friction after a rest is."""

from types import SimpleNamespace

import pytest

from frictioncli.diagnosis.search import new_run_rivals
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.effects import BY_NAME


def cause(name, holds=None):
    fit = SimpleNamespace(effect=BY_NAME[name])
    return Cause(
        fit=fit,
        test=None,
        effects=(name,),
        probabilities={name: 1.0},
        size=1.0,
        visible=1.0,
        visible_interval=(0.9, 1.1),
        standing="named",
        holds_on_new_run=holds,
    )


@pytest.fixture
def search(monkeypatch):
    """Return a search that tried some effects, and what each misses of the new run [N·m]."""

    def of(missed, tried):
        monkeypatch.setattr(
            new_run_rivals,
            "_fitted",
            lambda rivals, others, found: [SimpleNamespace(effect=one) for one in rivals],
        )
        monkeypatch.setattr(
            new_run_rivals,
            "missed_of_new_run",
            lambda fits, problem, new, weights: missed[fits[-1].effect.name],
        )
        hypotheses = [SimpleNamespace(name=name) for name in tried]
        step = SimpleNamespace(problem=None, predicting_fit=lambda: None)
        return SimpleNamespace(catalogue=SimpleNamespace(hypotheses=hypotheses), step=step)

    return of


@pytest.mark.parametrize(
    ("missed", "holds", "tried", "is_refuted"),
    [
        ({"run_in": 1.2, "rest_recovery": 0.5}, None, ["run_in", "rest_recovery"], True),
        ({"run_in": 0.52, "rest_recovery": 0.5}, None, ["run_in", "rest_recovery"], False),
        ({"run_in": 1.2, "rest_recovery": 0.5}, False, ["run_in", "rest_recovery"], False),
        ({"run_in": 1.2, "rest_recovery": 0.5}, None, ["run_in"], False),
    ],
    ids=["back", "hardly better", "gone", "not tried"],
)
def test_what_is_back_on_the_next_morning_is_no_running_in(
    search, missed, holds, tried, is_refuted
):
    found = search(missed, tried)
    refuted = new_run_rivals.refuted_by_return([cause("run_in", holds)], found, None)
    assert [one.effects for one in refuted] == [("run_in",)] * is_refuted
    for one in refuted:
        assert one.standing == "visible"
        assert "rest recovery predicts the held-out run better" in one.reason


@pytest.mark.parametrize("other", ["velocity_exponent", "rest_recovery"])
def test_a_cause_that_is_back_itself_stays(search, other):
    """Boundary friction is there at low speed on every day; to be worse there tells no rest."""
    found = search({"stribeck": 2.0, other: 0.1}, ["stribeck", other])
    assert new_run_rivals.refuted_by_return([cause("stribeck")], found, None) == ()


def test_a_cause_that_no_effect_which_comes_back_looks_like_stays(search):
    found = search({"run_in": 2.0, "drift": 0.1}, ["run_in", "drift"])
    assert new_run_rivals.refuted_by_return([cause("run_in")], found, None) == ()
