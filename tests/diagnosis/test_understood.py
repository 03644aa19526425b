"""Causes beside structure without a name, and what the residuals show of a cause at face value."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from frictioncli.diagnosis.data.build_problem import simulated
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.search.axis_columns import axis_columns
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.effect_size import left_size
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.diagnosis.search.shown import Shown, shown_by_residuals
from frictioncli.diagnosis.search.step import Step
from frictioncli.diagnosis.search.understood import _is_form_of, is_part, understood
from frictioncli.diagnosis.search.without_a_name import (
    beyond_doubt_without_a_name,
    change_over_time,
)
from frictioncli.effects import BY_NAME
from frictioncli.model.friction import FrictionParameters
from tests.diagnosis.dense_noise import days, problem
from tests.diagnosis.wave_effects import B, effect, wave
from tests.equation_16 import TRUTH

MARGIN = 0.1
ALPHA = 0.05
SHORT = wave(7.0)
RIPPLE = effect("ripple", [(1.0, SHORT)])


def accepted(data):
    """Return the step with the ripple accepted, and the cause."""
    precomputed = Precomputed.of(data)
    fit = Step.of(precomputed, []).fitted(RIPPLE, {})
    size, low, high = left_size(precomputed, fit)
    cause = Cause(
        fit=fit,
        test=None,
        effects=("ripple",),
        probabilities={"ripple": 1.0},
        size=size,
        visible=size,
        visible_interval=(low, high),
    )
    return Step.of(precomputed, [fit]), cause


@pytest.mark.parametrize(("peak", "is_named"), [(0.0, True), (0.4, True), (3.0, False)])
def test_a_cause_loses_its_name_to_structure_along_its_axis_that_is_nearly_as_large(peak, is_named):
    """A ripple of 1 N·m, and a peak at one angle."""
    data = problem(3, friction=lambda rows: 1.0 * SHORT(rows))
    torque = peak * np.exp(-np.square((data.table.position - 40.0) / 9.0))
    data = replace(data, friction=data.friction + torque)
    step, cause = accepted(data)
    causes, structure = understood(step, [cause], MARGIN, ALPHA)
    assert (causes == (cause,)) is is_named
    if not is_named:
        assert structure is not None
        assert structure.axes in {("position",), ("load",)}
        # what is left without the cause contains the ripple
        assert structure.size > 0.95 / np.sqrt(2)


def test_structure_along_another_axis_takes_no_name():
    data = problem(3, friction=lambda rows: 1.0 * SHORT(rows))
    levels = np.unique(data.table.speed)
    resonance = np.where(data.table.speed == levels[len(levels) // 2], 3.0, 0.0)
    data = replace(data, friction=data.friction + resonance)
    step, cause = accepted(data)
    causes, structure = understood(step, [cause], MARGIN, ALPHA)
    assert causes == (cause,)
    assert structure is not None
    assert structure.axes == ("speed",)


@pytest.mark.parametrize("share", [0.0, 0.3, 1.0])
def test_the_residuals_show_a_share_of_a_cause_at_face_value(share):
    """Beside another effect, whose torque is taken off first."""
    data = problem(5, friction=lambda rows: 2.0 * share * SHORT(rows) + 3.0 * B(rows))
    precomputed = Precomputed.of(data)
    own = EffectFit(RIPPLE, {}, np.array([2.0]), np.array([[1e-4]]), 1.0)
    other = EffectFit(effect("other", [(1.0, B)]), {}, np.array([3.0]), np.array([[1e-4]]), 1.0)
    assert shown_by_residuals(precomputed, own, [other]).share == pytest.approx(share, abs=0.05)


@pytest.mark.parametrize(("fastest_alone", "slower"), [(False, 1.0), (True, 0.0)])
def test_slower_moves_show_a_ripple_unless_fast_ones_alone_have_it(fastest_alone, slower):
    """As one has that is too fine for their samples; a quarter of the pairs is as fast."""

    def ripple(rows):
        fast = rows["speed"] > 0.9 * rows["speed"].max()
        return 2.0 * SHORT(rows) * (4.0 * fast if fastest_alone else 1.0)

    precomputed = Precomputed.of(problem(5, friction=ripple))
    own = EffectFit(RIPPLE, {}, np.array([2.0]), np.array([[1e-4]]), 1.0)
    shown = shown_by_residuals(precomputed, own, [])
    assert shown.share == pytest.approx(1.0, abs=0.05)
    assert shown.slower == pytest.approx(slower, abs=0.1)


def test_a_delay_that_is_in_the_log_is_shown_beside_the_base():
    """The load at 100 deg/s that is 20 ms late is that of 2 deg before."""
    data = problem(5)
    columns = data.basis(BY_NAME["torque_delay"], {})
    late = replace(
        data,
        friction=data.friction + 0.02 * columns.friction[:, 0],
        load=data.load + 0.02 * columns.load[:, 0],
    )
    own = EffectFit(BY_NAME["torque_delay"], {}, np.array([0.02]), np.array([[1e-8]]), 1.0)
    for one, share in ((late, 1.0), (data, 0.0)):
        known = Precomputed.of(one, (BY_NAME["torque_delay"],))
        assert shown_by_residuals(known, own, []).share == pytest.approx(share, abs=0.1)


@pytest.mark.parametrize(
    ("friction", "expected"), [(0.0, False), (1.0, True), (-1.0, True), (0.3, False)]
)
def test_load_that_changes_with_an_equal_friction_changes_in_one_direction(friction, expected):
    """On the second day, 3 N·m at 90 deg, and a share of it in friction."""

    def more(rows):
        return 3.0 * np.sin(np.radians(rows["position"])) * (rows["run"] == "day2")

    data = problem(5, friction=lambda rows: friction * more(rows), load=more)
    payload = BY_NAME["payload_change"]
    shape = {"moment": 0.5, "end": 1.0}
    own = EffectFit(payload, shape, np.array([0.0, 3.0]), np.diag([1e-4, 1e-4]), 1.0)
    assert shown_by_residuals(Precomputed.of(data), own, []).one_direction is expected


def test_another_scale_of_the_torque_changes_both_directions():
    """Load and friction grow by 6 %; friction by more than half of that of the load."""

    def more(column):
        return lambda rows: 0.06 * rows[column] * (rows["run"] == "day2")

    data = problem(5, friction=more("friction_torque"), load=more("load_torque"))
    payload = BY_NAME["payload_change"]
    shape = {"moment": 0.5, "end": 1.0}
    own = Step.of(Precomputed.of(data), []).fitted(payload, shape)
    assert not shown_by_residuals(Precomputed.of(data), own, []).one_direction


def test_a_change_in_one_direction_that_is_beyond_doubt_is_structure_along_time():
    _, cause = accepted(problem(3, friction=SHORT))
    one = replace(
        cause,
        test=SimpleNamespace(p_value=1e-9, statistic=50.0),
        standing="undetermined",
        shown=Shown(one_direction=True),
    )
    low, _ = one.visible_interval
    assert beyond_doubt_without_a_name([one], [], low / 2) == (one,)
    assert not beyond_doubt_without_a_name([one], ["ripple"], low / 2)
    assert not beyond_doubt_without_a_name([one], [], 2 * low)
    structure = change_over_time([one])
    assert (structure.axes, structure.size) == (("time",), one.visible)
    assert change_over_time([replace(one, shown=Shown())]) is None


def test_a_lag_that_a_new_run_refutes_is_structure_along_time():
    """What it describes on the runs seen is there, whatever it is."""
    _, cause = accepted(problem(3, friction=SHORT))
    one = replace(
        cause,
        fit=replace(cause.fit, effect=replace(BY_NAME["thermal_lag"])),
        test=SimpleNamespace(p_value=1e-9, statistic=50.0),
        standing="visible",
    )
    low, _ = one.visible_interval
    assert beyond_doubt_without_a_name([one], [], low / 2) == (one,)
    structure = change_over_time([one])
    assert (structure.axes, structure.channel) == (("time",), "friction")
    assert structure.size == one.visible
    # not determined: days may differ
    assert change_over_time([replace(one, standing="undetermined")]) is None


def structure_of(size, *axes, channel="friction"):
    return SimpleNamespace(size=size, axes=axes, channel=channel)


@pytest.mark.parametrize(
    ("name", "unnamed", "expected"),
    [
        # along its own axis, more than a third of it
        ("stribeck", structure_of(0.4, "speed"), True),
        ("stribeck", structure_of(0.3, "speed"), False),
        ("stribeck", structure_of(5.0, "temperature"), False),
        # a step may be a part of anything that varies slowly, if that is larger
        ("step_change", structure_of(1.1, "temperature"), True),
        ("step_change", structure_of(0.9, "temperature"), False),
        ("step_change", structure_of(0.4, "time"), True),
        ("step_change", structure_of(5.0, "temperature", channel="load"), False),
        # so may what follows the temperature, which varies slowly, of something along the time
        ("coulomb_temperature", structure_of(1.1, "time"), True),
        ("coulomb_temperature", structure_of(0.9, "time"), False),
        ("coulomb_temperature", structure_of(5.0, "position", "time"), False),
        ("stribeck", structure_of(5.0, "time"), False),
        ("payload_change", structure_of(5.0, "temperature"), False),
        ("torque_delay", structure_of(5.0, "position"), False),
    ],
)
def test_a_cause_is_part_of_structure(name, unnamed, expected):
    shape = {"moment": 0.3, "end": 0.6} if "change" in name else {"velocity": 10.0}
    own = EffectFit(BY_NAME[name], shape, np.array([1.0]), np.eye(1), 1.0)
    assert is_part(own, 1.0, unnamed, problem(5)) is expected


@pytest.mark.parametrize(
    ("runs", "distance", "expected"),
    [
        (["day1"], 3e3, True),
        # it goes on while the joint cools down again
        (["day1"], 1e6, False),
        # the second day is as cold, without it
        (["day1", "day2"], 3e3, False),
    ],
)
def test_what_is_there_in_the_coldest_pairs_alone_may_be_a_part_of_the_temperature(
    runs, distance, expected
):
    """A joint that warms up and cools down on every day, and runs in on the first one."""
    rows = days(5)
    rows = rows[rows["run"].isin(runs)]
    gravity = np.array([95.0, 0.0, 0.0])
    _, data = simulated(rows, "motor", FrictionParameters(**TRUTH), gravity)
    own = EffectFit(BY_NAME["run_in"], {"distance": distance}, np.array([3.0]), np.eye(1), 1.0)
    assert is_part(own, 1.0, structure_of(0.4, "temperature"), data) is expected
    assert not is_part(own, 1.0, structure_of(0.3, "temperature"), data)
    assert is_part(own, 1.0, structure_of(0.4, "time"), data)


@pytest.mark.parametrize(
    ("size", "axes", "expected"),
    [
        (0.2, ("load", "temperature"), True),
        (0.2, ("temperature",), True),
        (0.4, ("load", "temperature"), False),
        (0.2, ("load", "speed"), False),
    ],
)
def test_structure_of_a_tenth_of_a_cause_along_its_axes_is_the_error_of_its_form(
    size, axes, expected
):
    fit = SimpleNamespace(effect=BY_NAME["load_temperature"])
    structure = SimpleNamespace(size=size, axes=axes, channel="friction")
    assert _is_form_of(SimpleNamespace(size=3.0, visible=1.5, fit=fit), structure) is expected
    # it is more than the base leaves of a cause of which it takes most
    assert not _is_form_of(SimpleNamespace(size=3.0, visible=0.15, fit=fit), structure)


def test_structure_of_the_load_is_the_same_for_loads_to_either_side():
    """As friction is; a bump at one angle is not, and so is told from it with one payload."""
    data = problem(3)
    mirrored = replace(data, table=replace(data.table, load=-data.table.load))
    place = (("load",), "friction")
    np.testing.assert_allclose(axis_columns(data)[place], axis_columns(mirrored)[place])


@pytest.mark.parametrize(("ripple", "is_named"), [(2.0, True), (0.7, False)])
def test_a_cause_that_explains_most_of_the_structure_keeps_its_name(ripple, is_named):
    """Beside another cause that looks like it, the base leaves less of it than it explains."""
    data = problem(3, friction=lambda rows: ripple * SHORT(rows))
    torque = 1.3 * np.exp(-np.square((data.table.position - 40.0) / 9.0))
    step, cause = accepted(replace(data, friction=data.friction + torque))
    small = replace(cause, visible=0.3)
    causes, structure = understood(step, [small], MARGIN, ALPHA)
    assert structure.size > small.visible / 3
    assert structure.axes in {("position",), ("load",)}
    assert (causes == (small,)) is is_named
