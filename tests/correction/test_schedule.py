"""The event search does exactly what the plain loop of Algorithm 3 does."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from frictioncli.correction.schedule import equally_spaced, first_degree, latest_degree


def plain_loop(time, temperature, *, k, tmax, latest):
    """Algorithm 3, instant by instant, with one of the two workable readings of Delta_t."""
    events, duration = [0], None
    last = reference = 0
    for i in range(1, len(time)):
        if abs(temperature[i] - temperature[reference]) >= 1 and (latest or duration is None):
            duration = time[i] - time[reference]
            if latest:
                reference = i
        limit = tmax if duration is None else min(k * duration, tmax)
        if time[i] - time[last] > limit:
            events.append(i)
            last = reference = i
            duration = None
    return events


@settings(max_examples=300, deadline=None)
@given(
    seed=st.integers(0, 10**6),
    k=st.sampled_from([0.5, 1.0, 2.5, 5.0, 20.0]),
    tmax=st.sampled_from([50.0, 300.0, 3600.0]),
    length=st.integers(1, 400),
)
def test_events_are_those_of_the_plain_loop(seed, k, tmax, length):
    generator = np.random.default_rng(seed)
    time = np.cumsum(generator.integers(1, 60, length)).astype(float)
    temperature = np.round(30 + np.cumsum(generator.normal(0.05, 0.4, length)))
    for search, latest in ((first_degree, False), (latest_degree, True)):
        expected = plain_loop(time, temperature, k=k, tmax=tmax, latest=latest)
        assert search(time, temperature, k=k, tmax=tmax) == expected


def test_steady_heating_by_hand():
    """1 °C a minute: k = 5 waits more than 5 min, so it corrects every 6th minute."""
    time = 60.0 * np.arange(20)
    events = first_degree(time, 20.0 + np.arange(20), k=5, tmax=3600)
    assert events == [0, 6, 12, 18]


def test_constant_temperature_leaves_it_to_tmax():
    time = 60.0 * np.arange(100)
    assert first_degree(time, np.full(100, 30.0), k=1, tmax=1800) == [0, 31, 62, 93]


def test_slowing_heating_tells_the_readings_apart():
    """The latest degree lasts longer than the first, so its reading waits longer."""
    temperature = np.floor(25 + 40 * (1 - np.exp(-np.arange(300) / 60)))
    time = 60.0 * np.arange(300)
    first = first_degree(time, temperature, k=5, tmax=1e9)
    latest = latest_degree(time, temperature, k=5, tmax=1e9)
    assert len(latest) < len(first)


def test_rounding_does_not_hide_a_degree():
    """Decimals are not exact in binary: 1.4 - 0.4 is a little less than 1."""
    assert 1.4 - 0.4 < 1.0
    events = first_degree(np.array([0.0, 60.0, 400.0]), np.array([0.4, 1.4, 1.4]), k=1, tmax=1e9)
    assert events == [0, 2]


def test_equal_spacing_by_hand():
    time = 60.0 * np.arange(61)
    assert equally_spaced(time, 4) == [0, 15, 30, 45]
    assert equally_spaced(time, 1) == [0]
    assert equally_spaced(time, 0) == []


@given(count=st.integers(1, 30))
def test_equal_spacing_has_as_many_events_as_asked(count):
    assert len(equally_spaced(np.arange(1000.0), count)) == count


@pytest.mark.parametrize("search", [first_degree, latest_degree])
def test_a_single_instant_is_one_correction(search):
    assert search(np.array([5.0]), np.array([30.0]), k=5, tmax=60) == [0]
