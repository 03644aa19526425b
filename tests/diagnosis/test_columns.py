"""Columns are split exactly into what happens inside pairs and between them."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from frictioncli.diagnosis.data.gravity import carried_load
from frictioncli.diagnosis.fit.columns import base_rows, joined, misfit_column, reduced
from frictioncli.diagnosis.fit.hypotheses import hypothesis_of
from frictioncli.diagnosis.search.catalogue import Catalogue
from frictioncli.diagnosis.search.precomputed import Precomputed, point_noise
from frictioncli.effects import BY_NAME, EFFECTS
from frictioncli.effects.base import Basis
from frictioncli.effects.history import present
from frictioncli.effects.pair_series import measured_share
from frictioncli.model.friction import FrictionParameters, friction_torque
from tests.diagnosis import dense_noise
from tests.diagnosis.dense_noise import problem

PAIRS = dense_noise.layout(11, 6, bins=4)
ROWS = 17 * 4
VALUES = st.floats(-100, 100)


def squares(columns, part="friction"):
    """Inner products of reduced columns; a pair's mean counts once per bin."""
    channel = getattr(columns, part)
    return channel.within.T @ channel.within + 4 * channel.means.T @ channel.means


@given(arrays(float, (4, 2), elements=VALUES), arrays(float, (17, 2), elements=VALUES))
@settings(max_examples=40)
def test_what_is_alike_in_neighbouring_pairs_loses_nothing(over_angle, over_pairs):
    """Any function of the angle plus any function of the pair keeps all its inner products."""
    rows = np.tile(over_angle, (17, 1)) + np.repeat(over_pairs, 4, axis=0)
    found = reduced(PAIRS, rows, np.zeros_like(rows))
    np.testing.assert_allclose(squares(found), rows.T @ rows, rtol=1e-9, atol=1e-6)
    assert not found.load.within.any()
    assert not found.load.means.any()


@given(arrays(float, (4,), elements=VALUES), arrays(float, (ROWS,), elements=VALUES))
@settings(max_examples=40)
def test_data_are_asked_by_such_a_column_without_loss(over_angle, data):
    """The inner product of the column with whatever data is that of all rows."""
    column = np.tile(over_angle, 17)
    found = squares(reduced(PAIRS, np.column_stack([column, data]), np.zeros((ROWS, 2))))
    assert found[0, 1] == pytest.approx(column @ data, rel=1e-9, abs=1e-6)
    assert found[1, 1] <= data @ data * (1 + 1e-12) + 1e-9


@given(arrays(float, (ROWS, 2), elements=VALUES), st.floats(-5, 5))
@settings(max_examples=40)
def test_splitting_is_linear_and_means_and_deviations_stay_apart(rows, factor):
    load = rows[::-1]
    found = reduced(PAIRS, rows, load)
    mixed = reduced(PAIRS, rows[:, :1] + factor * rows[:, 1:], load[:, :1] + factor * load[:, 1:])
    for own, whole in zip(found.channels, mixed.channels, strict=True):
        for name in ("within", "means"):
            expected = getattr(own, name)[:, :1] + factor * getattr(own, name)[:, 1:]
            np.testing.assert_allclose(getattr(whole, name), expected, atol=1e-9)
    means = rows.reshape(17, 4, 2).mean(axis=1)
    np.testing.assert_allclose(found.friction.means, means, atol=1e-12)
    alone = reduced(PAIRS, np.repeat(means, 4, axis=0), load)
    np.testing.assert_allclose(alone.friction.within, 0.0, atol=1e-9)


def test_columns_are_joined_and_taken_side_by_side():
    generator = np.random.default_rng(0)
    rows = generator.normal(size=(ROWS, 5))
    whole = reduced(PAIRS, rows, 2 * rows)
    parts = [reduced(PAIRS, rows[:, i:j], 2 * rows[:, i:j]) for i, j in ((0, 2), (2, 2), (2, 5))]
    again = joined(parts)
    assert (whole.count, again.count) == (5, 5)
    chosen = whole.take([3, 0])
    for one, other, few in zip(whole.channels, again.channels, chosen.channels, strict=True):
        np.testing.assert_array_equal(one.within, other.within)
        np.testing.assert_array_equal(one.means, other.means)
        np.testing.assert_array_equal(few.within, one.within[:, [3, 0]])
        np.testing.assert_array_equal(few.means, one.means[:, [3, 0]])


@pytest.fixture(scope="module")
def joint():
    return problem(1)


def test_a_hypothesis_holds_an_effect_s_columns_shape_after_shape(joint):
    effect = BY_NAME["inertia"]
    shapes = effect.shapes(joint.all_runs)[:3]
    found = hypothesis_of(effect, joint, shapes)
    assert (found.name, found.width, found.columns.count) == ("inertia", 2, 6)
    for i, shape in enumerate(shapes):
        basis = joint.basis(effect, shape)
        expected = reduced(joint.layout, basis.friction, basis.load)
        own = found.columns.take(slice(2 * i, 2 * i + 2))
        np.testing.assert_array_equal(own.load.means, expected.load.means)
        np.testing.assert_array_equal(own.friction.within, expected.friction.within)
        np.testing.assert_allclose(found.rms[i], np.sqrt(np.mean(basis.load**2, axis=0)))
    # bounds in units of torque grow with a joint of more than 20 N·m of friction
    reach = np.mean(np.abs(joint.friction)) / 20.0
    wanted = [p.lower * reach for p in effect.coefficients]
    np.testing.assert_allclose(found.lower, wanted)


def test_the_base_s_columns_are_derivatives_of_the_simulated_torque(joint):
    """Central differences by every parameter of friction and of gravity."""
    table = joint.table
    about = np.array([*(getattr(joint.parameters, name) for name in joint.names), *joint.gravity])

    def torque(values):
        own, gravity = values[: len(joint.names)], values[len(joint.names) :]
        parameters = replace(joint.parameters, **dict(zip(joint.names, own, strict=True)))
        carried = carried_load(joint.load_base, gravity)
        friction = friction_torque(
            FrictionParameters(**vars_of(parameters)),
            load=carried,
            speed=table.speed,
            temperature=table.temperature,
        )
        return friction, joint.load_base @ gravity

    friction, load = base_rows(joint)
    assert friction.shape == load.shape == (len(table.speed), len(about))
    for i, size in enumerate(np.maximum(np.abs(about), 1.0)):
        step = np.zeros(len(about))
        step[i] = 1e-6 * size
        up, down = torque(about + step), torque(about - step)
        slope = (up[0] - down[0]) / (2e-6 * size)
        np.testing.assert_allclose(friction[:, i], slope, rtol=1e-5, atol=1e-5)
        np.testing.assert_allclose(load[:, i], (up[1] - down[1]) / (2e-6 * size), atol=1e-6)


def vars_of(parameters):
    return {name: getattr(parameters, name) for name in parameters.__dataclass_fields__}


def test_a_constant_of_gravity_loads_the_gear_as_the_rest_does(joint):
    """Where friction is simulated, and in its derivative: alpha (L + c)² by hand."""
    gravity = np.array([80.0, 10.0, 9.0])
    angle = np.radians(joint.table.position)
    carried = 80 * np.cos(angle) + 10 * np.sin(angle) + 9
    np.testing.assert_allclose(carried_load(joint.load_base, gravity), carried)
    friction, load = base_rows(joint)
    np.testing.assert_allclose(friction[:, -1], 2 * joint.parameters.alpha * joint.table.load)
    assert load[:, -1] == pytest.approx(1.0)


def test_a_load_channel_of_its_own_keeps_gravity_out_of_friction(joint):
    friction, _ = base_rows(replace(joint, has_load_channel=True))
    assert not friction[:, len(joint.names) :].any()


def test_the_misfit_is_measured_less_simulated(joint):
    column = misfit_column(joint)
    left = joint.friction - joint.table.friction
    np.testing.assert_allclose(column.friction.means[:, 0], left.reshape(-1, 34).mean(axis=1))
    left = joint.load - joint.load_base @ joint.gravity
    np.testing.assert_allclose(column.load.means[:, 0], left.reshape(-1, 34).mean(axis=1))


@pytest.mark.parametrize("channel", ["friction", "load"])
def test_point_noise_is_pure_error_whatever_ripples(joint, channel):
    """0.3 in both channels; what is alike in neighbouring pairs at one speed hides nothing."""
    assert point_noise(joint) == pytest.approx((0.3, 0.3), rel=0.05)
    ripple = np.sin(9 * np.radians(joint.table.position)) * joint.table.speed / 50
    rippled = replace(joint, **{channel: getattr(joint, channel) + 3 * ripple})
    assert point_noise(rippled) == pytest.approx(point_noise(joint), rel=1e-9)


def test_point_noise_of_pairs_that_are_never_alike_is_about_the_base_and_what_stands_beside(joint):
    """Pairs that cross other bins than their neighbours have no pure error."""
    away = joint.table.position + 0.01 * joint.table.pair
    moved = replace(joint.table, position=away)
    parted = replace(joint, table=moved, layout=replace(joint.layout, blocks=()))
    assert point_noise(parted) == pytest.approx((0.3, 0.3), rel=0.05)
    ripple = np.sin(9 * np.radians(joint.table.position))
    rippled = replace(parted, friction=parted.friction + ripple)
    assert point_noise(rippled)[0] > 0.6
    found = Basis(ripple[:, np.newaxis], np.zeros((len(ripple), 1)))
    assert point_noise(rippled, [found]) == pytest.approx((0.3, 0.3), rel=0.05)


def test_a_catalogue_keeps_the_order_of_its_hypotheses(joint):
    precomputed = Precomputed.of(joint)
    effects = [BY_NAME[name] for name in ("linear_viscous", "inertia", "load_linear")]
    whole = Catalogue.of(precomputed, [hypothesis_of(effect, joint) for effect in effects])
    shapes = len(BY_NAME["inertia"].shapes(joint.all_runs))
    widths = [place.stop - place.start for place in whole.places]
    assert widths == [1, 2 * shapes, 1]
    assert whole.part.columns.count == 2 + 2 * shapes
    for one, place in zip(whole.hypotheses, whole.places, strict=True):
        own = whole.part.columns.take(place)
        for part, expected in zip(own.channels, one.columns.channels, strict=True):
            np.testing.assert_array_equal(part.means, expected.means)
            np.testing.assert_array_equal(part.within, expected.within)


def test_a_catalogue_s_inner_products_are_those_of_its_columns_under_the_noise(joint):
    """Dense: deviations over their variance, pair means by the inverse of their covariance."""
    precomputed = Precomputed.of(joint)
    effects = [BY_NAME[name] for name in ("linear_viscous", "inertia")]
    catalogue = Catalogue.of(precomputed, [hypothesis_of(effect, joint) for effect in effects])
    known = precomputed.columns
    variances = replace(precomputed.start, noise=(9, 3), within=(0.1, 0.3), between=(0.05, 0.2))
    for number, effect in enumerate(effects):
        across, own = catalogue.products(number, known, variances)
        expected = np.zeros_like(across)
        square = np.zeros((across.shape[1], across.shape[1]))
        for channel in (0, 1):
            columns = catalogue.part.columns.take(catalogue.places[number]).channels[channel]
            inverse = np.linalg.inv(
                dense_noise.covariance(
                    joint.layout,
                    precomputed.noises.spectra[channel],
                    precomputed.noises.indices[variances.noise[channel]],
                )
            )
            means, within = (
                np.hstack([getattr(part.columns.channels[channel], name) for part in known.parts])
                for name in ("means", "within")
            )
            expected += within.T @ columns.within / variances.within[channel]
            expected += means.T @ inverse @ columns.means / variances.between[channel]
            square += columns.within.T @ columns.within / variances.within[channel]
            square += columns.means.T @ inverse @ columns.means / variances.between[channel]
        np.testing.assert_allclose(across, expected, rtol=1e-8, atol=1e-8 * np.abs(expected).max())
        width = len(effect.coefficients)
        for shape, found in enumerate(own):
            place = slice(shape * width, (shape + 1) * width)
            np.testing.assert_allclose(found, square[place, place], rtol=1e-8, atol=1e-9)


def test_a_catalogue_can_be_empty(joint):
    empty = Catalogue.of(Precomputed.of(joint), [])
    assert empty.part.columns.count == 0
    assert empty.hypotheses == ()


def test_every_effect_makes_a_hypothesis(joint):
    for effect in EFFECTS:
        found = hypothesis_of(effect, joint)
        assert found.columns.count == found.width * len(found.shapes)
        assert found.width == len(effect.coefficients) == len(found.lower) == len(found.upper)


def test_moments_that_leave_all_rows_on_one_side_are_not_tried():
    """Two days of 40 pairs in ten series each; only the first day is asked."""
    both = problem(2)
    day = both.part(both.table.run == 0)
    for name in ("step_change", "payload_change"):
        effect = BY_NAME[name]
        lasting = [one["moment"] for one in hypothesis_of(effect, day).shapes if one["end"] == 1.0]
        assert lasting == pytest.approx(np.arange(1, 10) / 20)
        share = measured_share(both.all_runs)[day.rows]
        columns = {tuple(present(share, one)) for one in hypothesis_of(effect, day).shapes}
        assert len(columns) == len(hypothesis_of(effect, day).shapes)
        assert all(any(there) and not all(there) for there in columns)
        whole = [one["moment"] for one in hypothesis_of(effect, both).shapes if one["end"] == 1.0]
        assert whole == pytest.approx(np.arange(1, 20) / 20)
