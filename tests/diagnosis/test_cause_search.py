"""The search for causes: which effects are accepted, replaced or dropped, and that it ends."""

from dataclasses import replace

import numpy as np
import pytest

from frictioncli.diagnosis.fit.hypotheses import EffectFit, hypothesis_of, physical_bounds
from frictioncli.diagnosis.noise.significance import credible_set, posterior_probabilities
from frictioncli.diagnosis.search import effect_tests, rivals
from frictioncli.diagnosis.search.catalogue import Catalogue
from frictioncli.diagnosis.search.cause_search import find_causes
from frictioncli.diagnosis.search.effect_tests import EffectTests
from frictioncli.diagnosis.search.possible import lies_on_bound
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.diagnosis.search.step import Step
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.effects import BY_NAME
from tests.diagnosis.dense_noise import problem
from tests.diagnosis.wave_effects import THREE, A, B, C, effect, wave

SETTINGS = DiagnosisSettings()

MARGIN = 0.1
"""Smallest size worth a name. [N·m]"""


@pytest.fixture
def catalogue(monkeypatch):
    """Make the search know other effects than those of the catalogue."""

    def known(*effects):
        for module in (effect_tests, rivals):
            monkeypatch.setattr(module, "BY_NAME", {one.name: one for one in effects})
        return effects

    return known


def names(found):
    return sorted(cause.fit.effect.name for cause in found.causes)


def test_causes_are_found_one_after_another_and_the_strongest_comes_first(catalogue):
    effects = catalogue(*THREE)
    data = problem(8, friction=lambda rows: 0.5 * A(rows) + 1.0 * C(rows))
    found = find_causes(data, effects, SETTINGS, MARGIN)
    assert [cause.fit.effect.name for cause in found.causes] == ["c", "a"]
    for cause, size in zip(found.causes, (1.0, 0.5), strict=True):
        assert cause.fit.coefficients[0] == pytest.approx(size, rel=0.06)
        assert cause.size == pytest.approx(size / np.sqrt(2), rel=0.06)
        assert cause.effects == (cause.fit.effect.name,)
        assert cause.test.p_value < 1e-6
    assert set(found.rejected) == {"b"}
    assert [fit.effect.name for fit in found.step.accepted] == ["c", "a"]


def test_nothing_is_found_in_noise(catalogue):
    effects = catalogue(*THREE)
    found = find_causes(problem(9), effects, SETTINGS, MARGIN)
    assert found.causes == ()
    assert set(found.rejected) == {"a", "b", "c"}


def test_no_more_causes_than_wanted(catalogue):
    effects = catalogue(*THREE, effect("d", [(1.0, wave(26.0))]))
    data = problem(8, friction=lambda rows: A(rows) + B(rows) + C(rows))
    assert len(find_causes(data, effects, replace(SETTINGS, most=2), MARGIN).causes) == 2


def test_a_first_wrong_name_is_replaced(catalogue):
    """One mixture looks like two causes at once, until one of them stands beside it."""
    mixture = effect("mixture", [(1.0, A), (1.0, B), (0.3, C)])
    effects = catalogue(mixture, effect("a", [(1.0, A)]), effect("b", [(1.0, B)]))
    data = problem(10, friction=lambda rows: A(rows) + 0.6 * B(rows))
    precomputed = Precomputed.of(data)
    first = Step.of(precomputed, []).tested(
        Catalogue.of(precomputed, [hypothesis_of(one, data) for one in effects])
    )
    assert max(first, key=lambda name: first[name].log_bayes_factor) == "mixture"
    found = find_causes(data, effects, SETTINGS, MARGIN)
    assert [cause.fit.effect.name for cause in found.causes] == ["a", "b"]
    for cause, size in zip(found.causes, (1.0, 0.6), strict=True):
        assert cause.fit.coefficients[0] == pytest.approx(size, rel=0.05)


def search_of(data, effects):
    precomputed = Precomputed.of(data)
    hypotheses = Catalogue.of(precomputed, [hypothesis_of(one, data) for one in effects])
    return EffectTests(precomputed, hypotheses, MARGIN, None)


def effect_fit(one, *coefficients):
    return EffectFit(one, {}, np.array(coefficients), np.eye(len(coefficients)), 50.0)


def test_an_effect_that_others_made_superfluous_is_dropped(catalogue):
    mixture = effect("mixture", [(1.0, A), (1.0, B), (0.4, C)])
    pair = effect("pair", [(1.0, A)], [(1.0, B)])
    catalogue(mixture, pair)
    data = problem(11, friction=lambda rows: A(rows) + B(rows))
    search = search_of(data, (mixture, pair))
    remaining = search.retested([effect_fit(mixture, 1.0), effect_fit(pair, 0.0, 0.0)])
    assert [fit.effect.name for fit in remaining] == ["pair"]


def test_a_name_changes_where_another_fits_clearly_better_beside_the_others(catalogue):
    """The mixture's part beside the first wave is the second wave, and nothing else."""
    mixture = effect("mixture", [(1.0, A), (1.0, B), (0.3, C)])
    first, second, _ = THREE
    catalogue(mixture, *THREE)
    data = problem(10, friction=lambda rows: A(rows) + 0.6 * B(rows))
    remaining = search_of(data, (mixture, *THREE)).retested(
        [effect_fit(mixture, 0.8), effect_fit(first, 0.3)]
    )
    assert [fit.effect for fit in remaining] == [second, first]
    assert [fit.coefficients[0] for fit in remaining] == pytest.approx([0.6, 1.0], rel=0.05)


def test_what_was_superfluous_comes_back_once(catalogue, monkeypatch):
    """What made it superfluous may have been given up since; strongest first, and it ends."""
    effects = catalogue(*THREE)
    tried = []

    def fickle(search, accepted, dropped=()):
        tried.append(accepted[-1].effect.name)
        assert len(tried) < 10
        return accepted[:-1]

    monkeypatch.setattr(EffectTests, "retested", fickle)
    data = problem(18, friction=lambda rows: A(rows) + 0.5 * B(rows) + 2.0 * C(rows))
    assert find_causes(data, effects, SETTINGS, MARGIN, discrepancy=0.0).causes == ()
    assert tried == ["c", "a", "b"] * 2


def test_what_was_superfluous_may_replace_one_of_those_that_made_it_so(catalogue, monkeypatch):
    """Once: made superfluous again it replaces none."""
    effects = catalogue(*THREE)
    given = []

    def settled(search, accepted, dropped=()):
        given.append(([one.effect.name for one in accepted], "c" in dropped))
        if len(given) == 1:
            strongest.extend(accepted)
        rounds = {2: accepted[1:], 3: [*accepted[1:], *strongest], 4: accepted[-1:]}
        return rounds.get(len(given), list(accepted))

    strongest = []
    monkeypatch.setattr(EffectTests, "retested", settled)
    data = problem(18, friction=lambda rows: A(rows) + 0.5 * B(rows) + 2.0 * C(rows))
    found = find_causes(data, effects, SETTINGS, MARGIN, discrepancy=0.0)
    assert given[:3] == [(["c"], False), (["c", "a"], False), (["a", "b"], False)]
    # it stood beside b, and then went with it
    assert given[3] == (["b", "c", "a"], False)
    assert all(is_dropped for _, is_dropped in given[4:])
    assert "c" not in names(found)


def test_an_effect_accepted_stays_and_is_fitted_beside_its_companions(catalogue):
    """Alone the first takes a part of what is the second's."""
    first = effect("first", [(1.0, A), (0.5, B)])
    second, other = effect("second", [(1.0, B)]), effect("other", [(1.0, C)])
    effects = catalogue(first, second, other)
    data = problem(12, friction=lambda rows: 0.8 * A(rows) + 1.4 * B(rows))
    search = search_of(data, effects)
    settled = search.retested([effect_fit(first, 1.0), effect_fit(second, 0.3)])
    assert [fit.effect.name for fit in settled] == ["first", "second"]
    assert [fit.coefficients[0] for fit in settled] == pytest.approx([0.8, 1.0], rel=0.08)


def test_a_single_effect_is_not_tested_again(catalogue):
    only = effect("a", [(1.0, A)])
    other = effect("b", [(1.0, B)])
    search = search_of(problem(13), catalogue(only, other))
    fits = [effect_fit(only, 7.0)]
    assert search.retested(fits) == fits


def test_what_explains_something_else_is_no_rival_however_certain_it_is(catalogue):
    """Two waves that are orthogonal, and a twin of the first."""
    twin = effect("twin", [(1.0, A), (0.01, C)])
    effects = catalogue(*THREE, twin)
    data = problem(6, friction=lambda rows: 0.3 * A(rows) + 0.6 * B(rows))
    precomputed = Precomputed.of(data, discrepancy=0.0)
    step = Step.of(precomputed, [])
    tests = step.tested(Catalogue.of(precomputed, [hypothesis_of(one, data) for one in effects]))
    own = step.refined(tests["a"].effect_fit(THREE[0]))
    factor = tests["a"].log_bayes_factor
    assert tests["b"].log_bayes_factor > factor
    found = rivals.rival_log_bayes_factors(step, own, factor, tests)
    assert found["a"] == factor
    assert "b" not in found
    assert found["twin"] == pytest.approx(factor, abs=0.1)


def test_a_rival_falls_behind_by_no_more_than_a_form_may_miss(catalogue):
    """A wave with 6 % of another: a few hundredths of the evidence are against it."""
    effects = catalogue(THREE[0], effect("near", [(1.0, A), (0.06, C)]))
    data = problem(6, friction=lambda rows: 1.5 * A(rows))
    precomputed = Precomputed.of(data, discrepancy=0.0)
    step = Step.of(precomputed, [])
    tests = step.tested(Catalogue.of(precomputed, [hypothesis_of(one, data) for one in effects]))
    own = step.refined(tests["a"].effect_fit(THREE[0]))
    factor = tests["a"].log_bayes_factor
    behind = factor - tests["near"].log_bayes_factor
    assert 0.005 * own.statistic + 1 < behind < 0.05 * own.statistic
    whole, little = (
        rivals.rival_log_bayes_factors(step, own, factor, tests, left_share)["near"]
        for left_share in (1.0, 0.3)
    )
    # a tenth of the whole is a hundredth of the evidence, and a ninth where a third is left of it
    assert whole == pytest.approx(tests["near"].log_bayes_factor + 0.005 * own.statistic)
    assert little == factor


def test_many_that_explain_nothing_are_in_no_credible_set_though_together_they_are_probable(
    catalogue,
):
    """Fifteen waves that the data do not have, each of a probability of half a percent."""
    others = [effect(f"b{number}", [(1.0, B)]) for number in range(15)]
    effects = catalogue(THREE[0], *others)
    data = problem(6, friction=lambda rows: 0.5 * A(rows))
    precomputed = Precomputed.of(data, discrepancy=0.0)
    step = Step.of(precomputed, [])
    tests = step.tested(Catalogue.of(precomputed, [hypothesis_of(one, data) for one in effects]))
    own = step.refined(tests["a"].effect_fit(THREE[0]))
    factor = tests["a"].log_bayes_factor
    low = factor - 5.2 - rivals.evidence_missed(own.statistic, 1.0)
    tests |= {one.name: replace(tests[one.name], log_bayes_factor=low) for one in others}
    found = rivals.rival_log_bayes_factors(step, own, factor, tests)
    assert credible_set(posterior_probabilities(found)) == ("a",)
    twin = replace(tests["a"], name="twin", log_bayes_factor=low)
    catalogue(*effects, effect("twin", [(1.0, A)]))
    found = rivals.rival_log_bayes_factors(step, own, factor, {**tests, "twin": twin})
    assert "twin" in found


def test_effects_that_explain_the_same_share_a_credible_set(catalogue):
    """Two effects that differ by a hundredth are one to the data; a third is another."""
    effects = catalogue(
        effect("a", [(1.0, A)]), effect("twin", [(1.0, A), (0.01, C)]), effect("b", [(1.0, B)])
    )
    found = find_causes(problem(14, friction=lambda rows: 0.5 * A(rows)), effects, SETTINGS, MARGIN)
    (cause,) = found.causes
    assert set(cause.effects) == {"a", "twin"}
    assert sum(cause.probabilities.values()) == pytest.approx(1.0, abs=2e-3)
    assert "b" not in cause.effects


def test_a_cause_beside_which_the_measurement_would_be_impossible_is_given_up(catalogue):
    """What is found beside it stays; it does not come back."""
    effects = catalogue(effect("x", [(1.0, A), (1.0, B)]), effect("c", [(1.0, C)]))
    measured = replace(effect("measured", [(1.0, B)], lower=0.0), measurement=True)
    data = problem(8, lambda rows: 1.5 * A(rows) + 0.6 * B(rows) + 0.5 * C(rows))
    found = find_causes(data, effects, SETTINGS, MARGIN, measurement=(measured,))
    assert names(found) == ["c"]
    assert found.dropped["x"].startswith("with it, the fitted measured")


def test_what_the_base_leaves_little_of_is_not_searched_for(catalogue):
    """0.05 N·m stand far out of the noise, and are less than half the margin."""
    effects = catalogue(*THREE)
    data = problem(15, friction=lambda rows: 0.05 * B(rows))
    assert names(find_causes(data, effects, SETTINGS, MARGIN)) == []
    assert names(find_causes(data, effects, SETTINGS, 0.05)) == ["b"]


def test_smooth_structure_is_no_cause_unless_it_is_much_more_than_expected(catalogue):
    """A wave as long as the discrepancy's: 0.2 % of the friction is no finding, 5 % is one."""
    long = wave(2.5, 0.3)
    effects = catalogue(effect("a", [(1.0, long)]), effect("b", [(1.0, B)]))
    for size, expected in ((0.002, []), (0.05, ["a"])):
        data = problem(15)
        torque = size * np.mean(data.friction) * np.sqrt(2) * long(data.table)
        data = replace(data, friction=data.friction + torque)
        assert names(find_causes(data, effects, SETTINGS, 0.0)) == expected
        without = find_causes(data, effects, SETTINGS, 0.0, discrepancy=0)
        assert names(without) == ["a"]


def test_bounds_forbid_a_name_in_the_search(catalogue):
    effects = catalogue(effect("a", [(1.0, A)], lower=0.0), effect("b", [(1.0, B)]))
    assert names(find_causes(problem(16, friction=A), effects, SETTINGS, MARGIN)) == ["a"]
    against = find_causes(problem(16, friction=lambda rows: -A(rows)), effects, SETTINGS, MARGIN)
    assert "a" not in names(against)


@pytest.mark.parametrize("at_once", [True, False])
def test_what_a_bound_sizes_stands_back_behind_what_explains_nearly_as_much(
    catalogue, monkeypatch, at_once
):
    """It stays in the set: which of the two is there, the data do not tell.

    It may have been accepted first, and come to lie on its bound beside what was found after it.
    """
    if not at_once:
        monkeypatch.setattr(rivals, "CLEARLY", 0.0)
    data = problem(15, friction=lambda rows: 0.08 * A(rows))
    # bounds in units of torque grow with the friction
    scale = physical_bounds(effect("any", [(1.0, A)], upper=1.0), data)[1][0]
    bounded = effect("bounded", [(1.0, A)], upper=0.07 / scale)
    other = effect("other", [(1.0, A), (0.2, C)])
    effects = catalogue(bounded, other)
    first = search_of(data, effects)
    step, tests = first.tested([])
    assert tests["bounded"].log_bayes_factor > tests["other"].log_bayes_factor
    assert lies_on_bound(step.refined(tests["bounded"].effect_fit(bounded)))
    (cause,) = find_causes(data, effects, SETTINGS, 0.01).causes
    assert cause.fit.effect.name == "other"
    assert set(cause.effects) == {"bounded", "other"}


@pytest.mark.parametrize(
    "seed", [0, *(pytest.param(seed, marks=pytest.mark.long) for seed in (1, 2, 3))]
)
def test_the_search_ends_whatever_the_catalogue(catalogue, monkeypatch, seed):
    """Nine random mixtures of five waves, alike and in each other's way, explain a tenth one."""
    generator = np.random.default_rng(seed)
    waves = [wave(order) for order in (5.0, 8.0, 11.0, 15.0, 20.0)]
    effects = catalogue(
        *(
            effect(f"e{i}", list(zip(generator.normal(size=5), waves, strict=True)))
            for i in range(9)
        )
    )
    mixed = list(zip(generator.normal(size=5), waves, strict=True))
    tried = []
    settled = EffectTests.retested

    def counted(search, accepted, dropped=()):
        tried.append([one.effect.name for one in accepted])
        # each round drops a name for good or keeps one more of at most four
        assert len(tried) <= 9 * 5
        return settled(search, accepted, dropped)

    monkeypatch.setattr(EffectTests, "retested", counted)
    data = problem(seed, friction=lambda rows: sum(a * one(rows) for a, one in mixed))
    found = find_causes(data, effects, SETTINGS, MARGIN)
    assert 1 <= len(found.causes) <= SETTINGS.most
    assert len(set(names(found))) == len(found.causes)
    assert set(found.rejected).isdisjoint(names(found))


def test_a_catalogue_of_one_effect_can_be_searched(catalogue):
    (only,) = catalogue(effect("a", [(1.0, A)]))
    assert names(find_causes(problem(17, friction=A), [only], SETTINGS, MARGIN)) == ["a"]


def test_a_harmonic_too_fine_for_a_smooth_function_is_no_ripple_of_its_own():
    """Beside one, a smooth function of the angle would take the ripple itself."""

    def ripple(rows):
        angle = np.radians(rows.position)
        return np.sin(8 * angle + 0.4) + 0.15 * np.sin(24 * angle)

    data = problem(8, friction=ripple)
    (cause,) = find_causes(data, (BY_NAME["position_ripple"],), SETTINGS, MARGIN).causes
    assert cause.fit.shape["order"] == pytest.approx(8.0, abs=0.2)
    assert cause.visible == pytest.approx(1 / np.sqrt(2), rel=0.1)
