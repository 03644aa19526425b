"""A joint's spans in sections of which no two hold partners, so that each is matched alone."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from frictioncli.motion.pages import Columns, Pages

MOST_SPANS = 4096
"""A run and joint with more is parted at the longest pause of the later half of so many. [spans]

A joint that never rests for longer than partners may be apart loses a pair there at most.
"""


@dataclass(frozen=True, slots=True)
class Section:
    """Spans, and their visits to angle bins; ``span`` counts in the section."""

    spans: Columns
    visits: Columns


def sections(pages: Pages[tuple[str, int]], joint: tuple[str, int]) -> Iterator[Section]:
    """Yield the spans of a run and joint in order, with their visits.

    Parameters
    ----------
    pages : Pages
        Pages of ``spans`` and ``visits``, as :class:`frictioncli.motion.spans.Spans` has them.
    joint : tuple of str and int
        Run and joint.
    """
    held: Section | None = None
    before = 0
    for spans, visits in pages.of(joint, "spans", "visits"):
        page = Section(spans, visits | {"span": visits["span"] - before})
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


def _parted(section: Section, seam: int) -> tuple[Section, Section]:
    cut = int(np.searchsorted(section.visits["span"], seam))
    parts = []
    for rows, own, number in (
        (slice(seam), slice(cut), 0),
        (slice(seam, None), slice(cut, None), seam),
    ):
        visits = {name: values[own] for name, values in section.visits.items()}
        visits["span"] = visits["span"] - number
        parts.append(Section({name: of[rows] for name, of in section.spans.items()}, visits))
    return parts[0], parts[1]


def _joined(one: Section, other: Section) -> Section:
    spans, visits = (
        {name: np.concatenate([first[name], second[name]]) for name in first}
        for first, second in ((one.spans, other.spans), (one.visits, other.visits))
    )
    return Section(spans, visits)
