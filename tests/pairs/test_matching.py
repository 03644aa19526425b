"""Matching, against plain loops that take the same decisions one by one."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from frictioncli.pairs.matching import SegmentArrays, match_bins
from frictioncli.pairs.settings import PairingSettings
from frictioncli.pairs.speed_levels import SpeedCounts, speed_levels

SETTINGS = PairingSettings(longest_pause=30.0, same_temperature=2.0)


def plain(arrays, settings):
    """The matches of one group, segment by segment and bin by bin."""

    def agree(one, other):
        first, second = sorted((one, other), key=lambda segment: arrays.start[segment])
        pause = arrays.start[second] - arrays.stop[first]
        warmer = abs(arrays.temperature[one] - arrays.temperature[other])
        return pause <= settings.longest_pause and not warmer > settings.same_temperature

    rows = {
        segment: {
            int(b): v for v, b in enumerate(arrays.bin_number) if arrays.bin_segment[v] == segment
        }
        for segment in range(len(arrays.start))
    }
    partner = {}
    waiting = list(range(len(arrays.start)))
    while True:
        taken = set()
        for one, other in pairwise(waiting):
            if one in taken or arrays.direction[one] == arrays.direction[other]:
                continue
            shared = rows[one].keys() & rows[other].keys()
            if agree(one, other) and shared:
                taken |= {one, other}
                for number in shared:
                    a, b = rows[one][number], rows[other][number]
                    partner[a], partner[b] = b, a
        if not taken:
            break
        waiting = [segment for segment in waiting if segment not in taken]
    edges = []
    for a in range(len(arrays.bin_number)):
        for b in range(len(arrays.bin_number)):
            one, other = int(arrays.bin_segment[a]), int(arrays.bin_segment[b])
            counter = arrays.direction[one] > 0 > arrays.direction[other]
            if counter and arrays.bin_number[a] == arrays.bin_number[b] and agree(one, other):
                edges.append((abs(arrays.bin_time[a] - arrays.bin_time[b]), a, b))
    for _, a, b in sorted(edges):
        if a not in partner and b not in partner:
            partner[a], partner[b] = b, a
    return partner


@settings(max_examples=80)
@given(seed=st.integers(0, 10**6), count=st.integers(1, 25))
def test_matches_are_those_of_plain_loops(seed, count):
    generator = np.random.default_rng(seed)
    start = np.cumsum(generator.uniform(1, 12, count))
    lengths = generator.integers(0, 5, count)
    bins = [np.sort(generator.choice(7, n, replace=False)) for n in lengths]
    segment = np.repeat(np.arange(count), lengths)
    arrays = SegmentArrays(
        direction=generator.choice([-1, 1], count),
        start=start,
        stop=start + 1.0,
        temperature=generator.choice([20.0, 21.5, 23.0, np.nan], count),
        bin_segment=segment,
        bin_number=np.concatenate(bins).astype(np.int64),
        bin_time=start[segment] + generator.uniform(0, 1, len(segment)),
    )
    found = match_bins(arrays, [np.arange(count)], SETTINGS)
    partner = {}
    for couple in range(len(found.forward)):
        own = np.flatnonzero(found.bin_match == couple)
        for number in np.unique(arrays.bin_number[own]):
            a, b = own[arrays.bin_number[own] == number]
            partner[int(a)], partner[int(b)] = int(b), int(a)
            assert {arrays.bin_segment[a], arrays.bin_segment[b]} == {
                found.forward[couple],
                found.reverse[couple],
            }
    assert partner == plain(arrays, SETTINGS)
    assert (arrays.direction[found.forward] == 1).all()
    assert (arrays.direction[found.reverse] == -1).all()


def test_speed_levels_part_where_speeds_do():
    speed = np.array([40.0, 40.5, 41.0, 20.0, 20.1, 43.0, 100.0])
    # 43 is 4.9 % above 41; 41 is within 6 % of 40
    assert speed_levels(speed, 0.03).tolist() == [1, 1, 1, 0, 0, 2, 3]


@given(parts=st.lists(st.lists(st.floats(0.2, 5000), min_size=1, max_size=20), min_size=1))
def test_counts_of_speeds_know_their_median(parts):
    counts = SpeedCounts()
    for part in parts:
        counts.add(np.array(part))
    everything = np.concatenate(parts)
    assert counts.total == len(everything)
    assert counts.median == pytest.approx(np.median(everything), rel=1e-4)
    assert len(counts.speeds) <= len(everything)


def test_counts_of_speeds_do_not_grow_with_the_log():
    counts = SpeedCounts()
    generator = np.random.default_rng(0)
    for _ in range(20):
        counts.add(generator.uniform(40, 41, 10_000))
    assert counts.total == 200_000
    assert len(counts.steps) <= 250
