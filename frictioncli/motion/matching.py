"""Which angle-bin visits of counter-directed spans belong together; arrays only."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from frictioncli.motion.settings import PairingSettings

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]


@dataclass(frozen=True, slots=True, kw_only=True)
class SpanArrays:
    """Spans, and their visits to angle bins: those of a span stand together, in span order.

    Attributes
    ----------
    direction : ndarray of int, shape (spans,)
        +1 or -1.
    start, stop, temperature : ndarray, shape (spans,)
        Times and motor temperature, NaN where unknown. [s], [°C]
    visit_span, visit_bin : ndarray of int, shape (visits,)
        Span and bin of each visit.
    visit_time : ndarray, shape (visits,)
        Time of each visit. [s]
    """

    direction: Numbers
    start: Array
    stop: Array
    temperature: Array
    visit_span: Numbers
    visit_bin: Numbers
    visit_time: Array

    def visits_of(self, span: int) -> Numbers:
        """Return the numbers of a span's visits."""
        first, last = np.searchsorted(self.visit_span, [span, span + 1])
        return np.arange(first, last)


@dataclass(frozen=True, slots=True)
class Matches:
    """Couples of spans (forward, reverse), and each visit's couple, -1 where it has none."""

    couples: list[tuple[int, int]]
    visit_couple: Numbers


def speed_levels(speed: Array, same: float) -> Numbers:
    """Return the number of the speed level of each span; a level spans at most ``2 * same``.

    Parameters
    ----------
    speed : ndarray, shape (spans,)
        Speeds. [deg/s]
    same : float
        Greatest difference between neighbours of a level, as a share.
    """
    level = np.zeros(len(speed), dtype=np.int64)
    number, floor, last = -1, -np.inf, -np.inf
    for index in np.argsort(speed, kind="stable"):
        if speed[index] > last * (1 + same) or speed[index] > floor * (1 + 2 * same):
            number, floor = number + 1, speed[index]
        level[index], last = number, speed[index]
    return level


def match_visits(arrays: SpanArrays, groups: list[Numbers], settings: PairingSettings) -> Matches:
    """Match the visits of counter-directed spans within groups of the same joint and speed.

    Neighbours in time are matched first, as whole spans; what is left over in the bins that they do
    not share is then matched bin by bin, so that moves between random angles find partners too.

    Parameters
    ----------
    arrays : SpanArrays
        All spans.
    groups : list of ndarray of int
        Spans that may pair with each other, in time order.
    settings : PairingSettings
        What makes a pair.
    """
    couples: list[tuple[int, int]] = []
    visit_couple = np.full(len(arrays.visit_span), -1, dtype=np.int64)
    for group in groups:
        for forward, reverse in _neighbours(arrays, group, settings):
            ahead, back = _shared(arrays, forward, reverse)
            visit_couple[ahead] = visit_couple[back] = len(couples)
            couples.append((forward, reverse))
        numbers: dict[tuple[int, int], int] = {}
        for one, other in _leftovers(arrays, group, visit_couple):
            couple = int(arrays.visit_span[one]), int(arrays.visit_span[other])
            if visit_couple[one] >= 0 or visit_couple[other] >= 0:
                continue
            if not _agree(arrays, *couple, settings):
                continue
            if couple not in numbers:
                numbers[couple] = len(couples)
                couples.append(couple)
            visit_couple[one] = visit_couple[other] = numbers[couple]
    return Matches(couples, visit_couple)


def _agree(arrays: SpanArrays, one: int, other: int, settings: PairingSettings) -> bool:
    first, second = (one, other) if arrays.start[one] <= arrays.start[other] else (other, one)
    pause = arrays.start[second] - arrays.stop[first]
    warmer = abs(arrays.temperature[one] - arrays.temperature[other])
    # without temperatures the difference is NaN and cannot forbid a pair
    return bool(pause <= settings.longest_pause and not warmer > settings.same_temperature)


def _shared(arrays: SpanArrays, one: int, other: int) -> tuple[Numbers, Numbers]:
    """Return the visits of two spans to the bins that both have crossed."""
    ahead, back = arrays.visits_of(one), arrays.visits_of(other)
    _, i, j = np.intersect1d(
        arrays.visit_bin[ahead], arrays.visit_bin[back], assume_unique=True, return_indices=True
    )
    return ahead[i], back[j]


def _neighbours(
    arrays: SpanArrays, group: Numbers, settings: PairingSettings
) -> list[tuple[int, int]]:
    """Return (forward, reverse) spans: neighbours in time, then neighbours among what is left."""
    found = []
    waiting = [int(span) for span in group]
    while True:
        taken: set[int] = set()
        for one, other in pairwise(waiting):
            if one in taken or arrays.direction[one] == arrays.direction[other]:
                continue
            if _agree(arrays, one, other, settings) and _shared(arrays, one, other)[0].size:
                taken |= {one, other}
                found.append((one, other) if arrays.direction[one] > 0 else (other, one))
        if not taken:
            return found
        waiting = [span for span in waiting if span not in taken]


def _leftovers(
    arrays: SpanArrays, group: Numbers, visit_couple: Numbers
) -> Iterator[tuple[int, int]]:
    """Yield (forward, reverse) visits to one bin that are still free, nearest in time first."""
    visits = np.concatenate([arrays.visits_of(int(span)) for span in group])
    free = visits[visit_couple[visits] < 0]
    ahead = arrays.direction[arrays.visit_span[free]] > 0
    both = np.intersect1d(arrays.visit_bin[free[ahead]], arrays.visit_bin[free[~ahead]])
    for number in both:
        here = arrays.visit_bin[free] == number
        forward, reverse = free[here & ahead], free[here & ~ahead]
        apart = np.abs(arrays.visit_time[forward][:, None] - arrays.visit_time[reverse][None, :])
        for flat in np.argsort(apart, axis=None, kind="stable"):
            i, j = divmod(int(flat), len(reverse))
            yield int(forward[i]), int(reverse[j])
