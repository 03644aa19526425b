"""What every entry of the catalogue guarantees."""

from dataclasses import FrozenInstanceError, replace
from itertools import product
from string import Formatter

import numpy as np
import pytest

from frictioncli.effects import BY_NAME, EFFECTS, MEASUREMENT_EFFECTS, NEEDS, RIVALS
from frictioncli.effects.base import applicable, missing_columns
from frictioncli.effects.parameter import Parameter
from tests.effects.tables import COLUMNS, selected, small, two_days

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

MEASUREMENT = ["load_offset", "torque_delay", "torque_filter", "backlash", "sensor_lag"]

LOAD_ONLY = {"direction_asymmetry", "dress_pack"}
BOTH = {
    "torque_constant",
    "payload_change",
    "torque_scale",
    "position_offset",
    "inertia",
    "reversal_transient",
    "rest_recovery",
    "torque_delay",
    "torque_filter",
    "backlash",
}
FREE_IN_LOAD = {"rest_recovery"}
"""Of these one channel says nothing of the other."""

FRICTION_ONLY = {*CONTRACT, *MEASUREMENT} - LOAD_ONLY - BOTH

ANGLE_DEPENDENT = {
    "load_linear",
    "load_velocity",
    "load_temperature",
    "torque_constant",
    "torque_scale",
    "position_offset",
    "payload_change",
    "dress_pack",
    "position_ripple",
    "inertia",
    "reversal_transient",
    "load_offset",
    "torque_delay",
    "torque_filter",
    "backlash",
}

ALL = tuple(BY_NAME.values())

every_effect = pytest.mark.parametrize("effect", ALL, ids=lambda effect: effect.name)


@pytest.fixture(scope="module")
def table():
    return two_days()


def long_log():
    """Return a table of 300 measuring series of 4 pairs each."""
    pair = np.arange(1200)
    return small(clock=60.0 * pair, order=pair % 4.0, pair=pair)


def middle(effect):
    """Return the middle of each shape parameter's grid; a change that starts there lasts."""
    found = {
        parameter.name: float(parameter.grid()[parameter.points // 2]) for parameter in effect.shape
    }
    return found if effect.moments is None else found | {"end": 1.0}


def corners(effect):
    """Return all combinations of bounds and middle of the shape parameters."""
    names = [parameter.name for parameter in effect.shape]
    values = [(p.lower, middle(effect)[p.name], p.upper) for p in effect.shape]
    return [dict(zip(names, shape, strict=True)) for shape in product(*values)]


@every_effect
def test_shapes_to_try_first_are_a_grid_or_histories_between_series(effect, table):
    shapes = effect.shapes(table)
    names = {axis.name for axis in effect.shape}
    assert all(names <= set(shape) and effect.has_shape(shape) for shape in shapes)
    assert len({tuple(shape.values()) for shape in shapes}) == len(shapes)
    if effect.moments is None:
        assert len(shapes) == np.prod([axis.points for axis in effect.shape])
        for axis in effect.shape:
            assert {shape[axis.name] for shape in shapes} == set(axis.grid().tolist())
    else:
        # 24 series of 4 pairs each: lasting changes between the first and the last
        moments = [shape["moment"] for shape in shapes if shape["end"] == 1.0]
        assert moments == pytest.approx(np.arange(1, 24) / 24)
        assert len(shapes) <= 250


@every_effect
def test_moments_lie_within_the_bounds_of_their_search(effect):
    """Of a long log too: 300 series of 4 pairs."""
    for shape in effect.shapes(long_log()):
        for axis in effect.shape:
            assert axis.lower <= shape[axis.name] <= axis.upper


def test_only_a_history_may_have_further_stretches():
    whole = {"moment": 0.2, "end": 0.4}
    further = whole | {"moment_2": 0.6, "end_2": 1.0}
    for name in ("step_change", "payload_change"):
        assert BY_NAME[name].has_shape(whole)
        assert BY_NAME[name].has_shape(further)
        assert not BY_NAME[name].has_shape(whole | {"moment_2": 0.6})
        assert not BY_NAME[name].has_shape(whole | {"moment_3": 0.6, "end_3": 1.0})
        assert not BY_NAME[name].has_shape({"moment": 0.2})
    assert BY_NAME["drift"].has_shape(["time_constant"])
    assert not BY_NAME["drift"].has_shape(["time_constant", "time_constant_2"])


def test_catalogue_holds_the_names_of_the_contract_in_order():
    assert [effect.name for effect in EFFECTS] == CONTRACT
    assert [effect.name for effect in MEASUREMENT_EFFECTS] == MEASUREMENT
    rivals = [effect.name for effect in RIVALS]
    assert list(BY_NAME) == list(NEEDS) == CONTRACT + MEASUREMENT + rivals
    assert rivals == ["torque_scale", "position_offset"]


@every_effect
def test_kind_is_the_channel_or_the_measurement(effect):
    expected = "measurement" if effect.name in MEASUREMENT else effect.channel
    assert effect.kind == expected


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
    if effect.measurement:
        # times in seconds: the size is that at the bound
        size *= [parameter.upper for parameter in effect.coefficients]
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
    # a ripple reads from the positions only how wide the bins are, and rests precede pairs 0
    factor |= {"time": 1.3, "clock": -1.0, "order": 0.0, "rest": 0.5, "position": 30.0}
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


@pytest.mark.parametrize("name", ["thermal_lag", "rest_recovery"])
def test_what_integrates_restarts_with_each_run(name, table):
    """The second day alone gives what it gives after the first one."""
    effect = BY_NAME[name]
    shape = middle(effect)
    second = table.run == 1
    alone = effect.evaluate(selected(table, second), shape)
    after = effect.evaluate(table, shape)
    for own, late in zip(alone, after, strict=True):
        np.testing.assert_allclose(own, late[second], rtol=1e-12, atol=1e-12)


@every_effect
def test_bounds_hold_zero_so_that_the_effect_can_be_absent(effect):
    assert effect.coefficients
    for parameter in effect.coefficients:
        assert parameter.lower <= 0.0 <= parameter.upper
        assert np.isfinite([parameter.lower, parameter.upper]).all()


@pytest.mark.parametrize(
    "name", ["stribeck", "velocity_exponent", "linear_viscous", "quadratic_drag", "load_linear"]
)
def test_what_only_adds_friction_cannot_take_any(name):
    (parameter,) = BY_NAME[name].coefficients
    assert parameter.lower == 0.0 < parameter.upper


@pytest.mark.parametrize("name", ["run_in", "rest_recovery", "reversal_transient"])
def test_an_excess_and_a_lack_have_the_sign_of_their_name(name):
    assert BY_NAME[name].coefficients[0].lower == 0.0


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
    assert set(effect.confounders) <= {*CONTRACT, *MEASUREMENT} - {effect.name}
    assert bool(effect.mirror) or effect.name not in BOTH - FREE_IN_LOAD


@every_effect
def test_effect_without_a_needed_column_is_left_out(effect, table):
    assert missing_columns(effect, table) == ()
    for name in effect.needs:
        rows = len(table.run)
        for values in (np.full(rows, np.nan), np.full(rows, 20.0)):
            poorer = replace(table, **{name: values})
            assert missing_columns(effect, poorer) == (name,)
            assert effect not in applicable(ALL, poorer)


def test_all_effects_can_be_judged_on_two_full_days(table):
    assert applicable(ALL, table) == ALL


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


@every_effect
def test_a_statement_names_parameters_of_its_effect_only(effect):
    known = {parameter.name for parameter in (*effect.shape, *effect.coefficients)}
    named = {field for _, field, _, _ in Formatter().parse(effect.statement) if field is not None}
    assert named <= known
    assert not effect.statement or effect.statement.endswith(".")
    # what is corrected in a log is said with its amount
    assert named or not effect.measurement
