"""What every entry of the catalogue guarantees."""

from dataclasses import FrozenInstanceError, replace
from itertools import product

import numpy as np
import pytest

from frictioncli.effects import BY_NAME, EFFECTS, NEEDS
from frictioncli.effects.availability import judgeable, missing_columns
from frictioncli.effects.base import Parameter
from tests.effects.tables import COLUMNS, selected, two_days

CONTRACT = [
    "stribeck",
    "velocity_exponent",
    "linear_viscous",
    "quadratic_drag",
    "coulomb_temperature",
    "load_linear",
    "load_velocity",
    "load_temperature",
    "thermal_lag",
    "drift",
    "run_in",
    "rest_recovery",
    "step_change",
    "direction_asymmetry",
    "torque_constant",
    "payload_change",
    "dress_pack",
    "position_ripple",
    "inertia",
    "reversal_transient",
]

LOAD_ONLY = {"direction_asymmetry", "payload_change", "dress_pack"}
BOTH = {"torque_constant", "inertia", "reversal_transient"}
FRICTION_ONLY = set(CONTRACT) - LOAD_ONLY - BOTH

ANGLE_DEPENDENT = {
    "load_linear",
    "load_velocity",
    "load_temperature",
    "torque_constant",
    "payload_change",
    "dress_pack",
    "position_ripple",
    "inertia",
    "reversal_transient",
}

every_effect = pytest.mark.parametrize("effect", EFFECTS, ids=lambda effect: effect.name)


@pytest.fixture(scope="module")
def table():
    return two_days()


def middle(effect):
    """Return the middle of each shape parameter's grid."""
    return {
        parameter.name: float(parameter.grid()[parameter.points // 2]) for parameter in effect.shape
    }


def corners(effect):
    """Return all combinations of bounds and middle of the shape parameters."""
    names = [parameter.name for parameter in effect.shape]
    values = [(p.lower, middle(effect)[p.name], p.upper) for p in effect.shape]
    return [dict(zip(names, shape, strict=True)) for shape in product(*values)]


def test_catalogue_holds_the_names_of_the_contract_in_order():
    assert [effect.name for effect in EFFECTS] == CONTRACT
    assert list(BY_NAME) == list(NEEDS) == CONTRACT


@every_effect
def test_basis_has_one_finite_column_per_coefficient(effect, table):
    for shape in corners(effect):
        basis = effect.evaluate(table, shape)
        for channel in basis:
            assert channel.shape == (len(table.run), len(effect.coefficients))
            assert np.isfinite(channel).all()


@every_effect
def test_every_column_is_well_scaled(effect, table):
    basis = effect.evaluate(table, middle(effect))
    size = np.sqrt(np.mean(np.square(basis.friction) + np.square(basis.load), axis=0))
    assert np.all((size > 0.03) & (size < 300.0)), size


@every_effect
def test_untouched_channel_is_zero(effect, table):
    basis = effect.evaluate(table, middle(effect))
    assert bool(np.any(basis.friction)) == (effect.name in FRICTION_ONLY | BOTH)
    assert bool(np.any(basis.load)) == (effect.name in LOAD_ONLY | BOTH)
    assert np.any(getattr(basis, effect.channel))


@every_effect
def test_effect_is_constant_within_pairs_unless_it_knows_the_angle(effect, table):
    basis = effect.evaluate(table, middle(effect))
    whole = np.hstack(basis)
    heads = np.searchsorted(table.pair, table.pair)
    constant = np.array_equal(whole, whole[heads])
    assert constant == (effect.name not in ANGLE_DEPENDENT)


@every_effect
def test_basis_is_deterministic_and_leaves_the_table_alone(effect, table):
    before = {name: getattr(table, name).copy() for name in COLUMNS}
    first, second = (effect.evaluate(table, middle(effect)) for _ in range(2))
    np.testing.assert_array_equal(np.hstack(first), np.hstack(second))
    for name, values in before.items():
        np.testing.assert_array_equal(getattr(table, name), values)


@every_effect
def test_basis_reads_no_column_that_is_not_declared(effect, table):
    declared = {"run", "pair", *effect.needs, *effect.uses}
    unknown = {name: np.full(len(table.run), np.nan) for name in COLUMNS if name not in declared}
    np.testing.assert_array_equal(
        np.hstack(effect.evaluate(replace(table, **unknown), middle(effect))),
        np.hstack(effect.evaluate(table, middle(effect))),
    )


@every_effect
def test_every_declared_column_matters(effect, table):
    expected = np.hstack(effect.evaluate(table, middle(effect)))
    factor = dict.fromkeys(COLUMNS, 1.0 + np.arange(len(table.pair)) % 7)
    factor |= {"time": 1.3, "clock": -1.0, "order": 2.0, "rest": 0.5}
    for name in (*effect.needs, *effect.uses):
        changed = replace(table, **{name: getattr(table, name) * factor[name]})
        found = np.hstack(effect.evaluate(changed, middle(effect)))
        assert not np.array_equal(found, expected), name


@every_effect
def test_only_angles_of_the_same_pair_and_neighbours_in_time_matter(effect, table):
    """Rows in another order of angles give the same values, row by row."""
    rows = np.lexsort((-table.position, table.pair))
    np.testing.assert_allclose(
        np.hstack(effect.evaluate(selected(table, rows), middle(effect))),
        np.hstack(effect.evaluate(table, middle(effect)))[rows],
        rtol=1e-12,
        atol=1e-12,
    )


@pytest.mark.parametrize("name", ["thermal_lag", "run_in", "rest_recovery"])
def test_what_integrates_restarts_with_each_run(name, table):
    """The second day alone gives what it gives after the first one."""
    effect = BY_NAME[name]
    shape = middle(effect) | ({"carried_over": 0.0} if name == "run_in" else {})
    second = table.run == 1
    alone = effect.evaluate(selected(table, second), shape).friction[:, 0]
    after = effect.evaluate(table, shape).friction[second, 0]
    np.testing.assert_allclose(alone, after, rtol=1e-12, atol=1e-12)


@every_effect
def test_bounds_hold_zero_so_that_the_effect_can_be_absent(effect):
    assert effect.coefficients
    for parameter in effect.coefficients:
        assert parameter.lower <= 0.0 <= parameter.upper
        assert np.isfinite([parameter.lower, parameter.upper]).all()


@every_effect
def test_grid_runs_from_bound_to_bound(effect):
    for parameter in effect.shape:
        grid = parameter.grid()
        assert len(grid) == parameter.points >= 2
        assert np.all(np.diff(grid) > 0)
        assert grid[[0, -1]] == pytest.approx([parameter.lower, parameter.upper])


@every_effect
def test_texts_are_there_and_symbols_stand_in_the_equation(effect):
    texts = [effect.summary, effect.equation, effect.source, effect.experiment]
    texts.append(effect.signature.claim)
    for parameter in (*effect.shape, *effect.coefficients):
        texts += [parameter.name, parameter.symbol, parameter.unit, parameter.description]
        assert parameter.symbol in effect.equation
    assert all(text.strip() for text in texts)
    for sentence in (effect.summary, effect.experiment, effect.signature.claim):
        assert sentence.endswith(".")
    names = [parameter.name for parameter in (*effect.shape, *effect.coefficients)]
    assert len(set(names)) == len(names)


@every_effect
def test_references_to_columns_and_effects_exist(effect):
    assert effect.needs
    assert {*effect.needs, *effect.uses, effect.signature.axis} <= set(COLUMNS)
    assert not set(effect.needs) & set(effect.uses)
    assert effect.confounders
    assert set(effect.confounders) <= set(CONTRACT) - {effect.name}
    assert bool(effect.mirror) or effect.name not in BOTH


@every_effect
def test_effect_without_a_needed_column_is_left_out(effect, table):
    assert missing_columns(effect, table) == ()
    for name in effect.needs:
        rows = len(table.run)
        for values in (np.full(rows, np.nan), np.full(rows, 20.0)):
            poorer = replace(table, **{name: values})
            assert missing_columns(effect, poorer) == (name,)
            assert effect not in judgeable(EFFECTS, poorer)


def test_all_effects_can_be_judged_on_two_full_days(table):
    assert judgeable(EFFECTS, table) == EFFECTS


def test_effects_cannot_be_changed():
    with pytest.raises(FrozenInstanceError):
        EFFECTS[0].name = "other"


@pytest.mark.parametrize(
    "wrong", [{"lower": 2.0}, {"search": "logarithmic"}], ids=["bounds", "logarithm of zero"]
)
def test_impossible_parameters_are_refused(wrong):
    valid = {"name": "p", "symbol": "p", "unit": "1", "lower": 0.0, "upper": 1.0}
    with pytest.raises(ValueError, match="p: "):
        Parameter(**(valid | {"description": "any"} | wrong))
