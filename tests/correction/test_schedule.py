"""The event search does exactly what the plain loop of Algorithm 3 does."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from frictioncli.correction.degree_crossings import next_degree_changes
from frictioncli.correction.schedule import equally_spaced, first_degree, latest_degree


def plain_loop(time, temperature, *, k, tmax, latest):
    """Algorithm 3, instant by instant, with one of the two workable readings of Delta_t."""
    events, duration = [0], None
    last = reference = 0
    for i in range(1, len(time)):
        changed = abs(temperature[i] - temperature[reference]) >= 1 - 1e-9
        if changed and (latest or duration is None):
            duration = time[i] - time[reference]
            if latest:
                reference = i
        limit = tmax if duration is None else min(k * duration, tmax)
        if time[i] - time[last] > limit:
            events.append(i)
            last = reference = i
            duration = None
    return events


SCALES = np.array([0.5, 1.0, 2.5, 5.0, 20.0])
READINGS = ((first_degree, False), (latest_degree, True))


@settings(max_examples=200)
@given(
    seed=st.integers(0, 10**6),
    period=st.sampled_from([0.004, 0.012, 1.0, 60.0]),
    gaps=st.booleans(),
    rounded=st.booleans(),
    length=st.integers(1, 300),
)
def test_events_are_those_of_the_plain_loop(seed, period, gaps, rounded, length):
    """Also where waiting times are multiples of a period that is no binary number."""
    generator = np.random.default_rng(seed)
    ticks = np.cumsum(generator.integers(1, 60, length)) if gaps else np.arange(length)
    time = period * ticks
    temperature = 30 + np.cumsum(generator.normal(0.05, 0.4, length))
    temperature = np.round(temperature) if rounded else temperature
    forced = period * generator.choice([50.0, 300.0, 3600.0], len(SCALES))
    for search, latest in READINGS:
        found = search(time, temperature, k=SCALES, tmax=forced)
        for events, k, tmax in zip(found, SCALES, forced, strict=True):
            expected = plain_loop(time, temperature, k=k, tmax=tmax, latest=latest)
            assert events.tolist() == expected


@given(st.lists(st.floats(20, 26), min_size=1, max_size=200))
def test_next_change_is_the_first_departure_by_a_degree(readings):
    values = np.array(readings)
    departs = np.abs(values[np.newaxis] - values[:, np.newaxis]) >= 1 - 1e-9
    expected = [
        next((j for j in range(i + 1, len(values)) if departs[i, j]), len(values))
        for i in range(len(values))
    ]
    assert next_degree_changes(values).tolist() == expected


def one(search, time, temperature, *, k, tmax):
    """Return the events of a single schedule."""
    (events,) = search(time, temperature, k=[k], tmax=[tmax])
    return events.tolist()


def test_steady_heating_by_hand():
    """1 °C a minute: k = 5 waits more than 5 min, so it corrects every 6th minute."""
    time = 60.0 * np.arange(20)
    events = one(first_degree, time, 20.0 + np.arange(20), k=5, tmax=3600)
    assert events == [0, 6, 12, 18]


def test_constant_temperature_leaves_it_to_tmax():
    time = 60.0 * np.arange(100)
    assert one(first_degree, time, np.full(100, 30.0), k=1, tmax=1800) == [0, 31, 62, 93]


def test_slowing_heating_tells_the_readings_apart():
    """The latest degree lasts longer than the first, so its reading waits longer."""
    temperature = np.floor(25 + 40 * (1 - np.exp(-np.arange(300) / 60)))
    time = 60.0 * np.arange(300)
    first = one(first_degree, time, temperature, k=5, tmax=1e9)
    latest = one(latest_degree, time, temperature, k=5, tmax=1e9)
    assert len(latest) < len(first)


def test_rounding_does_not_hide_a_degree():
    """Decimals are not exact in binary: 1.4 - 0.4 is a little less than 1."""
    assert 1.4 - 0.4 < 1.0
    time, temperature = np.array([0.0, 60.0, 400.0]), np.array([0.4, 1.4, 1.4])
    events = one(first_degree, time, temperature, k=1, tmax=1e9)
    assert events == [0, 2]


def test_equal_spacing_by_hand():
    time = 60.0 * np.arange(61)
    assert equally_spaced(time, 4).tolist() == [0, 15, 30, 45]
    assert equally_spaced(time, 1).tolist() == [0]
    assert equally_spaced(time, 0).tolist() == []


@given(count=st.integers(1, 30))
def test_equal_spacing_has_as_many_events_as_asked(count):
    assert len(equally_spaced(np.arange(1000.0), count)) == count


@pytest.mark.parametrize("search", [first_degree, latest_degree])
def test_a_single_instant_is_one_correction(search):
    assert one(search, np.array([5.0]), np.array([30.0]), k=5, tmax=60) == [0]


@pytest.mark.parametrize("search", [first_degree, latest_degree])
def test_no_schedule_has_no_events(search):
    assert search(np.arange(3.0), np.full(3, 30.0), k=[], tmax=[]) == []
