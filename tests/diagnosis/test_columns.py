"""Columns are split exactly into what happens inside pairs and between them."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from frictioncli.diagnosis.data.gravity import carried_load
from frictioncli.diagnosis.fit.columns import base_rows, joined, misfit_column, reduced
from frictioncli.diagnosis.fit.hypotheses import Hypothesis, hypothesis_of
from frictioncli.diagnosis.search.precomputed import Catalogue, Precomputed, point_noise
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


def bounded(lower, upper):
    count = len(lower)
    empty = reduced(PAIRS, np.zeros((ROWS, count)), np.zeros((ROWS, count)))
    return Hypothesis(
        name="any",
        shapes=({},),
        width=count,
        columns=empty,
        rms=np.ones((1, count)),
        lower=np.array(lower),
        upper=np.array(upper),
    )


@pytest.mark.parametrize(
    ("coefficients", "allowed"),
    [
        ([0.0, 0.0], True),
        ([10.0, -5.0], True),
        ([-0.19, 0.0], True),
        ([-0.21, 0.0], False),
        ([10.19, 5.0], True),
        ([10.21, 5.0], False),
        ([0.0, 5.99], True),
        ([0.0, -6.01], False),
    ],
)
def test_bounds_may_be_missed_by_two_standard_errors(coefficients, allowed):
    """Errors of 0.1 and 0.5 about bounds of 0 to 10 and -5 to 5."""
    hypothesis = bounded([0.0, -5.0], [10.0, 5.0])
    covariance = np.array([[0.01, 0.04], [0.04, 0.25]])
    assert hypothesis.allows(np.array(coefficients), covariance) is allowed


@given(arrays(float, (2,), elements=VALUES), arrays(float, (2, 2), elements=st.floats(-3, 3)))
@settings(max_examples=60)
def test_what_lies_within_its_bounds_is_always_allowed(coefficients, root):
    inside = np.clip(coefficients, [0.0, -5.0], [10.0, 5.0])
    assert bounded([0.0, -5.0], [10.0, 5.0]).allows(inside, root @ root.T)


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


def test_an_offset_of_the_torque_loads_no_friction(joint):
    """Neither where friction is simulated nor in its derivative."""
    assert carried_load(joint.load_base, np.array([0.0, 0.0, 9.0])).any() == np.False_
    friction, load = base_rows(joint)
    assert not friction[:, -1].any()
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
def test_point_noise_is_that_of_a_row_about_its_pair(joint, channel):
    """0.3 in both channels; a ripple hides it until its columns are taken out."""
    assert point_noise(joint) == pytest.approx((0.3, 0.3), rel=0.05)
    ripple = np.sin(9 * np.radians(joint.table.position))
    rippled = replace(joint, **{channel: getattr(joint, channel) + ripple})
    before = dict(zip(("friction", "load"), point_noise(rippled), strict=True))
    assert before.pop(channel) > 0.6
    assert list(before.values()) == pytest.approx([0.3], rel=0.05)
    nothing = np.zeros_like(ripple)
    columns = (ripple, nothing) if channel == "friction" else (nothing, ripple)
    found = Basis(*(column[:, np.newaxis] for column in columns))
    assert point_noise(rippled, [found]) == pytest.approx((0.3, 0.3), rel=0.05)


def test_a_catalogue_keeps_order_and_can_do_without(joint):
    precomputed = Precomputed.of(joint)
    effects = [BY_NAME[name] for name in ("linear_viscous", "inertia", "load_linear")]
    whole = Catalogue.of(precomputed, [hypothesis_of(effect, joint) for effect in effects])
    shapes = len(BY_NAME["inertia"].shapes(joint.all_runs))
    assert whole.groups.width.tolist() == [1, *[2] * shapes, 1]
    assert whole.columns.count == 2 + 2 * shapes
    fewer = whole.without({"inertia", "stribeck"})
    assert [one.name for one in fewer.hypotheses] == ["linear_viscous", "load_linear"]
    assert fewer.groups.width.tolist() == [1, 1]
    made = Catalogue.of(precomputed, fewer.hypotheses)
    for part, expected in zip(fewer.columns.channels, made.columns.channels, strict=True):
        np.testing.assert_array_equal(part.means, expected.means)
        np.testing.assert_array_equal(part.within, expected.within)
    for modes, expected in zip(fewer.modes, made.modes, strict=True):
        np.testing.assert_allclose(np.array(modes), np.array(expected), rtol=1e-12, atol=1e-12)
    assert whole.without(set()) is whole


def test_a_catalogue_can_be_empty(joint):
    precomputed = Precomputed.of(joint)
    empty = Catalogue.of(precomputed, [hypothesis_of(BY_NAME["drift"], joint)]).without({"drift"})
    assert empty.columns.count == 0
    assert empty.hypotheses == ()


def test_every_effect_makes_a_hypothesis(joint):
    for effect in EFFECTS:
        found = hypothesis_of(effect, joint)
        assert found.columns.count == found.width * len(found.shapes)
        assert found.width == len(effect.coefficients) == len(found.lower) == len(found.upper)


def test_moments_that_leave_all_rows_on_one_side_are_not_tried():
    """Two days of 40 pairs in ten series each; only the first day is asked."""
    both = problem(2)
    first = np.flatnonzero(both.table.run == 0)
    day = replace(both, rows=first, layout=dense_noise.layout(40, bins=34))
    for name in ("step_change", "payload_change"):
        effect = BY_NAME[name]
        lasting = [one["moment"] for one in hypothesis_of(effect, day).shapes if one["end"] == 1.0]
        assert lasting == pytest.approx(np.arange(1, 10) / 20)
        share = measured_share(both.all_runs)[first]
        columns = {tuple(present(share, one)) for one in hypothesis_of(effect, day).shapes}
        assert len(columns) == len(hypothesis_of(effect, day).shapes)
        assert all(any(there) and not all(there) for there in columns)
        whole = [one["moment"] for one in hypothesis_of(effect, both).shapes if one["end"] == 1.0]
        assert whole == pytest.approx(np.arange(1, 20) / 20)
