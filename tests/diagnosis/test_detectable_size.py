"""The smallest size of an effect that is named: planted fits against effects in the data."""

from dataclasses import replace

import numpy as np
import pytest

from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.columns import misfit_column
from frictioncli.diagnosis.fit.hypotheses import hypothesis_of, physical_bounds
from frictioncli.diagnosis.fit.left_by_base import left_by
from frictioncli.diagnosis.fit.products import Products
from frictioncli.diagnosis.fit.transformed_columns import Part, TransformedColumns
from frictioncli.diagnosis.search import detectable_size as detectable
from frictioncli.diagnosis.search import planted_torque as module
from frictioncli.diagnosis.search.catalogue import Catalogue
from frictioncli.diagnosis.search.cause_search import find_causes
from frictioncli.diagnosis.search.detectable_size import SHAPES, Rules, detectable_size
from frictioncli.diagnosis.search.effect_size import left_shares
from frictioncli.diagnosis.search.planted_fits import PlantedFits
from frictioncli.diagnosis.search.planted_rivals import PlantedRivals
from frictioncli.diagnosis.search.planted_torque import error_forms, planted_torques
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.diagnosis.search.standing import with_standing
from frictioncli.diagnosis.search.step import Step
from frictioncli.diagnosis.search.structure import Structure
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.effects import BY_NAME, EFFECTS
from frictioncli.effects.base import Basis
from tests.diagnosis.dense_noise import problem

MARGIN = 0.1
LEVEL = 0.05 / 26
CHANGE = BY_NAME["step_change"]


def torques_of(data, effect, count, least_size=MARGIN):
    return planted_torques(data, effect, error_forms(data, count), least_size)


def step_of(data, discrepancy=0.0075):
    return Step.of(Precomputed.of(data, discrepancy=discrepancy), [])


def size_of(step, effect, margin=MARGIN, beside=(), **others):
    """Return the detectable size of an effect beside some rivals."""
    tried = [effect, *(BY_NAME[name] for name in beside)]
    hypotheses = [hypothesis_of(one, step.problem) for one in tried]
    catalogue = Catalogue.of(step.precomputed, hypotheses)
    test = step.tested(catalogue)[effect.name]
    forms = error_forms(step.problem, SHAPES)
    rules = {"structure": None, "unnamed": frozenset()} | others
    rules = Rules(level=LEVEL, margin=margin, forms=forms, **rules)
    return detectable_size(effect, test, rules, PlantedRivals(step, catalogue))


def planted(data: Problem, torque: Basis, size):
    """Return a problem with a torque in its data."""
    return replace(
        data,
        friction=data.friction + size * torque.friction[:, 0],
        load=data.load + size * torque.load[:, 0],
    )


def middle(name):
    return {axis.name: axis.at(0.5) for axis in BY_NAME[name].shape}


@pytest.mark.parametrize("name", ["payload_change", "position_ripple", "rest_recovery"])
def test_what_is_planted_has_its_size_and_an_error_of_form(name):
    """The size is that of the whole torque in its channel; the form misses a tenth of it."""
    data, effect = problem(0), BY_NAME[name]
    torques = torques_of(data, effect, 4)
    assert len(torques) == 4
    for one in torques:
        torque = getattr(one.torque, effect.channel)[:, 0]
        assert np.sqrt(np.mean(np.square(torque))) == pytest.approx(1.0)
        exact = getattr(one.columns, effect.channel) @ one.coefficients
        missed = torque - exact
        # relative to the whole torque, whose size an error of form changes a little
        assert np.sqrt(np.mean(np.square(missed))) == pytest.approx(0.1, abs=0.015)


def test_a_joint_need_not_brake_as_hard_as_it_accelerates():
    """Half the difference is torque in friction alone, and no larger than the inertial torque."""
    data, effect = problem(0), BY_NAME["inertia"]
    shares = []
    for one in torques_of(data, effect, 5):
        inertial, unequal = one.coefficients
        assert 0 < abs(unequal) <= abs(inertial)
        assert np.any(one.torque.friction)
        shares.append(unequal / inertial)
    assert min(shares) < 0 < max(shares)


def test_changes_are_planted_evenly_in_time_however_the_pairs_lie_in_it():
    """Pairs in the first tenth of the time, and as many in the rest of it."""
    data = problem(0)
    clock = data.table.clock - data.table.clock.min()
    half, whole = float(np.median(clock)), float(clock.max())
    late = 0.1 + 0.9 * (clock - half) / (whole - half)
    clock = whole * np.where(clock < half, 0.1 * clock / half, late)
    tables = {name: replace(getattr(data, name), clock=clock) for name in ("table", "all_runs")}
    moments = [one.shape["moment"] for one in torques_of(replace(data, **tables), CHANGE, 5)]
    times = whole * np.array([0.26, 0.38, 0.5, 0.62, 0.74])
    expected = [np.mean(clock < time) for time in times]
    assert min(expected) > 0.5
    np.testing.assert_allclose(moments, expected)


def test_what_would_need_an_impossible_coefficient_is_not_planted():
    """Boundary friction that has fallen to little at the lowest speed of a log."""
    data, effect = problem(0), BY_NAME["stribeck"]
    _, (most,) = physical_bounds(effect, data)
    for least_size in (0.01, 1.0):
        torques = torques_of(data, effect, 5, least_size)
        assert len(torques) == 5
        assert all(least_size * one.coefficients[0] <= most for one in torques)
    slow = [
        min(one.shape["velocity"] for one in torques_of(data, effect, 5, least))
        for least in (0.0, 1.0)
    ]
    assert slow[0] < slow[1]


def test_a_torque_is_planted_into_inner_products_as_into_the_data():
    """All inner products of the data with the torque, worked out from the columns."""
    data = problem(0)
    step, torque = step_of(data), torques_of(data, BY_NAME["dress_pack"], 1)[0].torque
    found = step.planted(torque, np.array([2.5]))
    there = misfit_column(planted(data, torque, 2.5))
    *parts, _ = step.columns.parts
    columns = TransformedColumns((*parts, Part(there, step.precomputed.noises)))
    expected = Products.of(columns)
    for channel in (0, 1):
        one, two = found.products.within[channel], expected.within[channel]
        np.testing.assert_allclose(one, two, atol=1e-9 * float(np.abs(two).max()))
        for noise in range(len(columns.noises.indices)):
            one, two = (this.between(channel, noise) for this in (found.products, expected))
            np.testing.assert_allclose(one, two, atol=1e-9 * float(np.abs(two).max()))


@pytest.mark.parametrize(
    ("name", "size"), [("load_linear", 3.0), ("step_change", 0.6), ("dress_pack", 2.0)]
)
def test_the_statistic_is_that_of_the_effect_in_the_data(name, size):
    """The effect is added to the torques, and everything is fitted again."""
    data, effect = problem(1, drift=0.2), BY_NAME[name]
    torques = torques_of(data, effect, 3)
    fits = PlantedFits.of(step_of(data), torques)
    for number, one in enumerate(torques):
        fits.add_best(number, size)
        expected = fits.fitted(number, size).fit
        found = step_of(planted(data, one.torque, size)).fitted(effect, one.shape)
        assert expected.statistic == pytest.approx(found.statistic, rel=0.25, abs=1.0)
        np.testing.assert_allclose(
            expected.coefficients, found.coefficients, rtol=0.2, atol=0.05 * size
        )


def test_drift_takes_a_slow_effect_the_more_the_larger_it_is():
    """Four times the statistic at twice the size is what fixed variances would give."""
    data = problem(1, drift=0.6, drift_time=9000.0)
    fits = PlantedFits.of(step_of(data), torques_of(data, BY_NAME["drift"], 1))
    for size in (4.0, 8.0):
        fits.add_best(0, size)
    small, large = (fits.fitted(0, size).fit.statistic for size in (4.0, 8.0))
    assert 0 < large < 3 * small


def test_nothing_below_the_margin_is_claimed():
    step, ripple = step_of(problem(0)), BY_NAME["position_ripple"]
    sizes = [size_of(step, ripple, margin) for margin in (MARGIN, 10 * MARGIN)]
    assert MARGIN < sizes[0] < 2 * MARGIN
    assert 10 * MARGIN < sizes[1] < 20 * MARGIN


def test_an_effect_along_structure_without_a_name_must_be_larger_than_it():
    """Three times: else both may be one thing that no effect explains."""
    structure = Structure(
        axes=("position",),
        channel="friction",
        p_value=1e-9,
        statistic=50.0,
        size=0.5,
        interval=(0.4, 0.6),
    )
    step, ripple = step_of(problem(0)), BY_NAME["position_ripple"]
    assert 1.35 < size_of(step, ripple, structure=structure) < 1.8
    elsewhere = replace(structure, axes=("speed",))
    assert size_of(step, ripple, structure=elsewhere) < 2 * MARGIN


def test_what_would_be_impossible_has_no_size():
    """Ripple bounded to a tenth of the margin."""
    ripple = BY_NAME["position_ripple"]
    bounded = tuple(
        replace(one, lower=-MARGIN / 10, upper=MARGIN / 10) for one in ripple.coefficients
    )
    assert size_of(step_of(problem(0)), replace(ripple, coefficients=bounded)) is None


def test_no_size_is_claimed_where_the_base_leaves_no_more_than_a_form_misses(monkeypatch):
    """The base leaves a tenth of a load's amount, and a form misses as much."""
    step, effect = step_of(problem(0)), BY_NAME["load_linear"]
    torque = step.problem.basis(effect, {})
    assert left_shares(step.precomputed, [torque])[0] == pytest.approx(0.1, abs=0.02)
    assert size_of(step, effect) is None
    monkeypatch.setattr(module, "_FORM", 0.0)
    monkeypatch.setattr(detectable, "_LEAST_LEFT", 0.0)
    assert size_of(step, effect) > 10 * MARGIN


def test_what_a_form_misses_refuses_a_name_only_above_the_margin(monkeypatch):
    """A tenth of a ripple that is named from the margin on is below it; as much again is not."""
    step, ripple = step_of(problem(0)), BY_NAME["position_ripple"]
    claimed = size_of(step, ripple)
    # all that is missed is beyond doubt, and counts however small it is beside the effect
    monkeypatch.setattr(detectable, "_STRUCTURE", 0.0)
    monkeypatch.setattr(detectable, "MOST_LEFT", 0.0)
    assert size_of(step, ripple) == claimed
    monkeypatch.setattr(module, "_FORM", 1.0)
    assert size_of(step, ripple) is None


def test_what_is_missed_beside_an_effect_is_what_least_squares_leave():
    """A torque with an eighth of another ripple: no coefficients of its own explain that."""
    step, ripple = step_of(problem(0)), BY_NAME["position_ripple"]
    one, other = (torques_of(step.problem, ripple, 2)[number] for number in (0, 1))
    exact = [
        Basis(*(columns @ this.coefficients[:, np.newaxis] for columns in this.columns))
        for this in (one, other)
    ]
    mixed = replace(one, torque=Basis(*(a + b / 8 for a, b in zip(*exact, strict=True))))
    columns = np.hstack([np.vstack(one.columns), np.vstack(exact[1])])
    left = left_by(step.precomputed.span, Basis(*np.split(columns, 2)))
    last = np.linalg.qr(left)[1][-1, -1]
    expected = abs(last) / 8 / np.sqrt(len(step.problem.rows))
    assert detectable._share_missed(step, mixed) == pytest.approx(expected, rel=1e-6)


@pytest.mark.long
@pytest.mark.parametrize("name", ["load_temperature", "step_change", "position_ripple"])
def test_the_claimed_size_is_named_and_half_of_it_is_not(name):
    """The whole search on ten joints each, whose noise the claim has not seen."""
    settings = DiagnosisSettings()
    found = find_causes(problem(0, drift=0.2), EFFECTS, settings, MARGIN)
    claimed = found.detectable_sizes([BY_NAME[name]], settings.alpha, MARGIN)[name]
    named = {}
    for factor in (0.4, 1.5):
        named[factor] = 0
        for seed in range(1, 7):
            data = problem(seed, drift=0.2)
            torque = torques_of(data, BY_NAME[name], 6)[seed - 1].torque
            data = planted(data, torque, factor * claimed)
            causes = find_causes(data, EFFECTS, settings, MARGIN).causes
            judged = with_standing(causes, data, MARGIN, settings.alpha)
            named[factor] += any(one.standing == "named" and name in one.effects for one in judged)
    assert named[1.5] >= 5
    assert named[0.4] <= 1


def test_the_size_of_what_is_named_is_that_without_it_however_its_entry_was_changed():
    """A lag of the gear whose network was found has columns for its parts only: another entry."""
    effect, settings = BY_NAME["direction_asymmetry"], DiagnosisSettings()
    data = problem(0)
    data = planted(data, torques_of(data, effect, 1)[0].torque, 1.0)
    found = find_causes(data, [effect], settings, MARGIN)
    (cause,) = found.causes
    other = replace(cause, fit=replace(cause.fit, effect=replace(effect, summary="other")))
    sizes = [
        one.detectable_sizes([effect], settings.alpha, MARGIN)
        for one in (found, replace(found, causes=(other,)))
    ]
    assert MARGIN < sizes[0]["direction_asymmetry"] < 1.0
    assert sizes[1] == sizes[0]
