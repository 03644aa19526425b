"""Which angle-bin visits of counter-directed spans belong together; arrays only."""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Flags, Numbers
from frictioncli.pairs.array_runs import members
from frictioncli.pairs.settings import PairingSettings


@dataclass(frozen=True, slots=True, kw_only=True)
class SegmentArrays:
    """Spans, and their visits to angle bins: those of a span stand together, in span order.

    Attributes
    ----------
    direction : ndarray of int, shape (spans,)
        +1 or -1.
    start, stop, temperature : ndarray, shape (spans,)
        Times and motor temperature, NaN where unknown. [s], [°C]
    visit_span, visit_bin : ndarray of int, shape (visits,)
        Span and bin of each visit; the bins of a span grow.
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

    def visits_of(self, spans: Numbers) -> tuple[Numbers, Numbers]:
        """Return the first and past-the-end visit of spans."""
        first, last = (np.searchsorted(self.visit_span, spans + i) for i in (0, 1))
        return first, last


@dataclass(frozen=True, slots=True)
class Matches:
    """Couples of spans, and each visit's couple, -1 where it has none."""

    forward: Numbers
    reverse: Numbers
    visit_couple: Numbers


def match_bins(arrays: SegmentArrays, groups: list[Numbers], settings: PairingSettings) -> Matches:
    """Match the visits of counter-directed spans within groups of the same joint and speed.

    Neighbours in time are matched first, as whole spans; what is left over in the bins that they do
    not share is then matched bin by bin, so that moves between random angles find partners too.

    Parameters
    ----------
    arrays : SegmentArrays
        All spans.
    groups : list of ndarray of int
        Spans that may pair with each other, in time order.
    settings : PairingSettings
        What makes a pair.
    """
    couples = np.empty((0, 2), dtype=np.int64)
    visit_couple = np.full(len(arrays.visit_span), -1, dtype=np.int64)
    for group in groups:
        found = _neighbours(arrays, group, settings)
        ahead, back, number = _shared(arrays, found[:, 0], found[:, 1])
        visit_couple[ahead] = visit_couple[back] = len(couples) + number
        couples = np.concatenate([couples, found])
        forward, reverse = _leftovers(arrays, group, visit_couple, settings)
        spans = np.column_stack([arrays.visit_span[forward], arrays.visit_span[reverse]])
        found, number = np.unique(spans, axis=0, return_inverse=True)
        visit_couple[forward] = visit_couple[reverse] = len(couples) + number.ravel()
        couples = np.concatenate([couples, found])
    return Matches(couples[:, 0], couples[:, 1], visit_couple)


def _agree(arrays: SegmentArrays, one: Numbers, other: Numbers, settings: PairingSettings) -> Flags:
    ordered = arrays.start[one] <= arrays.start[other]
    first, second = np.where(ordered, one, other), np.where(ordered, other, one)
    pause = arrays.start[second] - arrays.stop[first]
    warmer = np.abs(arrays.temperature[one] - arrays.temperature[other])
    # without temperatures the difference is NaN and cannot forbid a pair
    return (pause <= settings.longest_pause) & ~(warmer > settings.same_temperature)


def _shared(
    arrays: SegmentArrays, one: Numbers, other: Numbers
) -> tuple[Numbers, Numbers, Numbers]:
    """Return the visits of couples of spans to the bins that both crossed, and their couple."""
    ahead, back = arrays.visits_of(one), arrays.visits_of(other)
    low = arrays.visit_bin.min(initial=0)
    many = arrays.visit_bin.max(initial=0) - low + 1
    visits, keys = [], []
    for first, last in (ahead, back):
        visit = members(first, last)
        couple = np.repeat(np.arange(len(first)), last - first)
        visits.append(visit)
        keys.append(couple * many + arrays.visit_bin[visit] - low)
    key, i, j = np.intersect1d(keys[0], keys[1], assume_unique=True, return_indices=True)
    return visits[0][i], visits[1][j], key // many


def _neighbours(arrays: SegmentArrays, group: Numbers, settings: PairingSettings) -> Numbers:
    """Return (forward, reverse) spans: neighbours in time, then neighbours among what is left."""
    found: list[Numbers] = []
    waiting = group
    while True:
        one, other = waiting[:-1], waiting[1:]
        fit = np.flatnonzero(
            (arrays.direction[one] != arrays.direction[other])
            & _agree(arrays, one, other, settings)
        )
        fit = fit[np.isin(np.arange(len(fit)), _shared(arrays, one[fit], other[fit])[2])]
        taken = _apart(fit)
        if not len(taken):
            return np.concatenate([*found, np.empty((0, 2), dtype=np.int64)])
        couple = np.column_stack([waiting[taken], waiting[taken + 1]])
        back = arrays.direction[couple[:, 0]] < 0
        couple[back] = couple[back, ::-1]
        found.append(couple)
        waiting = np.delete(waiting, np.concatenate([taken, taken + 1]))


def _apart(numbers: Numbers) -> Numbers:
    """Return growing numbers without those that follow right on one that is kept."""
    kept, last = [], -2
    for number in numbers.tolist():
        if number > last + 1:
            kept.append(number)
            last = number
    return np.array(kept, dtype=np.int64)


def _leftovers(
    arrays: SegmentArrays, group: Numbers, visit_couple: Numbers, settings: PairingSettings
) -> tuple[Numbers, Numbers]:
    """Return visits forward and reverse to one bin that were still free, nearest in time first."""
    visits = members(*arrays.visits_of(group))
    free = visits[visit_couple[visits] < 0]
    ahead = arrays.direction[arrays.visit_span[free]] > 0
    found: list[tuple[Numbers, Numbers]] = [(visits[:0], visits[:0])]
    for number in np.intersect1d(arrays.visit_bin[free[ahead]], arrays.visit_bin[free[~ahead]]):
        here = arrays.visit_bin[free] == number
        forward, reverse = free[here & ahead], free[here & ~ahead]
        apart = np.abs(arrays.visit_time[forward][:, None] - arrays.visit_time[reverse])
        one, other = np.meshgrid(
            arrays.visit_span[forward], arrays.visit_span[reverse], indexing="ij"
        )
        apart[~_agree(arrays, one, other, settings)] = np.inf
        i, j = _nearest_first(apart)
        found.append((forward[i], reverse[j]))
    forward, reverse = (np.concatenate(parts) for parts in zip(*found, strict=True))
    return forward, reverse


def _nearest_first(apart: Array) -> tuple[Numbers, Numbers]:
    """Return rows and columns matched by taking the smallest distance left, again and again.

    Whoever are each other's nearest are matched sooner or later, so all of them are at once.
    """
    rows, columns = np.arange(apart.shape[0]), np.arange(apart.shape[1])
    found: list[tuple[Numbers, Numbers]] = [(rows[:0], columns[:0])]
    while rows.size and columns.size:
        left = apart[np.ix_(rows, columns)]
        nearest = left.argmin(axis=1)
        mutual = left.argmin(axis=0)[nearest] == np.arange(len(rows))
        mutual &= np.isfinite(left[np.arange(len(rows)), nearest])
        if not mutual.any():
            break
        found.append((rows[mutual], columns[nearest[mutual]]))
        rows, columns = rows[~mutual], np.delete(columns, nearest[mutual])
    i, j = (np.concatenate(parts) for parts in zip(*found, strict=True))
    return i, j
