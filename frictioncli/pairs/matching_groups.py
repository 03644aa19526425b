"""Groups of a joint's segments of which no two hold partners, so that each is matched alone."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from frictioncli.pairs.partitioned_store import Columns, PartitionedStore

MOST_SEGMENTS = 4096
"""A run and joint with more segments is split at the longest pause within the later half of them.

A joint that never rests for longer than the longest pause between partners may lose a pair there.
"""


@dataclass(frozen=True, slots=True)
class MatchingGroup:
    """Segments and their bins; ``bins["segment"]`` counts within the group."""

    segments: Columns
    bins: Columns


def matching_groups(
    store: PartitionedStore[tuple[str, int]], joint: tuple[str, int]
) -> Iterator[MatchingGroup]:
    """Yield the segments of a run and joint in time order, with their bins, group by group.

    Parameters
    ----------
    store : PartitionedStore
        Tables ``segments`` and ``bins`` of :class:`frictioncli.pairs.segments.SegmentTables`.
    joint : tuple of str and int
        Run and joint.

    Yields
    ------
    MatchingGroup
        Segments that may be partners of each other.
    """
    waiting: MatchingGroup | None = None
    before = 0
    for segments, bins in store.read(joint, "segments", "bins"):
        read = MatchingGroup(segments, bins | {"segment": bins["segment"] - before})
        waiting = read if waiting is None else _joined(waiting, read)
        while len(waiting.segments["start"]) > MOST_SEGMENTS:
            group, waiting = _split(waiting, _longest_pause(waiting.segments))
            before += len(group.segments["start"])
            yield group
    if waiting is not None:
        yield waiting


def _longest_pause(segments: Columns) -> int:
    """Return the first segment behind the longest pause."""
    earliest = MOST_SEGMENTS // 2 + 1
    stop = np.maximum.accumulate(segments["stop"][:MOST_SEGMENTS])[earliest - 1 :]
    return earliest + int(np.argmax(segments["start"][earliest : MOST_SEGMENTS + 1] - stop))


def _split(group: MatchingGroup, segment: int) -> tuple[MatchingGroup, MatchingGroup]:
    """Return the group before a segment, and from it on."""
    row = int(np.searchsorted(group.bins["segment"], segment))
    halves = []
    for segment_rows, bin_rows, first in (
        (slice(segment), slice(row), 0),
        (slice(segment, None), slice(row, None), segment),
    ):
        segments = {name: values[segment_rows] for name, values in group.segments.items()}
        bins = {name: values[bin_rows] for name, values in group.bins.items()}
        bins["segment"] = bins["segment"] - first
        halves.append(MatchingGroup(segments, bins))
    return halves[0], halves[1]


def _joined(one: MatchingGroup, other: MatchingGroup) -> MatchingGroup:
    segments, bins = (
        {name: np.concatenate([first[name], second[name]]) for name in first}
        for first, second in ((one.segments, other.segments), (one.bins, other.bins))
    )
    return MatchingGroup(segments, bins)
