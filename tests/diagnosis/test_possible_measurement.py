"""Effects of the measurement beyond what drives, loggers and gears do, or that no data tell."""

import json

import numpy as np
import pandas as pd
import pytest

from frictioncli.diagnosis.data.build_problem import build_problems
from frictioncli.diagnosis.diagnose import diagnose_joint
from frictioncli.diagnosis.fit.hypotheses import EffectFit, physical_bounds
from frictioncli.diagnosis.search.measurement import beside_base, clear_effects, measurement_causes
from frictioncli.diagnosis.search.possible import smoother_than_late
from frictioncli.diagnosis.search.step import Step
from frictioncli.diagnosis.search.timing_causes import late_torque
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.effects import BY_NAME, MEASUREMENT_EFFECTS
from tests.equation_16 import TRUTH, friction, table
from tests.studies.blind_examined import examined
from tests.studies.blind_worlds import World

SPEEDS = (25.0, 40.0)
WEIGHT = 13.4


def coarse(
    seed=0,
    *,
    delay=0.0,
    play=0.0,
    turning=0.0,
    along=0.0,
    speeds=SPEEDS,
    pairs=60,
    noise=0.3,
    weight=WEIGHT,
    bins=20.0,
):
    """Return a joint at two slow speeds, its torque known every ``bins`` [deg].

    Torque is late by ``delay`` [s], the position logged forward exceeds that in reverse by ``play``
    [deg], and friction goes up and down with the angle by ``along`` [N·m], and by ``turning`` at
    the faster speed the other way round than at the slower.
    """
    generator = np.random.default_rng(seed)
    position = np.arange(-110.0, 111.0, bins)
    speed = np.resize(speeds, pairs)[:, np.newaxis]
    warm = np.linspace(28.0, 40.0, pairs)[:, np.newaxis]
    ways = []
    for way in (1, -1):
        angle = np.radians(position - way * (speed * delay + play / 2))
        load = weight * np.cos(angle)
        torque = friction(TRUTH, load=load, speed=speed, temperature=warm)
        torque = torque + (along + turning * np.sign(speed - np.mean(speeds))) * np.sin(angle)
        ways.append(load + way * torque + noise * generator.normal(size=load.shape))
    half, mean = (ways[0] - ways[1]) / 2, (ways[0] + ways[1]) / 2
    half = half + 0.1 * generator.normal(size=speed.shape)
    columns = {
        "speed": speed[:, 0],
        "time": 30.0 * np.arange(pairs),
        "phase": np.full(pairs, "heat-up"),
        "motor_temperature": warm[:, 0],
        "housing_temperature": np.full(pairs, np.nan),
        "motor_temperature_reading": warm[:, 0] + 0.1,
    }
    rows = table(columns, position=position, friction_torque=half, load_torque=mean[0])
    return rows.assign(
        load_torque=mean.ravel(),
        torque_forward=(mean + half).ravel(),
        torque_reverse=(mean - half).ravel(),
        load=np.nan,
        payload=np.nan,
    )


def problem_of(rows: pd.DataFrame):
    return build_problems(rows, "motor")[0]


def stands(problem):
    """Return the first coefficients of what stands beside the base, and why others do not."""
    beside = beside_base(problem)
    causes = measurement_causes(Step.of(beside.precomputed, []), beside.effects)
    return (
        {one.fit.effect.name: one.fit.coefficients[0] for one in causes},
        {one.fit.effect.name: one.reason for one in beside.refused},
    )


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("turning", [0.3, 1.0])
def test_friction_that_turns_over_with_speed_is_no_delay_beside_a_play(turning, seed):
    """A delay of 0.17 or 0.56 s beside a play of -11 or -37 deg would do the same: no log does."""
    problem = problem_of(coarse(seed, turning=turning))
    beside, refused = stands(problem)
    assert {"backlash", "torque_delay"}.isdisjoint(beside)
    assert "physically impossible" in refused["backlash"]
    assert "depends on a physically impossible backlash" in refused["torque_delay"]
    assert late_torque(problem, None) is None


@pytest.mark.parametrize("noise", [0.03, 0.1])
def test_friction_along_the_angle_is_no_delay_once_the_play_is_refused(noise):
    """A play of 14 deg would do the same, and beside it there is no evidence of a delay."""
    problem = problem_of(coarse(3, along=1.5, speeds=(40.0, 50.0), noise=noise))
    beside, refused = stands(problem)
    assert {"backlash", "torque_delay"}.isdisjoint(beside)
    assert "physically impossible" in refused["backlash"]
    assert "depends on a physically impossible backlash" in refused["torque_delay"]
    assert late_torque(problem, None) is None


def test_a_filter_of_the_torque_is_not_looked_for_in_a_load_that_is_measured_apart():
    """Its first term, the delay, shows in friction all the same."""
    rows = coarse(1, delay=0.06, noise=0.1)
    apart = problem_of(rows.assign(load=rows["load_torque"]))
    beside, refused = stands(apart)
    assert "torque_filter" not in beside | refused
    assert beside["torque_delay"] == pytest.approx(0.06, abs=0.012)


def test_what_is_refused_is_listed_with_the_reason_and_never_named():
    diagnosis = diagnose_joint(coarse(turning=1.0), "motor", "N·m", DiagnosisSettings())
    names = {name for cause in diagnosis.causes for name in cause.effects}
    assert names.isdisjoint(one.name for one in MEASUREMENT_EFFECTS)
    assert diagnosis.structure is not None
    reasons = {one.fit.effect.name: one.reason for one in diagnosis.visible}
    assert "impossible" in reasons["backlash"]
    assert {one.fit.effect.name for one in diagnosis.corrected} == set()


@pytest.mark.parametrize("speeds", [SPEEDS, (10.0, 30.0, 60.0, 100.0)])
def test_a_delay_of_a_drive_is_measured_beside_bins_of_20_degrees(speeds):
    """At two slow speeds too; a play of 1 deg at most cannot be told there and is not."""
    problem = problem_of(coarse(1, delay=0.06, speeds=speeds, noise=0.1))
    beside, refused = stands(problem)
    assert beside["torque_delay"] == pytest.approx(0.06, abs=0.012)
    assert "; possible is -1 to 1 deg" in refused.get("backlash", "only,")
    assert late_torque(problem, None).delay == pytest.approx(0.06, abs=0.012)


def test_a_play_is_measured_where_the_data_tell_it():
    """0.8 deg of the slope of 150 N·m, from slow to fast."""
    rows = coarse(2, play=0.8, speeds=(5.0, 15.0, 40.0, 100.0), noise=0.1, weight=150.0)
    beside, _ = stands(problem_of(rows))
    assert beside["backlash"] == pytest.approx(0.8, abs=0.3)


def test_a_ripple_does_not_hide_a_constant_that_does_not_load_the_gear():
    """Friction that goes up and down with the angle makes anything along it uncertain, until it is
    known to be there."""
    rows = coarse(noise=0.1, weight=60.0, speeds=(5.0, 15.0, 40.0, 100.0), bins=10.0)
    phase = 7 * np.radians(rows["position"])
    ripple = 2.0 * np.sin(phase + 0.4) + np.sin(2 * phase)
    rows = rows.assign(
        load_torque=rows["load_torque"] + 6.0, friction_torque=rows["friction_torque"] + ripple
    )
    problem = problem_of(rows)
    before, refused = stands(problem)
    assert "load_offset" not in before
    assert "only to" in refused["load_offset"]
    alone = Step.of(beside_base(problem).precomputed, [])
    known = [alone.fitted(BY_NAME["position_ripple"], {"order": 7.0})]
    assert BY_NAME["load_offset"] in clear_effects(beside_base(problem, found=known), known)
    diagnosis = diagnose_joint(rows, "motor", "N·m", DiagnosisSettings())
    named = {one.effects: one.fit.coefficients for one in diagnosis.causes}
    assert set(named) == {("load_offset",), ("position_ripple",)}
    assert named["load_offset",] == pytest.approx([6.0], abs=2.0)


def test_a_part_of_the_constant_is_no_more_than_that_and_a_tenth_of_the_load():
    """An offset of the sensor and a counterbalance may cancel each other, but not by much."""
    problem = problem_of(coarse())
    constant, tenth = problem.gravity[2], np.abs(problem.table.load).max() / 10
    lower, upper = physical_bounds(BY_NAME["load_offset"], problem)
    assert upper[0] == pytest.approx(max(constant, 0) + tenth)
    assert lower[0] == pytest.approx(min(constant, 0) - tenth)
    assert upper[0] < 0.11 * WEIGHT + abs(constant)


def test_friction_that_grows_with_a_load_of_one_sign_is_no_offset():
    """Over -60 to 60 deg it looks like one of -40 N·m, of a constant of 0."""
    rows = coarse(2, noise=0.1, weight=150.0, speeds=(5.0, 15.0, 40.0, 100.0))
    rows = rows[np.abs(rows["position"]) < 65.0]
    load = rows["load_torque"]
    growing = rows.assign(friction_torque=rows["friction_torque"] + 80 * TRUTH["alpha"] * load)
    beside, refused = stands(problem_of(growing))
    assert "load_offset" not in beside
    assert "possible is -14.8 to 14.8" in refused["load_offset"]


def test_every_bound_of_the_measurement_is_of_a_log_that_there_is():
    """Drives filter for a tenth of a second, loggers are late by a few cycles; no gear has a play
    of more than a degree; sensors in motors follow within minutes."""
    most = {"delay": 0.3, "second_moment": 0.1, "play": 1.0}
    most |= {"time_constant": 300.0, "not_carried": 30.0}
    for effect in MEASUREMENT_EFFECTS:
        for one in effect.coefficients:
            assert max(abs(one.lower), abs(one.upper)) <= most[one.name]


def moments(times, response):
    """Return mean lateness [s] and half the second moment [s²] of a response over time."""
    weight = response / response.sum()
    mean = float(weight @ times)
    return mean, float(weight @ np.square(times)) / 2


def fits(lateness, second_moment, error=1e-5):
    """Return a filter and a delay as if they had been fitted."""
    return tuple(
        EffectFit(BY_NAME[name], {}, np.array([value]), np.array([[one**2]]), 100.0)
        for name, value, one in (
            ("torque_filter", second_moment, error),
            ("torque_delay", lateness, 1e-4),
        )
    )


@pytest.mark.parametrize("positions_late", [0.0, 0.004, 0.025])
@pytest.mark.parametrize("delay", [0.0, 0.012, 0.1])
@pytest.mark.parametrize("order", [1, 2, 4])
def test_every_filter_of_a_drive_is_late_by_what_it_smooths(order, delay, positions_late):
    """Equal stages in a row; the lateness of the positions counts from that of the torque."""
    times = np.arange(0.0, 1.2, 1e-4)
    response = times ** (order - 1) * np.exp(-times / 0.02)
    lateness, second_moment = moments(times + delay - positions_late, response)
    assert smoother_than_late(*fits(lateness, second_moment)) == ""


@pytest.mark.parametrize("positions_late", [0.03, 0.08])
def test_torque_that_is_logged_too_early_may_have_passed_a_filter_all_the_same(positions_late):
    times = np.arange(0.0, 0.5, 1e-4)
    lateness, second_moment = moments(times - positions_late, np.exp(-times / 0.02))
    assert lateness < 0.0
    assert smoother_than_late(*fits(lateness, second_moment)) == ""


def test_a_moving_average_is_late_by_what_it_smooths():
    times = np.arange(0.0, 0.1, 1e-4)
    assert smoother_than_late(*fits(*moments(times, np.ones_like(times)))) == ""


def test_a_torque_that_is_hardly_late_has_passed_no_filter_of_a_tenth_of_a_second():
    """Nor can such data tell which one it has, beside what looks like a filter."""
    assert "late by 0.0200 s" in smoother_than_late(*fits(0.02, 0.009, 0.001))
    assert smoother_than_late(*fits(0.02, 0.009, 0.005)) == ""
    assert smoother_than_late(*fits(0.02, 0.0003, 0.001)) == ""
    assert "only to ±0.002 s²" in smoother_than_late(*fits(0.02, 0.0003, 0.001), alone=False)
    assert smoother_than_late(*fits(0.02, 0.0003, 0.0002), alone=False) == ""


@pytest.mark.long
@pytest.mark.parametrize("seed", [0, 5, 9])
def test_inertia_is_no_filter_of_a_torque_that_hardly_lags(seed):
    """At the ends of the stroke it would be one of 0.13 s, behind a delay of -0.11 s."""
    row = examined(World("single", "inertia", seed, size=1.0), "")
    causes = {tuple(one["effects"]): one for one in json.loads(str(row["causes_json"]))}
    true = json.loads(str(row["nuisances_json"]))["torque_delay"]["delay"]
    _, low, high = causes["torque_delay",]["parameters"]["delay"]
    assert 0.0 <= low <= true <= high
    left = json.loads(str(row["hidden_json"]))[0]["left_beside"]
    low, high = causes["inertia",]["visible_ci95"]
    assert low <= left <= high


@pytest.mark.long
def test_what_the_model_lacks_gives_up_no_delay():
    """A lag of the gear makes the sensor's lag impossible; without that one a precise delay moves
    by more than its error, and is there all the same. Given up, its torque would become friction.
    """
    world = World("pair", "thermal_lag+stribeck", 0, size=1.0, protocol="enriched")
    row = examined(world, "")
    named = {tuple(one["effects"]) for one in json.loads(str(row["causes_json"]))}
    assert {("torque_delay",), ("thermal_lag",)} <= named
