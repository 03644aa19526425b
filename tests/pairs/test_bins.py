"""Bin means of many segments at once are those of each segment alone."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from frictioncli.pairs.bins import bin_means, slopes


def alone(position, torque, width):
    """One segment, bin by bin, in plain steps; the slope is numpy's."""
    numbers = sorted({int(np.floor(q / width)) for q in position})
    means, places, counts = [], [], []
    for number in numbers:
        inside = np.floor(position / width) == number
        counts.append(inside.sum())
        means.append(torque[inside].mean())
        places.append(position[inside].mean())
    if len(numbers) > 1:
        steep = np.gradient(means, places)
        means = means + steep * ((np.array(numbers) + 0.5) * width - places)
    return numbers, counts, means


@settings(max_examples=60)
@given(
    seed=st.integers(0, 10**6),
    noise=st.sampled_from([0.0, 0.02, 2.0]),
    unknown=st.sampled_from([0.0, 0.02, 0.5, 1.0]),
)
def test_many_segments_at_once_are_as_each_alone(seed, noise, unknown):
    """Segments either way, with gaps, angles that waver over bin edges, loads partly unknown."""
    generator = np.random.default_rng(seed)
    lengths = generator.integers(2, 60, 7)
    gaps = generator.integers(0, 4, 7)
    start = np.cumsum(lengths + gaps) - lengths
    n = int(start[-1] + lengths[-1] + generator.integers(0, 3))
    position = generator.uniform(-180, 180, n)
    for begin, length in zip(start, lengths, strict=True):
        way = generator.choice([-1, 1]) * generator.uniform(0.1, 4) * np.arange(length)
        position[begin : begin + length] = generator.uniform(-90, 90) + way
    position += generator.normal(0, noise, n) if noise else 0.0
    torque, load, time = generator.normal(size=(3, n))
    load[generator.uniform(size=n) < unknown] = np.nan
    stop = start + lengths
    found = bin_means(
        position=position, torque=torque, load=load, time=time, start=start, stop=stop, width=5.0
    )
    for segment, own in enumerate(map(slice, start, stop)):
        here = found.segment == segment
        for values, name in ((torque, "torque"), (load, "load")):
            numbers, counts, means = alone(position[own], values[own], 5.0)
            assert found.bin[here].tolist() == numbers
            assert found.n[here].tolist() == counts
            np.testing.assert_allclose(getattr(found, name)[here], means, rtol=1e-6, atol=1e-9)
        order = np.floor(position[own] / 5.0).astype(int)
        expected = [time[own][order == number].mean() for number in numbers]
        np.testing.assert_allclose(found.time[here], expected, rtol=1e-9, atol=1e-12)


def test_partly_crossed_bins_are_carried_to_their_centre():
    """Torque grows by 2 N·m/deg; the last bin holds samples only up to 12 of 15 deg."""
    position = np.arange(0.0, 12.0, 0.05)
    means = bin_means(
        position=position,
        torque=2 * position,
        load=np.full_like(position, np.nan),
        time=position,
        start=np.array([0]),
        stop=np.array([len(position)]),
        width=5.0,
    )
    np.testing.assert_allclose(means.torque, 2 * np.array([2.5, 7.5, 12.5]), atol=1e-9)
    assert np.isnan(means.load).all()


def test_no_segments_have_no_means():
    none = np.empty(0)
    empty = np.empty(0, np.int64)
    means = bin_means(
        position=none, torque=none, load=none, time=none, start=empty, stop=empty, width=5.0
    )
    assert len(means.bin) == 0


@pytest.mark.parametrize("points", [1, 2, 3, 9])
def test_slopes_are_those_of_numpy(points):
    generator = np.random.default_rng(points)
    place = np.cumsum(generator.uniform(0.5, 5, (4, points)), axis=1)
    place[1] += place[0, -1] - place[1, 0]  # one curve begins where the one before ends
    values = generator.normal(size=(4, points))
    found = slopes(np.repeat(np.arange(4), points), place.ravel(), values.ravel())
    expected = [
        np.gradient(v, p) if points > 1 else np.zeros(1) for v, p in zip(values, place, strict=True)
    ]
    np.testing.assert_allclose(found, np.concatenate(expected), atol=1e-12)
