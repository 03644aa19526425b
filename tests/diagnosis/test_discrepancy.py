"""The discrepancy's random functions: size, axes, and what the base leaves of them."""

from dataclasses import replace

import numpy as np
import pytest

from frictioncli.diagnosis.fit.variance_components import Products, evaluate, weights_of
from frictioncli.diagnosis.noise.discrepancy import discrepancy_of
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.diagnosis.search.step import Step
from tests.diagnosis.dense_noise import problem


@pytest.fixture(scope="module")
def joint():
    return problem(1)


def drawn(smooth, seed):
    """Return functions with standard normal coefficients, friction and load."""
    gamma = np.random.default_rng(seed).normal(size=smooth.friction.shape[1])
    return smooth.friction @ gamma, smooth.load @ gamma


def test_each_function_has_a_mean_square_of_one(joint):
    smooth = discrepancy_of(joint)
    for one in smooth.components:
        columns = getattr(smooth, one.channel)[:, one.columns]
        other = smooth.load if one.channel == "friction" else smooth.friction
        assert np.sum(np.mean(columns**2, axis=0)) == pytest.approx(1.0)
        assert not other[:, one.columns].any()
    ends = [one.columns.stop for one in smooth.components]
    assert [one.columns.start for one in smooth.components] == [0, *ends[:-1]]
    assert ends[-1] == smooth.friction.shape[1] == smooth.columns.count
    assert smooth.widths.sum() == ends[-1]


def test_all_together_are_one_per_cent_of_the_friction_beforehand(joint):
    """The RMS over rows of 300 draws with the expected amplitudes, both channels."""
    smooth = discrepancy_of(joint)
    squares = [
        np.mean(np.square(friction)) + np.mean(np.square(load))
        for friction, load in (drawn(smooth, seed) for seed in range(300))
    ]
    found = smooth.amplitude * np.sqrt(np.mean(squares))
    assert found == pytest.approx(0.01 * np.mean(joint.friction), rel=0.1)
    assert discrepancy_of(joint, 0.03).amplitude == pytest.approx(3 * smooth.amplitude)


def test_functions_depend_on_their_axes_alone(joint):
    smooth = discrepancy_of(joint)
    table = joint.table
    for one in smooth.components:
        keys = np.column_stack([getattr(table, axis) for axis in one.axes])
        _, first, place = np.unique(keys, axis=0, return_index=True, return_inverse=True)
        columns = getattr(smooth, one.channel)[:, one.columns]
        np.testing.assert_allclose(columns, columns[first][place.ravel()], atol=1e-12)


def test_what_does_not_vary_has_no_function(joint):
    """One speed, and one temperature: only the angle is left."""
    one = np.ones_like(joint.table.speed)
    still = replace(joint, table=replace(joint.table, speed=50 * one, temperature=30 * one))
    smooth = discrepancy_of(still)
    assert {axes for component in smooth.components for axes in component.axes} == {"position"}
    assert {component.channel for component in smooth.components} == {"friction", "load"}
    # the same sum for fewer functions
    assert smooth.amplitude > discrepancy_of(joint).amplitude


def test_a_load_channel_of_its_own_has_no_discrepancy(joint):
    smooth = discrepancy_of(replace(joint, has_load_channel=True))
    assert {component.channel for component in smooth.components} == {"friction"}
    assert discrepancy_of(joint, 0.0).components == ()


def test_functions_are_smooth(joint):
    """From bin to bin of 5 degrees a function of the angle changes by less than its RMS."""
    smooth = discrepancy_of(joint)
    bins = np.argsort(joint.table.position[:34])
    (place,) = (
        one.columns
        for one in smooth.components
        if (one.axes, one.channel) == (("position",), "friction")
    )
    changes, sizes = [], []
    for seed in range(200):
        gamma = np.random.default_rng(seed).normal(size=place.stop - place.start)
        values = (smooth.friction[:34, place] @ gamma)[bins]
        changes.append(np.mean(np.diff(values) ** 2))
        sizes.append(np.mean(values**2))
    assert np.sqrt(np.mean(changes) / np.mean(sizes)) < 0.7


def test_only_the_part_that_the_base_leaves_counts(joint):
    """Adding the base's own columns to the functions changes no likelihood and no estimate."""
    step = Step.of(Precomputed.of(joint), [])
    components = step.components
    count = step.known
    ridge = weights_of(components, step.fit.variances, count)
    assert not ridge[: components.base].any()
    assert (ridge[components.base : count] > 0).all()
    shift = np.eye(count + 1)
    generator = np.random.default_rng(0)
    size = np.sqrt(np.diag(step.products.within[0] + step.products.between[0][0]))
    shift[: components.base, components.base : count] = generator.normal(
        size=(components.base, count - components.base)
    ) / np.maximum(size[: components.base, np.newaxis], 1e-9)
    moved = Products(
        within=tuple(shift.T @ one @ shift for one in step.products.within),
        between=tuple(shift.T @ one @ shift for one in step.products.between),
    )
    before = evaluate(components, step.products, count, step.fit.variances)
    after = evaluate(components, moved, count, step.fit.variances)
    assert after.objective == pytest.approx(before.objective, abs=1e-3)
    np.testing.assert_allclose(
        after.coefficients[components.base :],
        before.coefficients[components.base :],
        rtol=1e-3,
        atol=1e-5,
    )


def test_the_amplitude_follows_what_is_there(joint):
    """A smooth error of 1 N·m over the angle: its function takes it, the others stay."""
    size = np.sqrt(2) * np.cos(2.2 * np.radians(joint.table.position) + 0.3)
    rough = replace(joint, friction=joint.friction + size)
    plain, found = (Step.of(Precomputed.of(one), []).fit.variances for one in (joint, rough))
    components = discrepancy_of(joint).components
    places = {(one.axes, one.channel): i for i, one in enumerate(components)}
    grown = np.exp(found.amplitude - plain.amplitude)
    assert grown[places[("position",), "friction"]] > 3
    assert grown[places[("position",), "load"]] == pytest.approx(1.0, abs=0.3)
    assert grown[places[("speed",), "friction"]] == pytest.approx(1.0, abs=0.3)
