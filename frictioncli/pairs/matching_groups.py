"""A joint's spans in sections of which no two hold partners, so that each is matched alone."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from frictioncli.pairs.partitioned_store import Columns, PartitionedStore

MOST_SPANS = 4096
"""A run and joint with more is parted at the longest pause of the later half of so many. [spans]

A joint that never rests for longer than partners may be apart loses a pair there at most.
"""


@dataclass(frozen=True, slots=True)
class MatchingGroup:
    """Spans, and their visits to angle bins; ``span`` counts in the section."""

    spans: Columns
    visits: Columns


def matching_groups(
    pages: PartitionedStore[tuple[str, int]], joint: tuple[str, int]
) -> Iterator[MatchingGroup]:
    """Yield the spans of a run and joint in order, with their visits.

    Parameters
    ----------
    pages : PartitionedStore
        Pages of ``spans`` and ``visits``, as :class:`frictioncli.pairs.segments.Spans` has them.
    joint : tuple of str and int
        Run and joint.
    """
    held: MatchingGroup | None = None
    before = 0
    for spans, visits in pages.of(joint, "spans", "visits"):
        page = MatchingGroup(spans, visits | {"span": visits["span"] - before})
        held = page if held is None else _joined(held, page)
        while len(held.spans["start"]) > MOST_SPANS:
            section, held = _parted(held, _seam(held.spans))
            before += len(section.spans["start"])
            yield section
    if held is not None:
        yield held


def _seam(spans: Columns) -> int:
    """Return the first span behind the longest pause."""
    earliest = MOST_SPANS // 2 + 1
    stop = np.maximum.accumulate(spans["stop"][:MOST_SPANS])[earliest - 1 :]
    return earliest + int(np.argmax(spans["start"][earliest : MOST_SPANS + 1] - stop))


def _parted(section: MatchingGroup, seam: int) -> tuple[MatchingGroup, MatchingGroup]:
    cut = int(np.searchsorted(section.visits["span"], seam))
    parts = []
    for rows, own, number in (
        (slice(seam), slice(cut), 0),
        (slice(seam, None), slice(cut, None), seam),
    ):
        visits = {name: values[own] for name, values in section.visits.items()}
        visits["span"] = visits["span"] - number
        parts.append(MatchingGroup({name: of[rows] for name, of in section.spans.items()}, visits))
    return parts[0], parts[1]


def _joined(one: MatchingGroup, other: MatchingGroup) -> MatchingGroup:
    spans, visits = (
        {name: np.concatenate([first[name], second[name]]) for name in first}
        for first, second in ((one.spans, other.spans), (one.visits, other.visits))
    )
    return MatchingGroup(spans, visits)
