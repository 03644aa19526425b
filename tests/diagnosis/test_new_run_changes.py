"""Changes that begin on the held-out run, and what else such a run may have."""

import numpy as np
import pytest

from frictioncli.diagnosis.data.build_problem import build_problems
from frictioncli.diagnosis.fit.extension import extend, misfits, rms_misfit
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.fit.weighted_fit import WeightedFit, Weights
from frictioncli.diagnosis.search.new_run_changes import changes_on_new_run, with_effect
from frictioncli.diagnosis.search.new_run_misfit import NewRunMisfit
from frictioncli.diagnosis.search.structure import Structure
from frictioncli.effects import BY_NAME, EFFECTS
from frictioncli.effects.history import stretches
from frictioncli.model.noise import Noise
from frictioncli.simulator.settings import SynthesisSettings
from tests.simulation.changed_table import hours, with_friction_step, with_payload
from tests.simulation.torque_table import simulate_torques

NOISE = Noise(point=0.3, pair=0.15, drift=0.15, drift_time=1500.0)
FLOOR = float(np.sqrt(2 * (0.3**2 + 0.15**2)))


@pytest.fixture(scope="module")
def torques():
    """Two days of a joint that is equation (16) of the motor temperature."""
    table = simulate_torques(SynthesisSettings(seed=3, runs=2, joint_kind="plain"))
    return table[(table["pair"] // 4 % 2 == 0) & (table["position"] // 5 % 2 == 0)]


def found(table, margin=0.26, structure=None):
    """Return the changes on the second day, the extended model, and that day."""
    problem, new = build_problems(table, "motor", "day2")
    extra = problem.temperature_variance
    weights = [Weights.of(problem.layout, NOISE, one) for one in (extra, np.zeros_like(extra))]
    weighted_fit = WeightedFit(*weights)
    extension = extend(problem, weighted_fit, [])
    residual = NewRunMisfit.of(problem, new, extension, weighted_fit, (NOISE, NOISE))
    usual = rms_misfit(problem, extension)
    causes = changes_on_new_run(
        residual, EFFECTS, floor=FLOOR, usual=usual, margin=margin, structure=structure
    )
    return causes, extension, new


def second(table, after=-1.0):
    """Return where the second day is, from an hour on."""
    return (table["run"] == "day2").to_numpy() & (hours(table) > after)


def moment(table, there):
    """Return the share of all pairs before the first that has a change."""
    pairs = table.assign(there=there).drop_duplicates(["run", "pair"]).sort_values(["run", "time"])
    return float(np.argmax(pairs["there"].to_numpy()) / len(pairs))


def test_a_payload_on_a_joint_that_rings_behind_its_ramps_every_day(torques):
    """2 N·m of load at the fastest moves' outer angles on both days are no part of what begins."""
    fastest = (torques["speed"] > 0.9 * torques["speed"].max()).to_numpy()
    ringing = np.where(fastest, 4.0 * np.cos(np.radians(9.0 * torques["position"])), 0.0)
    rings = torques.assign(load_torque=torques["load_torque"] + ringing)
    assert found(rings)[0] == ()
    (cause,), _, _ = found(with_payload(rings, second(torques), 2.0, 1.0))
    assert cause.effects == ("payload_change",)
    assert cause.fit.coefficients == pytest.approx([2.0, 1.0], abs=0.3)


def test_a_load_that_follows_the_temperature_on_every_day_is_no_payload(torques):
    """The warm hours of the new day have as much more load as those of the day before."""
    gain = 1 + 0.004 * (torques["motor_temperature"] - torques["motor_temperature"].mean())
    alike = torques.assign(load_torque=torques["load_torque"] * gain)
    assert found(alike)[0] == ()
    (cause,), _, _ = found(with_payload(alike, second(torques), 5.0, 2.0))
    assert cause.effects == ("payload_change",)


@pytest.mark.parametrize("after", [-1.0, 3.6])
def test_a_payload_that_is_put_on(torques, after):
    """5 N·m at 0 deg and 2 at 90 deg, on the whole day or from noon on."""
    there = second(torques, after)
    (cause,), _, _ = found(with_payload(torques, there, 5.0, 2.0))
    assert cause.effects == ("payload_change",)
    assert (cause.holds_on_new_run, cause.only_on_new_run) == (True, True)
    assert cause.fit.coefficients == pytest.approx([5.0, 2.0], abs=0.2)
    ((begin, end),) = stretches(cause.fit.shape)
    assert (begin, end) == (pytest.approx(moment(torques, there), abs=0.01), 1.0)


@pytest.mark.parametrize(
    ("share", "first"),
    [(0.025, "torque_scale"), (0.08, "payload_change")],
)
def test_a_small_change_in_the_form_of_gravity_is_likelier_one_of_the_scale(torques, share, first):
    """Friction that stays as it was says little of 2.5 %, and that 8 % are a payload."""
    load = torques["load_torque"] * np.where(second(torques), 1 + share, 1.0)
    (cause,), _, _ = found(torques.assign(load_torque=load))
    assert cause.effects[0] == cause.fit.effect.name == first
    if first == "torque_scale":
        assert cause.fit.coefficients == pytest.approx([100 * share], abs=0.3)


@pytest.mark.parametrize("after", [-1.0, 3.6])
def test_a_step_of_friction(torques, after):
    """3 N·m, more than 3 % of the friction."""
    there = second(torques, after)
    (cause,), extension, new = found(with_friction_step(torques, there, 3.0))
    assert cause.effects == ("step_change",)
    assert cause.fit.coefficients == pytest.approx([3.0], abs=0.4)
    ((begin, end),) = stretches(cause.fit.shape)
    assert (begin, end) == (pytest.approx(moment(torques, there), abs=0.01), 1.0)
    # with the change the day is as well predicted as without it
    explained = with_effect(extension, cause.fit, 0)
    assert len(explained.errors) == len(extension.errors) + 1
    left = np.sqrt(np.mean(new.squared(*misfits(new, explained))))
    assert left < 1.25 * FLOOR


@pytest.mark.parametrize(
    ("axes", "channel", "share", "is_named"),
    [
        (("time",), "load", 0.5, False),
        (("position", "time"), "load", 0.5, False),
        (("time",), "load", 0.2, True),
        (("time",), "friction", 0.5, True),
        (("position",), "load", 0.5, True),
    ],
)
def test_a_load_that_changes_with_time_every_day_is_no_payload(
    torques, axes, channel, share, is_named
):
    """As where another joint, which no log has, moves on slowly between the days as well."""
    table = with_payload(torques, second(torques), 5.0, 2.0)
    size = share * float(np.std(table["load_torque"] - torques["load_torque"]))
    along = Structure(
        axes=axes, channel=channel, p_value=0.0, statistic=99.0, size=size, interval=(size, size)
    )
    assert len(found(table, structure=along)[0]) == is_named


def test_friction_that_steps_in_proportion_is_a_step(torques):
    """8 % more friction from noon on: within a run whatever friction depends on steps."""
    there = second(torques, 3.6)
    more = np.where(there, 0.08 * torques["friction_torque"], 0.0)
    (cause,), _, _ = found(torques.assign(friction_torque=torques["friction_torque"] + more))
    assert cause.effects == ("step_change",)
    mean = float(more[there].mean())
    assert cause.fit.coefficients == pytest.approx([mean], rel=0.15)
    ((begin, _),) = stretches(cause.fit.shape)
    assert begin == pytest.approx(moment(torques, there), abs=0.01)


def test_the_effect_stands_at_its_place(torques):
    """Effects that are corrected without a name follow the causes."""
    problem, _ = build_problems(torques, "motor", "day2")
    weights = Weights.of(problem.layout, NOISE, problem.temperature_variance)
    fits = [
        EffectFit(BY_NAME[name], {}, np.ones(width), np.eye(width), 1.0)
        for name, width in (("load_linear", 1), ("load_offset", 1))
    ]
    extension = extend(problem, WeightedFit(weights, weights), fits)
    change = EffectFit(
        BY_NAME["payload_change"], {"moment": 0.5, "end": 1.0}, np.ones(2), np.diag([4.0, 9.0]), 1.0
    )
    both = with_effect(extension, change, 1)
    assert [one.effect.name for one in both.effects] == [
        "load_linear",
        "payload_change",
        "load_offset",
    ]
    # a twentieth of the coefficients besides, for what differs from day to day
    assert both.errors[-3:-1] == pytest.approx([np.sqrt(4.0025), np.sqrt(9.0025)])
    assert both.errors[-1] == extension.errors[-1]
    assert len(both.shape_errors) == len(extension.shape_errors) + 2


def friction(table, added):
    return table.assign(
        friction_torque=table["friction_torque"] + np.where(second(table), added, 0)
    )


def nothing(table):
    return table


def days_differ(table):
    """1 N·m on the whole day, of a mean friction of about 50."""
    return friction(table, 1.0)


def slow(table):
    """Friction that falls by 4 N·m over the day."""
    return friction(table, 4.0 * (1 - hours(table) / hours(table).max()))


def approaches(table):
    """Friction that approaches another level with a time constant of an hour."""
    return friction(table, 4.0 * (1 - np.exp(-hours(table))))


def scaled(table):
    """8 % more friction all day."""
    return friction(table, 0.08 * table["friction_torque"])


def viscous(table):
    """Friction that grows with speed all day."""
    return friction(table, 0.4 * np.sqrt(table["speed"]))


def ripple(table):
    """A ripple over the joint angle that the first day does not have."""
    return friction(table, 3.0 * np.sin(3 * np.radians(table["position"])))


def another_joint_moves(table):
    """Gravity of another joint that is elsewhere on that day, and moves 5 N·m back over it."""
    there = 1 - hours(table) / hours(table).max()
    gravity = np.cos(np.radians(table["position"])) * np.where(second(table), 5.0 * there, 0.0)
    return table.assign(load_torque=table["load_torque"] + gravity)


@pytest.mark.parametrize(
    "other",
    [nothing, days_differ, slow, approaches, scaled, viscous, ripple, another_joint_moves],
)
def test_what_else_a_day_may_have_is_no_change(torques, other):
    causes, _, _ = found(other(torques))
    assert causes == ()
