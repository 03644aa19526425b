"""The predicted uncertainty grows as computed by hand, and the realised error is of its size."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from frictioncli.correction.deviation import (
    LEAST_PAIRS,
    CorrectionPairs,
    DeviationProcess,
    correction_pairs_of,
    fit_deviation_process,
)
from frictioncli.correction.evaluation import evaluate
from frictioncli.correction.replay import PhaseData
from frictioncli.correction.settings import CorrectionSettings, EvaluationGrid, ScheduleSettings
from frictioncli.correction.uncertainty import FilterState, replay_with_filter
from frictioncli.errors import NotEnoughData, OptionError
from frictioncli.model.friction import PUBLISHED, friction_torque
from tests.correction.models import published_model, shifted, simulated
from tests.equation_16 import torques

SPEED, HIGHEST, SPREAD, NOISE, SECONDS = 60.0, 135.0, 1.5, 0.3, 1800.0
"""Speeds [deg/s], process and noise [N·m], correlation time [s]; 135/60 makes errors 1.5 times."""


ROOT = np.sqrt(SPEED)


def process(*, spread=SPREAD / ROOT, noise=NOISE / ROOT, mean=0.0, rate=0.01, length=18.0):
    """one known candidate: at a constant temperature 18 °C of a clock of 0.01 °C/s are 1800 s."""
    one = {"weight": 1.0, "rate": rate, "length": length, "mean": mean}
    one |= {"variance": spread**2, "noise": noise**2}
    return DeviationProcess(**{name: np.array([value]) for name, value in one.items()})


def ornstein_uhlenbeck(steps, seed):
    """Return a process of variance 1; ``steps`` are the distances in correlation lengths."""
    generator = np.random.default_rng(seed)
    values = [generator.standard_normal()]
    for step in steps:
        decay = np.exp(-step)
        values.append(decay * values[-1] + np.sqrt(1 - decay**2) * generator.standard_normal())
    return np.array(values)


def phase(deviation, seed, *, every=20.0, temperature=None, noise=NOISE):
    """A phase with pairs at one speed, whose friction departs from the model as told."""
    count = len(deviation)
    temperature = np.full(count, 35.0) if temperature is None else temperature
    modelled = friction_torque(PUBLISHED, load=0.0, speed=SPEED, temperature=temperature)
    white = noise * np.random.default_rng([seed, 1]).standard_normal(count)
    return PhaseData(
        time=every * np.arange(count),
        speed=np.full(count, SPEED),
        temperature=temperature,
        reading=temperature,
        friction=modelled + deviation + white,
        smoothed=modelled + deviation,
        correction_pair=np.arange(count),
    )


def at_rest(seed, count=12000, every=20.0):
    deviation = SPREAD * ornstein_uhlenbeck(np.full(count - 1, every / SECONDS), seed)
    return phase(deviation, seed, every=every)


def followed(data, bound, how=None):
    return replay_with_filter(data, PUBLISHED, how or process(), bound=bound, speed=HIGHEST)


def test_between_corrections_the_estimate_decays_and_its_variance_grows():
    """After half a correlation length: 0.2 + 0.8 e^-0.5, and 0.5 e^-1 + 4 (1 - e^-1)."""
    how = process(spread=2.0, mean=0.2, length=3.0)
    state = FilterState(clock=np.array([7.0]), estimate=np.array([1.0]), variance=np.array([0.5]))
    mean, variance = state.predict(np.array([[7.0], [8.5], [1e6]]), how)
    np.testing.assert_allclose(mean[:, 0], [1.0, 0.685225, 0.2], atol=1e-6)
    np.testing.assert_allclose(variance[:, 0], [0.5, 2.712422, 4.0], atol=1e-6)


def test_an_update_moves_the_estimate_by_the_gain():
    """Variance 4 against noise 1: a gain of four fifths, and a variance of 0.8."""
    how = process(spread=2.0, noise=1.0)
    start = FilterState(
        clock=np.zeros(1), estimate=how.mean, variance=how.variance, is_initial=True
    )
    after = start.update(5.0, np.zeros(1), how)
    assert (after.estimate[0], after.variance[0]) == (pytest.approx(4.0), pytest.approx(0.8))
    assert not after.is_initial


def test_before_the_first_correction_nothing_is_corrected_and_the_mean_is_error():
    how = process(spread=2.0, mean=3.0)
    start = FilterState(
        clock=np.zeros(1), estimate=how.mean, variance=how.variance, is_initial=True
    )
    deviation, error = start.predicted_error(np.array([[0.0], [50.0]]), how)
    np.testing.assert_allclose(deviation, 0.0)
    np.testing.assert_allclose(error, 13.0)


def test_candidate_processes_are_weighted():
    both = DeviationProcess(
        weight=np.array([0.25, 0.75]),
        rate=np.array([0.0, 0.0]),
        length=np.array([1.0, 2.0]),
        mean=np.zeros(2),
        variance=np.array([1.0, 4.0]),
        noise=np.zeros(2),
    )
    state = FilterState(clock=np.zeros(2), estimate=np.array([1.0, 2.0]), variance=np.zeros(2))
    deviation, error = state.predicted_error(np.ones((1, 2)), both)
    assert deviation[0] == pytest.approx(0.25 * np.exp(-1) + 0.75 * 2 * np.exp(-0.5))
    assert error[0] == pytest.approx(0.25 * (1 - np.exp(-2)) + 0.75 * 4 * (1 - np.exp(-1)))


def error_when_due(data, result):
    """RMS error of friction at the highest speed in the last pair before each correction."""
    before = np.flatnonzero(result.corrected)[1:] - 1
    in_force = friction_torque(
        PUBLISHED, load=0.0, speed=SPEED, temperature=data.temperature + result.correction
    )
    missed = (data.smoothed - in_force)[before] * np.sqrt(HIGHEST / SPEED)
    return float(np.sqrt(np.mean(np.square(missed)))), len(before)


@pytest.mark.parametrize("bound", [0.9, 1.3, 1.8])
def test_the_error_when_a_correction_is_due_is_the_bound(bound):
    data = at_rest(3, count=60000)
    found, events = error_when_due(data, followed(data, bound))
    assert events > 300
    assert found == pytest.approx(bound, rel=0.1)


@pytest.mark.parametrize("bound", [0.9, 1.4])
def test_so_it_is_with_an_estimated_process(bound):
    data = at_rest(5, count=1500)
    learned = fit_deviation_process(correction_pairs_of([(0, data)], PUBLISHED))
    assert learned.weight.sum() == pytest.approx(1.0)
    assert learned.weight @ learned.noise == pytest.approx(NOISE**2 / SPEED, rel=0.3)
    new = at_rest(6, count=60000)
    found, events = error_when_due(new, followed(new, bound, learned))
    assert events > 200
    assert found == pytest.approx(bound, rel=0.2)


def test_the_clock_runs_with_temperature_where_friction_departs_with_it():
    """Deviations that come while the motor warms, and others that come at rest."""
    rests = np.tile(np.r_[np.full(20, 0.0), np.full(20, 1.0)], 6)[:-1]
    temperature = 30.0 + np.abs(np.cumsum(np.r_[0.0, rests]) % 80 - 40)
    warming = phase(SPREAD * ornstein_uhlenbeck(rests / 15, 1), 1, temperature=temperature)
    resting = phase(SPREAD * ornstein_uhlenbeck(np.full(239, 0.05), 2), 2, temperature=temperature)
    with_motion, with_time = (
        fit_deviation_process(correction_pairs_of([(0, data)], PUBLISHED))
        for data in (warming, resting)
    )
    slow, fast = min(with_motion.rate), max(with_time.rate)
    assert with_motion.weight[with_motion.rate == slow].sum() > 0.5
    assert with_time.weight[with_time.rate == fast].sum() > 0.5
    assert slow < fast / 50


def test_a_correction_without_noise_gives_the_measured_friction():
    data = at_rest(1, count=200)
    result = followed(data, 0.5, process(noise=1e-9))
    at = result.corrected
    assert at.sum() > 5
    np.testing.assert_allclose(result.predicted[at], data.friction[at], atol=1e-6)


@given(seed=st.integers(0, 10**6), bounds=st.tuples(st.floats(0.2, 4), st.floats(0.2, 4)))
@settings(max_examples=30)
def test_a_smaller_bound_makes_no_fewer_corrections(seed, bounds):
    data = at_rest(seed, count=400)
    small, large = (int(followed(data, bound).corrected.sum()) for bound in sorted(bounds))
    assert small >= large


def test_no_pair_is_used_twice_whatever_the_bound():
    data = at_rest(2, count=90)
    nearest = np.repeat(np.arange(1, 90, 3), 3)
    shared = PhaseData(
        **{name: getattr(data, name) for name in PhaseData.__dataclass_fields__}
        | {"correction_pair": nearest}
    )
    used = nearest[followed(shared, 1e-3).corrected]
    assert list(used) == list(range(1, 90, 3))


def test_friction_below_all_temperatures_fails_and_the_next_pair_is_tried():
    data = at_rest(4, count=60)
    data.friction[:5] -= 500.0
    result = followed(data, 0.5)
    assert result.failed[:5].all()
    assert result.corrected[:6].all()
    assert not result.failed[5:].any()
    np.testing.assert_allclose(result.correction[:5], 0.0)


def test_a_joint_that_obeys_its_model_needs_hardly_any_correction():
    table = torques(1, point=0.3, pair=0.3, drift=0.0)
    rows = simulated(table, criterion="uncertainty")
    assert rows["corrected"].sum() <= 1
    free = simulated(shifted(0.0), criterion="uncertainty", bound=0.01)
    assert free["corrected"].sum() == 0


def test_an_offset_of_the_sensor_is_corrected_at_once():
    """7 °C are 3 to 10 N·m at 67.5 deg/s; one correction takes most of them away."""
    rows = simulated(shifted(7.0), criterion="uncertainty")
    never = simulated(shifted(7.0), criterion="none")
    misses = [
        np.sqrt(np.mean((each["friction_torque"] - each["friction_predicted"]) ** 2))
        for each in (rows, never)
    ]
    assert rows.groupby("phase")["corrected"].first().all()
    assert misses[0] < 0.5 * misses[1]


def test_the_schedule_says_the_bound_and_neither_k_nor_tmax():
    rows = simulated(torques(2), criterion="uncertainty", bound=1.5)
    assert rows[["k", "tmax"]].isna().all(axis=None)
    assert (rows["bound"] == 1.5).all()
    assert simulated(torques(2))["bound"].isna().all()
    assert "bound = 1.5 A" in ScheduleSettings(criterion="uncertainty", bound=1.5).describe("A")


def test_evaluation_has_bounds_beside_as_many_equally_spaced():
    grid = EvaluationGrid(k=(5.0,), tmax=(1800.0,), bound=(1.0, 3.0))
    found, notes = evaluate(torques(2), published_model(), CorrectionSettings(), grid)
    assert not notes
    bounded = found[found["bound"].notna()].set_index(["phase", "bound"])
    sure = bounded[bounded["criterion"] == "uncertainty"]
    equal = bounded[bounded["criterion"] == "equal"]
    assert len(sure) == 4
    assert sure["corrections"].equals(equal["corrections"])
    rows = simulated(torques(2), criterion="uncertainty", bound=1.0)
    for name, part in rows.groupby("phase"):
        assert sure.loc[(name, 1.0), "corrections"] == part["corrected"].sum()
        error = part["friction_predicted"] - part["friction_smoothed"]
        assert sure.loc[(name, 1.0), "epsilon"] == pytest.approx(np.sqrt(np.mean(error**2)))


def few(table):
    """Leave three pairs per phase at 67.5 deg/s, where corrections are made."""
    pairs = table[table["speed"] == 67.5]
    kept = pairs.groupby("phase")["pair"].unique().map(lambda pairs: pairs[:3])
    return table[(table["speed"] != 67.5) | table["pair"].isin(np.concatenate(list(kept)))]


def test_too_few_pairs_are_named_by_simulate_and_skipped_by_evaluate():
    table = few(torques(2))
    settings = CorrectionSettings(correction_speed=67.5)
    with pytest.raises(NotEnoughData, match=f"needs {LEAST_PAIRS} pairs.* found 6"):
        simulated(table, criterion="uncertainty")
    found, notes = evaluate(table, published_model(), settings, EvaluationGrid())
    assert "uncertainty" not in set(found["criterion"])
    assert found["bound"].isna().all()
    assert len(notes) == 1
    assert "left out: joint 2: criterion uncertainty needs" in notes[0]


def test_a_model_without_temperature_is_named():
    with pytest.raises(NotEnoughData, match="no dependence of friction on temperature"):
        simulated(torques(0), published_model(gamma=0.0, delta=0.0), criterion="uncertainty")


def test_the_least_number_of_pairs_suffices():
    count = LEAST_PAIRS
    pairs = CorrectionPairs(
        run=np.zeros(count, dtype=np.intp),
        time=np.arange(count) * 60.0,
        travel=np.zeros(count),
        deviation=np.random.default_rng(0).standard_normal(count),
    )
    assert np.isfinite(fit_deviation_process(pairs).variance).all()


@pytest.mark.parametrize("bound", [0.0, -1.0, float("nan")])
def test_senseless_bounds_are_refused(bound):
    with pytest.raises(OptionError, match="--bound"):
        ScheduleSettings(criterion="uncertainty", bound=bound)
    with pytest.raises(OptionError, match="--bound"):
        EvaluationGrid(bound=(bound,))
