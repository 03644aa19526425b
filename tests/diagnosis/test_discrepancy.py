"""The discrepancy's random functions: size, axes, and what the base leaves of them."""

from dataclasses import replace

import numpy as np
import pytest

from frictioncli.diagnosis.fit.columns import ChannelColumns, ModelColumns, base_rows, joined
from frictioncli.diagnosis.fit.left_by_base import span_of
from frictioncli.diagnosis.fit.mixed_model import evaluate, weights_of
from frictioncli.diagnosis.fit.products import Products
from frictioncli.diagnosis.fit.transformed_columns import Part, TransformedColumns
from frictioncli.diagnosis.noise.discrepancy import discrepancy_of
from frictioncli.diagnosis.noise.discrepancy_functions import (
    FINE,
    FORM,
    SPEED_RIPPLE,
    functions_of,
)
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.diagnosis.search.step import Step
from tests.diagnosis.dense_noise import problem


@pytest.fixture(scope="module")
def joint():
    return problem(1)


def smooth_of(joint, share=0.01):
    return discrepancy_of(joint, span_of(joint), share)


def orthogonal(smooth):
    """Return what the base leaves of all columns, friction above load."""
    friction, load = smooth.shown
    columns = np.zeros((2 * len(friction), smooth.columns.count))
    columns[: len(friction), : friction.shape[1]] = friction
    columns[len(friction) :, friction.shape[1] :] = load
    return columns - smooth.span @ (smooth.span.T @ columns)


def parts(smooth, one):
    """Return what the base leaves of a function in its own channel and in the other."""
    friction, load = np.split(orthogonal(smooth)[:, one.columns], 2)
    return (friction, load) if one.channel == "friction" else (load, friction)


def weight(one):
    """Return the expected size of a function relative to a main effect of friction."""
    if one.axes == FINE:
        return 0.2
    if (one.axes, one.channel) == (SPEED_RIPPLE, "friction"):
        return 0.3
    return 0.6 if one.channel == "load" or len(one.axes) == 2 else 1.0


def test_what_the_base_leaves_of_each_function_has_its_size(joint):
    smooth = smooth_of(joint)
    for one in smooth.components:
        square = sum(np.sum(np.mean(part**2, axis=0)) for part in parts(smooth, one))
        assert square == pytest.approx(weight(one) ** 2)
    ends = [one.columns.stop for one in smooth.components]
    assert [one.columns.start for one in smooth.components] == [0, *ends[:-1]]
    assert ends[-1] == smooth.columns.count == smooth.widths.sum()


def test_an_error_of_form_that_the_base_contains_is_not_made_of_rounding(joint):
    values = next(values for _, axes, values in functions_of(joint.table) if axes == FORM)
    contained = np.append(values[:, 0], np.zeros(len(values)))
    span, _ = np.linalg.qr(np.column_stack([span_of(joint), contained]))
    smooth = discrepancy_of(joint, span, 0.01)
    whole = discrepancy_of(joint, span_of(joint), 0.01)
    (form,) = (one for one in smooth.components if one.axes == FORM)
    (before,) = (one for one in whole.components if one.axes == FORM)
    assert form.columns.stop - form.columns.start < before.columns.stop - before.columns.start
    assert all(np.all(np.isfinite(columns)) for columns in smooth.shown)
    square = sum(np.sum(np.mean(part**2, axis=0)) for part in parts(smooth, form))
    assert square == pytest.approx(weight(form) ** 2)


def test_a_torque_meets_what_the_base_leaves_of_the_functions(joint):
    """Products with any torque are those with the columns that are orthogonal to the base."""
    smooth, base = smooth_of(joint), np.vstack(base_rows(joint))
    columns = orthogonal(smooth)
    assert np.abs(base.T @ columns).max() < 1e-6 * np.linalg.norm(base) * np.linalg.norm(columns)
    torques = np.random.default_rng(4).normal(size=(len(columns), 3))
    np.testing.assert_allclose(smooth.crossed(torques), torques.T @ columns, atol=1e-8)


def test_all_together_are_about_one_per_cent_of_the_friction_beforehand(joint):
    """The RMS over rows of 300 draws with the expected amplitudes, both channels.

    Inertia where the speed is not constant comes beside that.
    """
    smooth = smooth_of(joint)
    gamma = np.random.default_rng(0).normal(size=(smooth.columns.count, 300))
    for one in smooth.components:
        if one.axes == SPEED_RIPPLE:
            gamma[one.columns] = 0.0
    square = 2 * np.mean(np.square(orthogonal(smooth) @ gamma))
    found = smooth.amplitude * np.sqrt(square)
    assert found / np.mean(joint.friction) == pytest.approx(0.01, rel=0.1)
    assert smooth_of(joint, 0.03).amplitude == pytest.approx(3 * smooth.amplitude)


def test_functions_depend_on_their_axes_and_on_the_base_alone(joint):
    """Less their means over rows that are alike along the axes they are the base's columns."""
    smooth = smooth_of(joint)
    base = np.vstack(base_rows(joint))
    base = base / np.linalg.norm(base, axis=0)
    half = len(base) // 2
    for one in smooth.components:
        if "form" in one.axes:
            continue
        own_axes = {SPEED_RIPPLE: ("position", "speed"), FINE: ("position",)}
        axes = own_axes.get(one.axes, one.axes)
        keys = np.column_stack([getattr(joint.table, axis) for axis in axes])
        place = np.unique(keys, axis=0, return_inverse=True)[1].ravel()
        own = slice(0, half) if one.channel == "friction" else slice(half, None)

        def within(columns, place=place, own=own):
            left = columns.copy()
            count = np.bincount(place)
            for i in range(columns.shape[1]):
                left[own, i] -= (np.bincount(place, columns[own, i]) / count)[place]
            return left

        columns, known = within(orthogonal(smooth)[:, one.columns]), within(base)
        fitted = known @ np.linalg.lstsq(known, columns, rcond=1e-12)[0]
        np.testing.assert_allclose(columns, fitted, atol=1e-5)


@pytest.mark.parametrize("channel", ["friction", "load"])
def test_what_is_finer_than_a_smooth_function_has_an_amplitude_of_its_own(joint, channel):
    """A wave of order 20.5 over the stroke, of which the smooth one has nearly nothing."""
    position = joint.table.position
    angle, place = np.unique(position, return_inverse=True)
    smooth = smooth_of(joint)
    by_place = {(one.axes, one.channel): one for one in smooth.components}
    one, alone = by_place[FINE, channel], by_place[("position",), channel]
    wave = np.cos(20.5 * np.pi * (angle - angle[0]) / np.ptp(angle))[place]
    in_order = (wave, 0.0 * wave) if channel == "friction" else (0.0 * wave, wave)
    torque = np.concatenate(in_order)
    span, own = span_of(joint), orthogonal(smooth)[:, one.columns]
    torque -= span @ (span.T @ torque)
    left = [
        np.linalg.norm(torque - columns @ np.linalg.lstsq(columns, torque, rcond=None)[0])
        for columns in (own, orthogonal(smooth)[:, alone.columns])
    ]
    assert left[0] < 0.2 * np.linalg.norm(torque) < 0.8 * np.linalg.norm(torque) < left[1]


@pytest.mark.parametrize("late", [0.0, 0.02, 0.06])
def test_the_inertia_of_a_speed_that_ripples_shows_in_friction_where_the_torque_is_late(
    joint, late
):
    """Torque of an acceleration of six periods a turn, taken where each move was that long before.

    Less what is the base's: gravity, the same at all speeds.
    """
    smooth = smooth_of(joint)
    table = joint.table
    forward, reverse = (
        np.square(table.speed / 100.0)
        * np.cos(6 * np.radians(table.position - way * late * table.speed))
        for way in (1, -1)
    )
    span = span_of(joint)
    for channel, torque in (("friction", forward - reverse), ("load", forward + reverse)):
        (one,) = (
            one for one in smooth.components if (one.axes, one.channel) == (SPEED_RIPPLE, channel)
        )
        zero = 0.0 * torque
        both = [torque, zero] if channel == "friction" else [zero, torque]
        column = np.concatenate(both) / 2
        column -= span @ (span.T @ column)
        own = orthogonal(smooth)[:, one.columns]
        left = column - own @ np.linalg.lstsq(own, column, rcond=None)[0]
        whole = np.linalg.norm((forward, reverse))
        assert np.linalg.norm(left) < 0.1 * whole
        if late == 0.06 and channel == "friction":
            assert np.linalg.norm(column) > 0.2 * whole


def test_errors_of_form_are_those_of_the_exponents_and_of_coulomb_friction(joint):
    """Differences of equation (16) with another exponent of the speed, and with warmer friction."""
    smooth = smooth_of(joint)
    (one,) = (one for one in smooth.components if "form" in one.axes)
    table, p = joint.table, joint.parameters
    decay = p.beta + p.gamma * np.exp(-p.delta * table.temperature)
    bent = decay * (table.speed**0.5001 - table.speed**0.4999) / 2e-4
    span, own = span_of(joint), orthogonal(smooth)[:, one.columns]
    for torque in (bent, 0.1 * (table.temperature - 40.0)):
        column = np.concatenate([torque, 0 * torque])
        column -= span @ (span.T @ column)
        left = column - own @ np.linalg.lstsq(own, column, rcond=None)[0]
        assert np.linalg.norm(left) < 1e-3 * np.linalg.norm(column)


def test_what_does_not_vary_has_no_function(joint):
    """One speed, and one temperature: only the angle is left."""
    one = np.ones_like(joint.table.speed)
    still = replace(joint, table=replace(joint.table, speed=50 * one, temperature=30 * one))
    smooth = smooth_of(still)
    axes = {axis for component in smooth.components for axis in component.axes}
    assert axes - {"form", "speed", "temperature"} == {"position", *FINE}
    left = {one.axes for one in smooth.components if "form" not in one.axes}
    assert left == {("position",), FINE}
    # the same sum for fewer functions
    assert smooth.amplitude > smooth_of(joint).amplitude


def test_what_no_data_show_of_a_function_has_the_size_expected_of_the_whole(joint):
    """Its mean square, over amplitudes of the lognormal distribution, by 10^5 draws of them."""
    smooth = smooth_of(joint)
    amplitude = np.log(smooth.amplitude) + 0.1 * np.arange(len(smooth.components))
    unseen = smooth.unseen(amplitude)
    drawn = np.exp(0.7 * np.random.default_rng(1).normal(size=100_000))
    first = 0
    for number, one in enumerate(smooth.components):
        own = unseen[:, first : first + smooth.whole[number].shape[1]]
        first += own.shape[1]
        square = np.sum(np.square(own)) / len(joint.friction)
        size = 2.0 if "form" in one.axes else weight(one)
        expected = np.mean(np.square(np.exp(amplitude[number]) * size * drawn))
        assert square == pytest.approx(expected, rel=0.05)
        # what the base leaves of it is spanned by the columns that data show
        span = np.hstack([orthogonal(smooth)[:, one.columns], np.vstack(base_rows(joint))])
        size = np.linalg.norm(span, axis=0)
        fitted = span / size @ np.linalg.lstsq(span / size, own, rcond=1e-12)[0]
        np.testing.assert_allclose(own, fitted, atol=1e-6)
    assert first == unseen.shape[1]


def test_an_asymmetry_of_the_stroke_is_as_large_as_its_lowest_orders_say(joint):
    """Friction that is higher on one side: half a cosine over the range has most of its square."""
    smooth = smooth_of(joint)
    (own,) = (
        columns
        for columns, one in zip(smooth.whole, smooth.components, strict=True)
        if (one.axes, one.channel) == (("position",), "friction")
    )
    squares = np.sum(np.square(own), axis=0)
    assert 0.85 < squares[0] / squares.sum() < 0.97
    angle = joint.table.position
    side = np.tanh((angle - np.mean(angle)) / (np.ptp(angle) / 5))
    likeness = own[:, 0] @ side / np.linalg.norm(own[:, 0]) / np.linalg.norm(side)
    assert abs(likeness) > 0.9


def test_the_unit_of_speed_does_not_matter_for_errors_of_form(joint):
    """An error of the exponent turns friction about the middle speed, so that its mean stays."""
    smooth = smooth_of(joint)
    place = next(i for i, one in enumerate(smooth.components) if "form" in one.axes)
    table = joint.table
    ratio = smooth.whole[place][:, 0] / (table.viscous * np.sqrt(table.speed))
    slope, level = np.polyfit(np.log(table.speed), ratio, 1)
    middle = np.exp(-level / slope)
    assert middle == pytest.approx(np.exp(np.mean(np.log(table.speed))))


def test_a_load_that_is_measured_apart_has_its_share_of_discrepancy_in_its_own_unit(joint):
    """As large a share of the load as of the friction, in whatever unit that is."""
    apart = smooth_of(replace(joint, has_load_channel=True))
    assert {component.channel for component in apart.components} == {"friction", "load"}
    share = np.mean(np.abs(joint.load)) / np.mean(joint.friction)
    for one in apart.components:
        square = sum(np.sum(np.mean(part**2, axis=0)) for part in parts(apart, one))
        unit = share if one.channel == "load" else 1.0
        assert square == pytest.approx((unit * weight(one)) ** 2)
    milli = smooth_of(
        replace(
            joint,
            has_load_channel=True,
            load=1000 * joint.load,
            gravity=1000 * joint.gravity,
        )
    )
    assert milli.amplitude == pytest.approx(apart.amplitude)
    scale = np.repeat(np.array([[1.0], [1000.0]]), len(joint.load), axis=0)
    np.testing.assert_allclose(orthogonal(milli) / scale, orthogonal(apart), rtol=1e-9, atol=1e-9)


def test_no_share_is_no_discrepancy(joint):
    assert smooth_of(joint, 0.0).components == ()


def test_functions_are_smooth(joint):
    """From bin to bin of 5 degrees a function of the angle changes by less than its RMS."""
    smooth = smooth_of(joint)
    bins = np.argsort(joint.table.position[:34])
    (one,) = (
        one for one in smooth.components if (one.axes, one.channel) == (("position",), "friction")
    )
    values = parts(smooth, one)[0][:34][bins]
    # the mean square over the function's random coefficients is the sum over its columns
    change, size = np.sum(np.diff(values, axis=0) ** 2), np.sum(values**2)
    assert np.sqrt(change / size) < 0.7


def test_only_the_part_that_the_base_leaves_counts(joint):
    """Adding the base's own columns to the functions changes no likelihood and no estimate."""
    step = Step.of(Precomputed.of(joint), [])
    components = step.components
    count = step.known
    ridge = weights_of(components, step.fit.variances, count)
    assert not ridge[: components.base].any()
    assert (ridge[components.base : count] > 0).all()
    size = np.zeros(count + 1)
    for channel in (0, 1):
        products = step.products.within[channel] + step.products.between(channel, 0)
        size[step.columns.places.shown(channel)] += np.diag(products)
    shift = np.eye(count + 1)
    generator = np.random.default_rng(0)
    shift[: components.base, components.base : count] = generator.normal(
        size=(components.base, count - components.base)
    ) / np.maximum(np.sqrt(size[: components.base, np.newaxis]), 1e-9)
    # once moved, all columns show in both channels
    whole = joined([part.columns for part in step.columns.parts])
    channels = (ChannelColumns(one.within @ shift, one.means @ shift) for one in whole.channels)
    part = Part(ModelColumns(*channels), step.precomputed.noises)
    moved = Products.of(TransformedColumns((part,)))
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
    size = np.sqrt(2) * np.cos(4.2 * np.radians(joint.table.position) + 0.3)
    rough = replace(joint, friction=joint.friction + size)
    plain, found = (Step.of(Precomputed.of(one), []).fit.variances for one in (joint, rough))
    components = smooth_of(joint).components
    places = {(one.axes, one.channel): i for i, one in enumerate(components)}
    grown = np.exp(found.amplitude - plain.amplitude)
    assert grown[places[("position",), "friction"]] > 3
    assert grown[places[("position",), "load"]] == pytest.approx(1.0, abs=0.3)
    assert grown[places[("speed",), "friction"]] == pytest.approx(1.0, abs=0.3)
