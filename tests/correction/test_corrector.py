"""The corrector of a robot at work does, pair by pair, what the search over a whole log does."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from frictioncli.correction.corrector import TemperatureCorrector
from frictioncli.correction.replay import PhaseData, replay, replay_online
from frictioncli.correction.schedule import first_degree, latest_degree
from frictioncli.model.friction import PUBLISHED, friction_torque

SEARCH = {"first_degree": first_degree, "latest_degree": latest_degree}
SPEEDS = np.array([19.1, 67.5, 101.2])


def phase(seed, *, length, rounded, failing, still):
    """Pairs at irregular times whose friction departs from the model, in part beyond any T."""
    generator = np.random.default_rng(seed)
    time = np.cumsum(generator.choice([0.012, 10.0, 60.0, 300.0], length))
    if still:  # several pairs at one moment
        time = np.repeat(time, 2)[:length]
    temperature = 30 + np.cumsum(generator.normal(0.1, 0.5, length))
    speed = generator.choice(SPEEDS, length)
    off = 5 + np.cumsum(generator.normal(0, 0.3, length))
    friction = friction_torque(PUBLISHED, load=0.0, speed=speed, temperature=temperature + off)
    friction[generator.random(length) < failing] -= 300.0
    return PhaseData(
        time=time,
        speed=speed,
        temperature=temperature,
        reading=np.round(temperature) if rounded else temperature,
        friction=friction,
        smoothed=friction,
        correction_pair=np.clip(
            np.arange(length) + generator.integers(-2, 3, length), 0, length - 1
        ),
    )


@settings(max_examples=150)
@given(
    seed=st.integers(0, 10**6),
    length=st.integers(1, 200),
    rounded=st.booleans(),
    still=st.booleans(),
    failing=st.sampled_from([0.0, 0.2, 1.0]),
    k=st.sampled_from([0.3, 1.0, 2.0, 5.0, 20.0]),
    tmax=st.sampled_from([60.0, 600.0, 3600.0]),
    reading=st.sampled_from(sorted(SEARCH)),
)
def test_it_corrects_when_the_search_over_the_whole_log_does(
    seed, length, rounded, still, failing, k, tmax, reading
):
    """Same events and failures; corrections and friction but for the last digit of exp and log."""
    data = phase(seed, length=length, rounded=rounded, failing=failing, still=still)
    (events,) = SEARCH[reading](data.time, data.reading, k=[k], tmax=[tmax])
    batch = replay(data, PUBLISHED, events)
    corrector = TemperatureCorrector(PUBLISHED, k=k, tmax=tmax, reading=reading)
    online = replay_online(data, corrector)
    assert np.flatnonzero(online.corrected).tolist() == events.tolist()
    assert online.failed.tolist() == batch.failed.tolist()
    np.testing.assert_allclose(online.correction, batch.correction, rtol=0, atol=1e-11)
    np.testing.assert_allclose(online.predicted, batch.predicted, rtol=1e-13)
    last = corrector.friction(load=0.0, speed=float(data.speed[-1]))
    assert last == pytest.approx(online.predicted[-1], rel=1e-13)


def test_given_instants_take_the_place_of_the_criterion():
    data = phase(1, length=50, rounded=True, failing=0.0, still=False)
    given = replay_online(data, TemperatureCorrector(PUBLISHED), [3, 30])
    assert np.flatnonzero(given.corrected).tolist() == [3, 30]
    np.testing.assert_array_equal(given.correction[:3], 0.0)
    batch = replay(data, PUBLISHED, [3, 30])
    np.testing.assert_allclose(given.correction, batch.correction, rtol=0, atol=1e-11)


def test_a_day_by_hand():
    """1 °C a minute; first degree at 60 s, so k = 5 is due at the first sample after 300 s."""
    corrector = TemperatureCorrector(PUBLISHED, k=5, tmax=3600)
    assert not corrector.is_due
    due = []
    for minute in range(14):
        corrector.update(60.0 * minute, 30.0 + minute)
        if corrector.is_due:
            due.append(minute)
            warm = corrector.motor_temperature + minute
            friction = friction_torque(PUBLISHED, load=20.0, speed=67.5, temperature=warm)
            assert corrector.correct(float(friction), load=20.0, speed=67.5)
            assert corrector.correction == pytest.approx(minute, abs=1e-9)
    assert due == [0, 6, 12]
    expected = 10.57 + 0.0014 * 30**2 + (3.48 + 15.66 * math.exp(-0.056 * 55)) * 10
    assert corrector.friction(load=30.0, speed=100.0) == pytest.approx(expected)


def test_a_correction_that_comes_late_stays_due_and_counts_from_when_it_is_made():
    corrector = TemperatureCorrector(PUBLISHED, k=5, tmax=100.0)
    for time in (0.0, 150.0, 500.0):
        corrector.update(time, 40.0)
        assert corrector.is_due
    corrector.correct(60.0, load=0.0, speed=67.5)
    corrector.update(600.0, 40.0)
    assert not corrector.is_due
    corrector.update(600.1, 40.0)
    assert corrector.is_due


def test_friction_that_no_temperature_gives_keeps_the_last_correction():
    corrector = TemperatureCorrector(PUBLISHED)
    corrector.update(0.0, 30.0)
    warm = friction_torque(PUBLISHED, load=0.0, speed=67.5, temperature=33.0)
    assert corrector.correct(float(warm), load=0.0, speed=67.5)
    assert not corrector.correct(-5.0, load=0.0, speed=67.5)
    assert corrector.correction == pytest.approx(3.0)


def test_a_reading_that_it_does_not_know_is_refused():
    with pytest.raises(ValueError, match="latest_degree"):
        TemperatureCorrector(PUBLISHED, reading="uncertainty")
