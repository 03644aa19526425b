"""The search: what noise gives, what is accepted, swapped or dropped, and that it ends."""

from dataclasses import replace

import numpy as np
import pytest

from frictioncli.diagnosis import search
from frictioncli.diagnosis.adequacy import structures
from frictioncli.diagnosis.bench import Bench, Catalogue
from frictioncli.diagnosis.columns import hypothesis_of
from frictioncli.diagnosis.judged import Score
from frictioncli.diagnosis.search import find_causes
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.diagnosis.step import Step
from frictioncli.effects import BY_NAME
from frictioncli.effects.base import Basis, Effect, Parameter, Signature
from tests.diagnosis.noises import problem

SETTINGS = DiagnosisSettings()


def judged(data, names, draws=0, seed=0, accepted=()):
    bench = Bench.of(data)
    step = Step.of(bench, accepted)
    catalogue = Catalogue.of(bench, [hypothesis_of(BY_NAME[name], data) for name in names])
    return step, step.judged(catalogue, seed, draws)


def wave(order, phase=0.0):
    """Return a torque that repeats over the angle; orders differ enough to be nearly orthogonal."""
    return lambda rows: np.sin(order * np.radians(rows.position) + phase)


def effect(name, *waves, lower=-50.0, upper=50.0):
    """Return an effect of friction with one column, or several, that are sums of waves."""

    def basis(table):
        columns = np.column_stack([sum(a * one(table) for a, one in column) for column in waves])
        return Basis(columns, np.zeros_like(columns))

    coefficients = tuple(
        Parameter(
            name=f"c{i}", symbol="c", unit="torque", lower=lower, upper=upper, description="any"
        )
        for i in range(len(waves))
    )
    return Effect(
        name=name,
        summary="Any.",
        equation="c",
        source="test",
        channel="friction",
        shape=(),
        coefficients=coefficients,
        basis=basis,
        needs=("position",),
        signature=Signature(axis="position", claim="Any."),
        confounders=(),
        experiment="Any.",
    )


A, B, C = wave(7.0), wave(11.0, 0.4), wave(17.0, 1.0)


THREE = effect("a", [(1.0, A)]), effect("b", [(1.0, B)]), effect("c", [(1.0, C)])


@pytest.fixture
def catalogue(monkeypatch):
    """Make the search know other effects than those of the catalogue."""

    def known(*effects):
        monkeypatch.setattr(search, "BY_NAME", {one.name: one for one in effects})
        return effects

    return known


def names(found):
    return sorted(cause.score.effect.name for cause in found.causes)


# what noise gives

DRIFTS = ({"drift": 0.2}, {"drift": 0.6, "drift_time": 120.0}, {"drift": 1.0, "drift_time": 9000.0})
ASKED = (
    "linear_viscous",
    "coulomb_temperature",
    "load_linear",
    "drift",
    "thermal_lag",
    "dress_pack",
)


def test_noise_passes_no_more_often_than_its_p_values_say():
    """30 problems with three kinds of drift, six effects each."""
    least, single = [], []
    for seed in range(30):
        _, found = judged(problem(seed, **DRIFTS[seed % 3]), ASKED, draws=200, seed=seed)
        least.append(min(one.p_value for one in found.values()))
        single += [one.chance.beyond(one.statistic) for one in found.values()]
    # of 30 at 5 % and 20 %: more than 5 and 12 have chances of 0.3 and 0.3 %
    assert np.sum(np.array(least) < 0.05) <= 5
    assert np.sum(np.array(least) < 0.2) <= 12
    # 180 that are not independent: twice the standard deviation is about 5 %
    assert np.mean(np.array(single) < 0.05) < 0.1
    assert 0.25 < np.mean(np.array(single) < 0.5) < 0.65


BOTH_WAYS = ("linear_viscous", "load_linear", "direction_asymmetry", "dress_pack")


def test_draws_give_what_fresh_noise_gives():
    """Mean of 100 statistics beside that of the draws; more than a quarter above is no chance.

    Friction goes with the square of the load, so what a spring does to gravity shows in friction
    too, and shapes that are alike in the load channel alone are several tries.
    """
    data = problem(20)
    pair, count = data.layout.row_pair, len(data.layout.time)
    gravity = data.load_base @ data.gravity
    generator = np.random.default_rng(21)

    def noisy():
        means, rows = generator.normal(size=(2, count)), 0.3 * generator.normal(size=(2, len(pair)))
        return replace(
            data,
            friction=data.table.friction + 0.3 * means[0][pair] + rows[0],
            load=gravity + 0.1 * means[1][pair] + rows[1],
        )

    _, told = judged(noisy(), BOTH_WAYS, draws=1000)
    fresh = [judged(noisy(), BOTH_WAYS)[1] for _ in range(100)]
    for name, one in told.items():
        drawn = one.chance.shape * one.chance.scale
        assert np.mean([found[name].statistic for found in fresh]) < 1.25 * drawn, name


def test_noise_has_no_structure_beyond_chance():
    """The least of fifteen p-values, in 4 problems."""
    least = []
    for seed in range(4):
        data = problem(seed, **DRIFTS[seed % 3])
        step = Step.of(Bench.of(data), [])
        found = structures(step, seed)
        assert found == sorted(found, key=lambda one: one.p_value)
        least.append(found[0].p_value)
    assert np.sum(np.array(least) < 0.05) <= 1


# what one step says


def test_without_draws_nothing_is_called_unlikely():
    _, found = judged(problem(0, friction=lambda rows: 3.0 * A(rows)), ["position_ripple"])
    assert found["position_ripple"].p_value == 1.0
    assert found["position_ripple"].statistic > 1000


def test_an_effect_s_score_does_not_depend_on_who_else_is_asked():
    data = problem(2, friction=lambda rows: 0.05 * A(rows))
    _, alone = judged(data, ["load_linear"], draws=50)
    _, many = judged(data, ["inertia", "load_linear", "drift"], draws=50)
    assert many["load_linear"].statistic == pytest.approx(alone["load_linear"].statistic, abs=1e-9)
    assert many["load_linear"].evidence == pytest.approx(alone["load_linear"].evidence, abs=1e-9)
    one = many["load_linear"]
    assert one.p_value == min(1.0, 3 * one.chance.beyond(one.statistic))


def test_the_same_seed_gives_the_same_chance():
    data = problem(3)
    first, again, other = (
        judged(data, ["drift", "inertia"], draws=40, seed=seed)[1]["inertia"].chance
        for seed in (5, 5, 6)
    )
    assert first == again != other


@pytest.mark.parametrize(("name", "channel"), [("load_linear", "friction"), ("dress_pack", "load")])
def test_a_size_is_the_torque_of_its_white_length(name, channel):
    """Planted with an RMS of ten white lengths the statistic is 100, and 1 by chance."""
    effect = BY_NAME[name]
    statistics = []
    for seed in range(12):
        step, found = judged(problem(seed), [name])
        one = found[name]
        shape = {axis.name: axis.at(0.5) for axis in effect.shape}
        alone = Catalogue.of(step.bench, [hypothesis_of(effect, step.problem, [shape])])
        scale = step.judged(alone, 0, 0)[name].size_scale
        column = getattr(step.problem.basis(effect, shape), channel)[:, 0]
        planted = 10 * scale * column / np.sqrt(np.mean(np.square(column)))
        data = replace(step.problem, **{channel: getattr(step.problem, channel) + planted})
        bench = Bench.of(data)
        alone = Catalogue.of(bench, [hypothesis_of(effect, data, [shape])])
        statistics.append(Step.of(bench, []).judged(alone, 0, 0)[name].statistic)
        assert one.size_scale > 0
    # one has a standard deviation of 20, their mean of 6
    assert np.mean(statistics) == pytest.approx(101, abs=24)


@pytest.mark.parametrize("name", ["load_linear", "linear_viscous", "run_in"])
def test_what_physics_forbids_explains_nothing(name):
    """Friction that falls where the effect can only add some."""
    effect = BY_NAME[name]
    shape = {axis.name: axis.at(0.5) for axis in effect.shape}
    clean = problem(4)
    column = clean.basis(effect, shape).friction[:, 0]
    size = 1.5 / np.std(column)
    forbidden, allowed = (
        judged(replace(clean, friction=clean.friction + sign * size * column), [name], draws=50)[1][
            name
        ]
        for sign in (-1.0, 1.0)
    )
    assert allowed.statistic > 25
    assert allowed.p_value < 1e-3
    assert allowed.coefficients[0] > 0
    assert forbidden.statistic < 0.2 * allowed.statistic
    if not effect.shape:
        assert (forbidden.statistic, forbidden.p_value) == (0.0, 1.0)
        assert forbidden.evidence < 0


def test_the_noise_of_a_step_is_that_of_the_data():
    """Rows 0.3, pair means of 0.25 and 0.2 in friction, 0.1 in load: medians of 9 problems."""
    noise = [Step.of(Bench.of(problem(seed)), []).noise() for seed in range(9)]
    for number, between in ((0, np.hypot(0.25, 0.2)), (1, 0.1)):
        point = np.median([one[number].point for one in noise])
        pair = np.median([np.hypot(one[number].pair, one[number].drift) for one in noise])
        assert point == pytest.approx(0.3, rel=0.03)
        assert pair == pytest.approx(between, rel=0.25)


def test_a_shape_is_refined_off_its_grid():
    """An order of 9.3 lies between 9 and 9.5 of the grid; amplitude 1 with a phase of 0.4."""
    data = problem(5, friction=wave(9.3, 0.4))
    step, found = judged(data, ["position_ripple"])
    effect = BY_NAME["position_ripple"]
    coarse = found["position_ripple"]
    assert coarse.shape["order"] in (9.0, 9.5)
    fine = step.refined(coarse.score(effect))
    assert fine.shape["order"] == pytest.approx(9.3, abs=0.03)
    assert fine.statistic > coarse.statistic
    sine, cosine, *second = fine.coefficients
    assert np.hypot(sine, cosine) == pytest.approx(1.0, rel=0.05)
    assert np.abs(second).max() < 0.1
    assert step.size(fine) == pytest.approx(1 / np.sqrt(2), rel=0.05)


def test_a_size_is_visible_as_far_as_the_base_cannot_take_it():
    """A constant torque with a wave on it: the base takes the constant."""
    only = effect("any", [(1.0, C), (3.0, lambda rows: np.ones_like(rows.position))])
    data = problem(6, friction=lambda rows: 2.0 * C(rows))
    step = Step.of(Bench.of(data), [])
    score = Score(only, {}, np.array([2.0]), np.eye(1), 1.0)
    assert step.size(score) == pytest.approx(np.sqrt(2.0 + 36.0), rel=0.02)
    assert step.visible(score) == pytest.approx(np.sqrt(2.0), rel=0.1)


def test_accepted_effects_are_part_of_the_base():
    data = problem(7, friction=lambda rows: 1.0 * A(rows) + 1.0 * B(rows))
    first, second = effect("a", [(1.0, A)]), effect("b", [(1.0, B)])
    bench = Bench.of(data)
    accepted = Score(first, {}, np.array([1.0]), np.eye(1), 1.0)
    step = Step.of(bench, [accepted])
    assert step.base.count == Step.of(bench, []).base.count + 1
    both = Catalogue.of(bench, [hypothesis_of(one, data) for one in (first, second)])
    found = step.judged(both, 0, 0)
    assert found["a"].freedom == 0
    assert found["a"].statistic == 0.0
    assert found["b"].coefficients[0] == pytest.approx(1.0, rel=0.05)
    assert step.point[0] < Step.of(bench, []).point[0]


# the search


def test_causes_are_found_one_after_another_and_the_strongest_comes_first(catalogue):
    effects = catalogue(*THREE)
    data = problem(8, friction=lambda rows: 0.5 * A(rows) + 1.0 * C(rows))
    found = find_causes(data, effects, SETTINGS)
    assert [cause.score.effect.name for cause in found.causes] == ["c", "a"]
    for cause, size in zip(found.causes, (1.0, 0.5), strict=True):
        assert cause.score.coefficients[0] == pytest.approx(size, rel=0.06)
        assert cause.size == pytest.approx(size / np.sqrt(2), rel=0.06)
        assert cause.effects == (cause.score.effect.name,)
        assert cause.judged.p_value < 1e-6
    assert set(found.last) == {"b"}
    assert [score.effect.name for score in found.step.accepted] == ["c", "a"]


def test_nothing_is_found_in_noise(catalogue):
    effects = catalogue(*THREE)
    found = find_causes(problem(9), effects, SETTINGS)
    assert found.causes == ()
    assert set(found.last) == {"a", "b", "c"}


def test_no_more_causes_than_wanted(catalogue):
    effects = catalogue(*THREE)
    data = problem(8, friction=lambda rows: A(rows) + B(rows) + C(rows))
    fewer = find_causes(
        data, [*effects, effect("d", [(1.0, wave(23.0))])], replace(SETTINGS, most=2)
    )
    assert len(fewer.causes) == 2


def test_a_first_wrong_name_is_replaced(catalogue):
    """One mixture looks like two causes at once, until one of them stands beside it."""
    mixture = effect("mixture", [(1.0, A), (1.0, B), (0.3, C)])
    effects = catalogue(mixture, effect("a", [(1.0, A)]), effect("b", [(1.0, B)]))
    data = problem(10, friction=lambda rows: A(rows) + 0.6 * B(rows))
    bench = Bench.of(data)
    first = Step.of(bench, []).judged(
        Catalogue.of(bench, [hypothesis_of(one, data) for one in effects]), 0, 0
    )
    assert max(first, key=lambda name: first[name].evidence) == "mixture"
    found = find_causes(data, effects, SETTINGS)
    assert [cause.score.effect.name for cause in found.causes] == ["a", "b"]
    for cause, size in zip(found.causes, (1.0, 0.6), strict=True):
        assert cause.score.coefficients[0] == pytest.approx(size, rel=0.05)


def hunting(data, effects):
    bench = Bench.of(data)
    hypotheses = Catalogue.of(bench, [hypothesis_of(one, data) for one in effects])
    return search._Hunt(bench, hypotheses, SETTINGS, None)


def guessed(one, *coefficients):
    return Score(one, {}, np.array(coefficients), np.eye(len(coefficients)), 50.0)


def test_an_effect_that_others_made_needless_goes(catalogue):
    mixture = effect("mixture", [(1.0, A), (1.0, B), (0.4, C)])
    pair = effect("pair", [(1.0, A)], [(1.0, B)])
    catalogue(mixture, pair)
    data = problem(11, friction=lambda rows: A(rows) + B(rows))
    hunt = hunting(data, (mixture, pair))
    left = hunt.settled([guessed(mixture, 1.0), guessed(pair, 0.0, 0.0)])
    assert [score.effect.name for score in left] == ["pair"]


def test_a_name_changes_where_another_fits_clearly_better_beside_the_others(catalogue):
    """The mixture's part beside the first wave is the second wave, and nothing else."""
    mixture = effect("mixture", [(1.0, A), (1.0, B), (0.3, C)])
    first, second, _ = THREE
    catalogue(mixture, *THREE)
    data = problem(10, friction=lambda rows: A(rows) + 0.6 * B(rows))
    left = hunting(data, (mixture, *THREE)).settled([guessed(mixture, 0.8), guessed(first, 0.3)])
    assert [score.effect for score in left] == [second, first]
    assert [score.coefficients[0] for score in left] == pytest.approx([0.6, 1.0], rel=0.05)


def test_what_was_dropped_does_not_come_back(catalogue, monkeypatch):
    """Even if the newest is always found needless, each is tried once, the strongest first."""
    effects = catalogue(*THREE)
    tried = []

    def fickle(hunt, accepted):
        tried.append(accepted[-1].effect.name)
        assert len(tried) < 10
        return accepted[:-1]

    monkeypatch.setattr(search._Hunt, "settled", fickle)
    data = problem(18, friction=lambda rows: A(rows) + 0.5 * B(rows) + 2.0 * C(rows))
    assert find_causes(data, effects, SETTINGS).causes == ()
    assert tried == ["c", "a", "b"]


def test_an_effect_accepted_stays_and_is_fitted_beside_its_companions(catalogue):
    """Alone the first takes a part of what is the second's."""
    first = effect("first", [(1.0, A), (0.5, B)])
    second, other = effect("second", [(1.0, B)]), effect("other", [(1.0, C)])
    effects = catalogue(first, second, other)
    data = problem(12, friction=lambda rows: 0.8 * A(rows) + 1.4 * B(rows))
    hunt = hunting(data, effects)
    settled = hunt.settled([guessed(first, 1.0), guessed(second, 0.3)])
    assert [score.effect.name for score in settled] == ["first", "second"]
    assert [score.coefficients[0] for score in settled] == pytest.approx([0.8, 1.0], rel=0.08)


def test_a_lonely_effect_is_not_judged_again(catalogue):
    only = effect("a", [(1.0, A)])
    other = effect("b", [(1.0, B)])
    hunt = hunting(problem(13), catalogue(only, other))
    scores = [guessed(only, 7.0)]
    assert hunt.settled(scores) == scores


def test_what_could_take_a_part_joins_its_credible_set(catalogue):
    """Two effects that differ by a hundredth are one to the data; a third is another."""
    effects = catalogue(
        effect("a", [(1.0, A)]), effect("twin", [(1.0, A), (0.01, C)]), effect("b", [(1.0, B)])
    )
    found = find_causes(problem(14, friction=lambda rows: 0.5 * A(rows)), effects, SETTINGS)
    (cause,) = found.causes
    assert set(cause.effects) == {"a", "twin"}
    assert sum(cause.probabilities.values()) == pytest.approx(1.0, abs=2e-3)
    assert "b" not in cause.effects


def test_rough_edges_of_a_great_effect_are_no_cause_of_their_own(catalogue):
    """0.05 beside 10 is nothing, and stands far out of the noise when alone."""
    effects = catalogue(*THREE)
    alone = find_causes(problem(15, friction=lambda rows: 0.05 * B(rows)), effects, SETTINGS)
    assert names(alone) == ["b"]
    beside = problem(15, friction=lambda rows: 10.0 * A(rows) + 0.05 * B(rows))
    assert names(find_causes(beside, effects, SETTINGS)) == ["a"]


def test_bounds_forbid_a_name_in_the_search(catalogue):
    effects = catalogue(effect("a", [(1.0, A)], lower=0.0), effect("b", [(1.0, B)]))
    assert names(find_causes(problem(16, friction=A), effects, SETTINGS)) == ["a"]
    against = find_causes(problem(16, friction=lambda rows: -A(rows)), effects, SETTINGS)
    assert "a" not in names(against)


@pytest.mark.parametrize("seed", range(4))
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
    settled = search._Hunt.settled

    def counted(hunt, accepted):
        tried.append([one.effect.name for one in accepted])
        # each round drops a name for good or keeps one more of at most four
        assert len(tried) <= 9 * 5
        return settled(hunt, accepted)

    monkeypatch.setattr(search._Hunt, "settled", counted)
    data = problem(seed, friction=lambda rows: sum(a * one(rows) for a, one in mixed))
    found = find_causes(data, effects, SETTINGS)
    assert 1 <= len(found.causes) <= SETTINGS.most
    assert len(set(names(found))) == len(found.causes)
    assert set(found.last).isdisjoint(names(found))


def test_a_catalogue_of_one_effect_can_be_searched(catalogue):
    (only,) = catalogue(effect("a", [(1.0, A)]))
    assert names(find_causes(problem(17, friction=A), [only], SETTINGS)) == ["a"]
