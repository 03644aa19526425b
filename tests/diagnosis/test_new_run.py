"""Causes on a run that was kept out: there, not there, or not to be told; and when changes were."""

from dataclasses import replace
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest

from frictioncli.diagnosis.data.build_problem import build_problems
from frictioncli.diagnosis.data.load_levels import two_level_history
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.fit.weighted_fit import WeightedFit, Weights
from frictioncli.diagnosis.search import cause_selection
from frictioncli.diagnosis.search.cause_selection import judged_on_new_run
from frictioncli.diagnosis.search.new_run import NewRunTest, holds_on_new_run, new_run_test
from frictioncli.effects import BY_NAME
from frictioncli.effects.history import history, presence, stretches
from frictioncli.effects.history_text import history_text
from frictioncli.model.noise import Noise
from frictioncli.simulator.settings import SynthesisSettings
from tests.diagnosis.test_standing import cause
from tests.diagnosis.wave_effects import A, B
from tests.diagnosis.wave_effects import effect as waves
from tests.simulation.changed_table import hours, with_friction_step, with_payload
from tests.simulation.torque_table import simulate_torques

NOISE = Noise(point=0.3, pair=0.15, drift=0.15, drift_time=1500.0)
DAYS = ("day1", "day2")


@pytest.fixture(scope="module")
def torques():
    """Two days of a joint that is equation (16) of the motor temperature."""
    table = simulate_torques(SynthesisSettings(seed=3, runs=2, joint_kind="plain"))
    return table[(table["pair"] // 4 % 2 == 0) & (table["position"] // 5 % 2 == 0)]


def fit_of(name, *coefficients, **shape):
    values = np.array(coefficients)
    return EffectFit(BY_NAME[name], shape, values, np.eye(len(values)), 100.0)


def asked(table, fit, noise=NOISE, others=()):
    """Return the test of an effect on the second day, beside others."""
    problem, new = build_problems(table, "motor", "day2")
    extra = problem.temperature_variance
    weighted_fit = WeightedFit(
        Weights.of(problem.layout, noise, extra),
        Weights.of(problem.layout, noise, np.zeros_like(extra)),
    )
    return problem, new_run_test(fit, problem, new, weighted_fit, (noise, noise), others)


def on(table, *days):
    """Return where the later half of these days is."""
    return table["run"].isin(days).to_numpy() & (hours(table) > 3.6)


def first_moment(table):
    """Return the share of the pairs before the first one in the later half of the first day."""
    pairs = table.drop_duplicates(["run", "pair"])
    early = (pairs["run"] == "day1") & ~on(pairs, "day1")
    return float(early.sum() / len(pairs))


def when(problem, found):
    return history_text(found.shape, problem.all_runs, DAYS)


SEEN = history([(0.25, 1.0)])
"""Lasting, as a search that knows the first day only says it."""


@pytest.mark.parametrize(
    ("name", "changed"),
    [
        ("step_change", lambda table, there: with_friction_step(table, there, 2.0)),
        ("payload_change", lambda table, there: with_payload(table, there, 10.0, 3.0)),
    ],
)
class TestChange:
    def fit(self, name, table):
        """Return the change from the pair on at which it came."""
        width = len(BY_NAME[name].coefficients)
        return fit_of(name, *([1.0] * width), moment=first_moment(table), end=1.0)

    def test_recurs(self, torques, name, changed):
        table = changed(torques, on(torques, *DAYS))
        problem, found = asked(table, self.fit(name, table))
        assert found.holds is True
        assert found.amplitude == pytest.approx(1.0, abs=4 * found.error + 0.02)
        assert when(problem, found).endswith("h on in every run")
        late = problem.all_runs.time > 3.6 * 3600
        wrong = (presence(problem.all_runs, found.shape) > 0) != late
        assert wrong.mean() < (0.02 if name == "step_change" else 0.001)

    def test_did_not_last(self, torques, name, changed):
        table = changed(torques, on(torques, "day1"))
        problem, found = asked(table, self.fit(name, table))
        assert found.holds is False
        assert abs(found.amplitude) < 0.3
        assert when(problem, found) == "in run day1 from 3.7 h on"

    def test_lasts(self, torques, name, changed):
        there = on(torques, "day1") | (torques["run"] == "day2").to_numpy()
        table = changed(torques, there)
        problem, found = asked(table, self.fit(name, table))
        assert found.holds is True
        assert found.shape == self.fit(name, table).shape
        assert when(problem, found) == "from 3.7 h of run day1 on"

    def test_that_is_a_tenth_on_the_new_run_is_another_cause(self, torques, name, changed):
        table = changed(torques, on(torques, "day1"))
        again = changed(table, on(table, "day2"))
        tenth = table.assign(
            **{
                column: 0.9 * table[column] + 0.1 * again[column]
                for column in ("friction_torque", "load_torque", "torque_forward", "torque_reverse")
            }
        )
        _, found = asked(tenth, self.fit(name, table))
        assert found.holds is False

    def test_below_what_the_run_can_show_cannot_be_tested(self, torques, name, changed):
        table = changed(torques, on(torques, "day1"))
        loud = Noise(point=300.0, pair=200.0, drift=200.0, drift_time=3000.0)
        fit = self.fit(name, table)
        _, found = asked(table, fit, loud)
        assert found.holds is None
        assert found.shape == fit.shape


def test_a_payload_in_turns_is_told_whichever_recording_of_the_new_run_has_it_first(torques):
    group = torques.groupby("run")["pair"].rank("dense").to_numpy() // 20 % 2
    there = group == np.where(torques["run"] == "day1", 1, 0)
    table = with_payload(torques, there, 10.0, 3.0)
    problem, _ = build_problems(table, "motor", "day2")
    seen = two_level_history(problem)
    _, found = asked(table, fit_of("payload_change", 1.0, 1.0, **seen))
    assert found.holds is True
    assert found.amplitude == pytest.approx(1.0, abs=4 * found.error + 0.02)
    wrong = (presence(problem.all_runs, found.shape) > 0) != there
    assert wrong.mean() < 0.001


def with_stribeck(table, days, size):
    """Return the table with a rise of friction towards low speeds on some days."""
    rise = size * np.exp(-((table["speed"] / 15.0) ** 1.5)) * table["run"].isin(days)
    return table.assign(
        friction_torque=table["friction_torque"] + rise,
        torque_forward=table["torque_forward"] + rise,
        torque_reverse=table["torque_reverse"] - rise,
    )


STRIBECK = fit_of("stribeck", 1.0, velocity=15.0, exponent=1.5, shift=0.0)


def test_a_property_of_the_joint_is_there_on_the_new_run(torques):
    _, found = asked(with_stribeck(torques, DAYS, 6.0), STRIBECK)
    assert found.holds is True
    assert found.amplitude == pytest.approx(1.0, abs=3 * found.error)
    assert found.shape == STRIBECK.shape
    _, absent = asked(with_stribeck(torques, ["day1"], 6.0), STRIBECK)
    assert absent.holds is False
    assert absent.amplitude == pytest.approx(0.0, abs=4 * absent.error)


def test_the_error_counts_the_drift(torques):
    """A day that is a little off as a whole is no evidence of a step."""
    fit = fit_of("step_change", 2.0, **SEEN)
    table = with_friction_step(torques, on(torques, "day1"), 2.0)
    errors = []
    for drift in (0.05, 1.0):
        noise = replace(NOISE, drift=drift, drift_time=20000.0)
        _, found = asked(table, fit, noise)
        errors.append(found.error)
    assert errors[1] > 3 * errors[0]


def test_holds_is_that_of_the_test(torques):
    fit = fit_of("step_change", 2.0, **SEEN)
    problem, new = build_problems(torques, "motor", "day2")
    extra = problem.temperature_variance
    weighted_fit = WeightedFit(
        Weights.of(problem.layout, NOISE, extra),
        Weights.of(problem.layout, NOISE, np.zeros_like(extra)),
    )
    arguments = (fit, problem, new, weighted_fit, (NOISE, NOISE), ())
    assert holds_on_new_run(*arguments) is new_run_test(*arguments).holds


def test_the_other_causes_are_taken_out_first(torques):
    """Beside a payload that recurs, friction that stepped on the first day only did not last."""
    table = with_payload(torques, on(torques, *DAYS), 10.0)
    table = with_friction_step(table, on(table, "day1"), 2.0)
    moment = first_moment(table)
    recurring = history([(moment, 0.5), (0.5 + moment, 1.0)])
    payload = fit_of("payload_change", 10.0, 0.0, **recurring)
    step = fit_of("step_change", 2.0, moment=moment, end=1.0)
    problem, found = asked(table, step, others=(payload,))
    assert found.holds is False
    assert stretches(found.shape) == [(moment, 0.5)]
    assert when(problem, found) == "in run day1 from 3.7 h on"


def test_a_run_in_which_next_to_nothing_is_left_does_not_contradict_a_cause(torques):
    """Running-in over 10 000 deg is over on the second day, which is 0.5 N·m lower for itself."""
    lower = torques["friction_torque"] - 0.5 * (torques["run"] == "day2")
    table = torques.assign(friction_torque=lower)
    _, found = asked(table, fit_of("run_in", 12.0, distance=10_000.0))
    assert found.amplitude < -10.0
    assert found.holds is None


def test_a_cause_whose_torque_the_runs_seen_do_not_determine_is_not_absent(torques):
    """Two waves are nearly the same on the first day, and opposite on the second.

    Which of both it is, the first day hardly tells, so that nothing is known of the second; where
    they differ on the first, it is.
    """

    def second(rows, apart):
        turned = np.where(rows.run == rows.run.max(), -1.0, 1.0)
        return turned * A(rows) + apart * B(rows)

    table = torques.assign(
        friction_torque=torques["friction_torque"] + 0.3 * A(torques),
    )
    held = []
    for apart in (0.01, 1.0):
        effect = waves("two", [(1.0, A)], [(1.0, partial(second, apart=apart))])
        fit = EffectFit(effect, {}, np.array([0.0, 0.3]), np.eye(2), 100.0)
        held.append(asked(table, fit)[1])
    assert held[0].holds is None
    assert held[1].holds is True
    assert held[1].amplitude == pytest.approx(1.0, abs=3 * held[1].error)


@pytest.mark.parametrize(
    ("name", "standing"),
    [("load_linear", "named"), ("rest_recovery", "visible"), ("sensor_lag", "visible")],
)
def test_what_is_there_on_every_day_is_refuted_by_a_day_without(monkeypatch, name, standing):
    """The same sensor reads every day; a property of the joint may have gone."""
    absent = NewRunTest(holds=False, amplitude=0.1, error=0.01, shape={})
    monkeypatch.setattr(cause_selection, "new_run_test", lambda *_: absent)
    effect = BY_NAME[name]
    shape = {one.name: one.at(0.5) for one in effect.shape}
    width = len(effect.coefficients)
    found = cause(effect, (1.0,) * width, (0.1,) * width, shape=shape)
    found = replace(found, standing="named", test=replace(found.test, p_value=1e-9))
    step = SimpleNamespace(problem=None, weighted_fit=lambda: None, noise=lambda: None)
    (judged,) = judged_on_new_run([found], step, None)
    assert (judged.holds_on_new_run, judged.standing) == (False, standing)
