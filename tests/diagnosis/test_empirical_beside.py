"""Base and causes beside the forms of what has no name: as if it were not there."""

from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

from frictioncli.diagnosis.empirical.estimate import empirical_term
from frictioncli.diagnosis.empirical.unexplained import unexplained
from frictioncli.diagnosis.fit.extension import extend, misfits
from frictioncli.diagnosis.search.lack_of_fit import structures
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.diagnosis.search.step import Step
from frictioncli.diagnosis.search.structure import Structure
from frictioncli.effects import BY_NAME
from tests.diagnosis.dense_noise import problem


def warm_peak(rows):
    """Friction that is higher about 45 °C."""
    return 5.0 * np.exp(-np.square((rows.motor_temperature - 45.0) / 3.0) / 2)


def carried(rows):
    """Friction that grows with the load: an effect of the catalogue."""
    return 0.05 * np.abs(rows.load_torque)


def found(data, names=(), new=None):
    """Return the empirical term beside effects, and base and effects without it."""
    precomputed, fits = Precomputed.of(data), []
    for name in names:
        fits.append(Step.of(precomputed, fits).fitted(BY_NAME[name], {}))
    step = Step.of(precomputed, fits)
    beside = extend(data, step.predicting_fit(), fits)
    judged = None if new is None else (new, lambda one: one)
    term = empirical_term(step, (data, beside), judged, margin=0.2, floor=0.3, seed=0)
    return term, beside


@cache
def with_peak():
    return found(problem(3, friction=warm_peak))


def test_a_form_is_structure_where_no_property_of_the_joint_is_named():
    """Whatever the test along the axes says, whose functions have more parameters."""
    empirical, _ = with_peak()
    step = Step.of(Precomputed.of(problem(3)), [])
    delay, drift = (
        SimpleNamespace(fit=SimpleNamespace(effect=BY_NAME[name]))
        for name in ("torque_delay", "drift")
    )
    for causes in ((), (delay,)):
        one = unexplained(None, causes, empirical, step, 0.05)
        assert (one.axes, one.channel) == (("temperature",), "friction")
        assert one.size == empirical.parts[0].size
        assert one.p_value < 1e-6
    assert unexplained(one, (drift,), empirical, step, 0.05) is one
    assert unexplained(None, (delay, drift), empirical, step, 0.05) is None
    assert unexplained(None, (), None, step, 0.05) is None
    # without a form only what the test along the axes shows: of this joint nothing
    smooth = replace(empirical, p_value=None)
    assert unexplained(None, (), smooth, step, 0.05) is None
    # or what predicts a new run beyond doubt: a reduction of 6 standard errors, not of 4
    for error, is_structure in ((0.06, True), (0.09, False)):
        interval = (0.36 - 1.96 * error, 0.36 + 1.96 * error)
        gain = replace(smooth.gain, basis="new_run", reduction=0.36, interval=interval)
        one = unexplained(None, (), replace(smooth, gain=gain), step, 0.05)
        assert (one is not None) == is_structure
        assert one is None or one.axes == ("temperature",)


@pytest.mark.parametrize(
    ("name", "basis", "is_structure"),
    [
        ("position_ripple", "new_run", True),
        ("position_ripple", "within_run", False),
        # along its own axis it may be the error of a cause's form
        ("coulomb_temperature", "new_run", False),
    ],
)
def test_beside_a_named_cause_a_term_is_structure_along_other_axes_if_it_predicts(
    name, basis, is_structure
):
    empirical, _ = with_peak()
    step = Step.of(Precomputed.of(problem(3)), [])
    cause = SimpleNamespace(fit=SimpleNamespace(effect=BY_NAME[name]))
    gain = replace(empirical.gain, basis=basis, reduction=0.36, interval=(0.24, 0.48))
    one = unexplained(None, [cause], replace(empirical, gain=gain), step, 0.05)
    assert (one is not None) == is_structure
    if one is not None:
        assert (one.axes, one.size) == (("temperature",), empirical.parts[0].size)


def test_what_a_term_predicts_on_a_new_run_is_not_along_time():
    """A term has no function of time; a history need not repeat, friction at a temperature does."""
    empirical, _ = with_peak()
    step = Step.of(Precomputed.of(problem(3)), [])
    along_time = Structure(
        axes=("time",),
        channel="friction",
        p_value=1e-4,
        statistic=20.0,
        size=0.5,
        interval=(0.3, 0.7),
    )
    gain = replace(empirical.gain, basis="new_run", reduction=0.36, interval=(0.24, 0.48))
    predicting = replace(empirical, gain=gain)
    assert unexplained(along_time, (), empirical, step, 0.05) == along_time
    found = unexplained(along_time, (), predicting, step, 0.05)
    assert (found.axes, found.size) == (("temperature",), empirical.parts[0].size)
    for other in (replace(along_time, channel="load"), replace(along_time, axes=("speed",))):
        assert unexplained(other, (), predicting, step, 0.05) == other


def test_structure_that_a_term_shows_is_as_large_as_in_the_term():
    """The test along the axis takes off what any model's small errors may be of it."""
    empirical, _ = with_peak()
    step = Step.of(Precomputed.of(problem(3, friction=warm_peak)), [])
    axes = (("temperature",), "friction")
    tested = next(one for one in structures(step) if (one.axes, one.channel) == axes)
    part = replace(empirical.parts[0], size=2 * tested.size, interval=(0.1, 9.0))
    smooth = replace(empirical, p_value=None, parts=(part,))
    one = unexplained(None, (), smooth, step, 0.05)
    assert one == replace(tested, size=part.size, interval=part.interval)
    # the term has none along that axis
    elsewhere = replace(smooth, parts=(replace(part, axes=("speed",)),))
    assert unexplained(None, (), elsewhere, step, 0.05) == tested
    # or more than three times as much along another one, and predicts a new run
    gain = replace(smooth.gain, basis="new_run", reduction=0.36, interval=(0.24, 0.48))
    for times, axes in ((2.0, ("temperature",)), (4.0, ("speed",))):
        large = replace(part, axes=("speed",), size=times * tested.size)
        found = unexplained(None, (), replace(smooth, gain=gain, parts=(large,)), step, 0.05)
        assert found.axes == axes


@pytest.mark.parametrize(
    ("fading", "axes"), [(25.0, ("position", "speed")), (np.inf, ("position",))]
)
def test_structure_that_fades_with_speed_is_along_the_angle_and_the_speed(fading, axes):
    """Cogging: a ripple of the load that is gone at high speed, or one at all speeds."""

    def cogging(rows):
        wave = np.cos(np.radians(6 * rows.position) + 1.0)
        return 4.0 * wave * np.exp(-rows.speed / fading)

    data = problem(3, load=cogging)
    empirical, _ = found(data)
    step = Step.of(Precomputed.of(data), [])
    first = structures(step)[0]
    assert (first.axes, first.channel) == (("position",), "load")
    one = unexplained(first, (), empirical, step, 0.05)
    assert (one.axes, one.channel) == (axes, "load")


def test_the_base_beside_a_form_is_that_of_the_joint_without_it():
    """The same noise without the peak: its parameters are the other route."""
    empirical, biased = with_peak()
    _, plain = found(problem(3))
    (form,) = empirical.term.forms
    assert form.axes == ("temperature",)
    names = plain.names
    far = np.abs(biased.changes - plain.changes)
    near = np.abs(empirical.beside.changes - plain.changes)
    chosen = [names.index(name) for name in ("gamma", "delta", "beta")]
    assert (near[chosen] < 0.3 * far[chosen]).all()
    assert (near < 2 * empirical.beside.errors[: len(names)]).all()
    # what the term adds to the base is that, but for the part of its small random functions
    added = np.array([empirical.term.base_changes[name] for name in names])
    changes = empirical.beside.changes - empirical.without.changes
    assert (np.abs(added - changes) < 0.3 * far)[chosen].all()


def test_causes_beside_a_form_are_those_of_the_joint_without_it():
    def both(rows):
        hump = 4.0 * np.exp(-np.square((np.abs(rows.load_torque) - 70.0) / 9.0) / 2)
        return hump + carried(rows)

    empirical, biased = found(problem(3, friction=both), ["load_linear"])
    _, plain = found(problem(3, friction=carried), ["load_linear"])
    assert empirical.term.forms
    true, before, after = (
        one.effects[0].coefficients[0] for one in (plain, biased, empirical.beside)
    )
    assert abs(after - true) < 0.3 * abs(before - true)
    assert empirical.beside.effects[0].effect.name == "load_linear"


def test_base_and_form_together_predict_another_day():
    """From the parameters that are stated, by hand: no worse than the noise of that day."""
    seen, new, without = problem(3, friction=warm_peak), problem(4, friction=warm_peak), problem(4)
    empirical, _ = found(seen, new=new)
    left = misfits(new, empirical.without)
    added = empirical.term.at(new)
    rms = np.sqrt(np.mean(new.squared(left[0] - added.friction, left[1] - added.load)))
    assert rms == pytest.approx(empirical.gain.after, rel=1e-9)
    best = np.sqrt(np.mean(without.squared(without.friction_misfit, without.load_misfit)))
    assert rms < 1.05 * best


def test_beyond_the_measured_range_the_model_is_the_one_without_the_term():
    """A step most of which the base takes: a base refitted beside it would be off beyond."""
    data = problem(3, friction=lambda rows: 6.0 * (rows.motor_temperature > 45.0))
    empirical, biased = found(data)
    (form,) = empirical.term.forms
    assert (form.kind, form.axes) == ("step", ("temperature",))
    assert form.coefficients["step"] == pytest.approx(6.0, rel=0.2)
    # the base beside it is another one by more than a newton metre
    moved = misfits(data, biased)[0] - misfits(data, empirical.beside)[0]
    assert np.ptp(moved) > 1.0
    warmer = data.table.temperature + 2 * np.ptp(data.table.temperature)
    outside = replace(data, table=replace(data.table, temperature=warmer))
    added = empirical.term.at(outside)
    assert not added.friction.any()
    assert not added.load.any()
    np.testing.assert_array_equal(empirical.without.changes, biased.changes)
    np.testing.assert_array_equal(empirical.without.gravity, biased.gravity)


def test_a_run_in_which_a_cause_does_not_hold_is_predicted_without_it():
    """What of base and causes holds there is asked of the refitted ones."""
    data, new = problem(3, friction=warm_peak), problem(4, friction=warm_peak)
    precomputed = Precomputed.of(data)
    fit = Step.of(precomputed, []).fitted(BY_NAME["load_linear"], {})
    step = Step.of(precomputed, [fit])
    beside = extend(data, step.predicting_fit(), [fit])
    asked = []

    def holding(one):
        asked.append(one)
        return replace(one, effects=())

    empirical = empirical_term(step, (data, beside), (new, holding), margin=0.2, floor=0.3, seed=0)
    assert asked[0] is beside
    assert asked[1] is empirical.without
    left = misfits(new, replace(empirical.without, effects=()))
    added = empirical.term.at(new)
    rms = np.sqrt(np.mean(new.squared(left[0] - added.friction, left[1] - added.load)))
    assert rms == pytest.approx(empirical.gain.after, rel=1e-9)
