"""Matching of counter-directed segments bin by bin; arrays only."""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Flags, Numbers
from frictioncli.pairs.settings import PairingSettings
from frictioncli.pairs.slices import slice_indices


@dataclass(frozen=True, slots=True, kw_only=True)
class SegmentArrays:
    """Segments, and a row for each bin of each segment, in the order of segments.

    Attributes
    ----------
    direction : ndarray of int, shape (segments,)
        +1 or -1.
    start, stop : ndarray, shape (segments,)
        Times. [s]
    temperature : ndarray, shape (segments,)
        Motor temperature, NaN where unknown. [°C]
    bin_segment : ndarray of int, shape (rows,)
        Segment of each row.
    bin_number : ndarray of int, shape (rows,)
        Bin of each row; the bins of a segment ascend.
    bin_time : ndarray, shape (rows,)
        Mean time of the segment in the bin. [s]
    """

    direction: Numbers
    start: Array
    stop: Array
    temperature: Array
    bin_segment: Numbers
    bin_number: Numbers
    bin_time: Array

    def rows_of(self, segments: Numbers) -> tuple[Numbers, Numbers]:
        """Return the first and past-the-end row of segments."""
        first, last = (np.searchsorted(self.bin_segment, segments + i) for i in (0, 1))
        return first, last


@dataclass(frozen=True, slots=True)
class Matches:
    """Matched segments.

    Attributes
    ----------
    forward, reverse : ndarray of int, shape (matches,)
        The two segments of each match.
    bin_match : ndarray of int, shape (rows,)
        Match of each row, -1 where it has none.
    """

    forward: Numbers
    reverse: Numbers
    bin_match: Numbers


def match_bins(arrays: SegmentArrays, groups: list[Numbers], settings: PairingSettings) -> Matches:
    """Match the bins of counter-directed segments within groups of the same joint and speed.

    Neighbours in time are matched first, in all bins that they share. Bins that remain are then
    matched one by one, so that moves between random angles find partners too.

    Parameters
    ----------
    arrays : SegmentArrays
        All segments.
    groups : list of ndarray of int
        Segments that may match each other, in time order.
    settings : PairingSettings
        What makes a pair.

    Returns
    -------
    Matches
        The matches.
    """
    matches = np.empty((0, 2), dtype=np.int64)
    bin_match = np.full(len(arrays.bin_segment), -1, dtype=np.int64)
    for group in groups:
        found = _match_neighbours(arrays, group, settings)
        forward, reverse, number = _shared_bins(arrays, found[:, 0], found[:, 1])
        bin_match[forward] = bin_match[reverse] = len(matches) + number
        matches = np.concatenate([matches, found])
        forward, reverse = _match_single_bins(arrays, group, bin_match, settings)
        segments = np.column_stack([arrays.bin_segment[forward], arrays.bin_segment[reverse]])
        found, number = np.unique(segments, axis=0, return_inverse=True)
        bin_match[forward] = bin_match[reverse] = len(matches) + number.ravel()
        matches = np.concatenate([matches, found])
    return Matches(matches[:, 0], matches[:, 1], bin_match)


def _compatible(
    arrays: SegmentArrays, one: Numbers, other: Numbers, settings: PairingSettings
) -> Flags:
    """Return whether segments are near enough to each other in time and temperature."""
    ordered = arrays.start[one] <= arrays.start[other]
    first, second = np.where(ordered, one, other), np.where(ordered, other, one)
    pause = arrays.start[second] - arrays.stop[first]
    difference = np.abs(arrays.temperature[one] - arrays.temperature[other])
    # without temperatures the difference is NaN and cannot forbid a pair
    return (pause <= settings.longest_pause) & ~(difference > settings.same_temperature)


def _shared_bins(
    arrays: SegmentArrays, one: Numbers, other: Numbers
) -> tuple[Numbers, Numbers, Numbers]:
    """Return the rows of both segments of couples in the bins that they share, and the couple."""
    low = arrays.bin_number.min(initial=0)
    count = arrays.bin_number.max(initial=0) - low + 1
    rows, keys = [], []
    for first, last in (arrays.rows_of(one), arrays.rows_of(other)):
        row = slice_indices(first, last)
        couple = np.repeat(np.arange(len(first)), last - first)
        rows.append(row)
        keys.append(couple * count + arrays.bin_number[row] - low)
    key, i, j = np.intersect1d(keys[0], keys[1], assume_unique=True, return_indices=True)
    return rows[0][i], rows[1][j], key // count


def _match_neighbours(arrays: SegmentArrays, group: Numbers, settings: PairingSettings) -> Numbers:
    """Return matched segments (forward, reverse): neighbours in time, again among the remaining."""
    found: list[Numbers] = []
    remaining = group
    while True:
        one, other = remaining[:-1], remaining[1:]
        candidate = np.flatnonzero(
            (arrays.direction[one] != arrays.direction[other])
            & _compatible(arrays, one, other, settings)
        )
        sharing = _shared_bins(arrays, one[candidate], other[candidate])[2]
        candidate = candidate[np.isin(np.arange(len(candidate)), sharing)]
        chosen = _without_successors(candidate)
        if not len(chosen):
            return np.concatenate([*found, np.empty((0, 2), dtype=np.int64)])
        couple = np.column_stack([remaining[chosen], remaining[chosen + 1]])
        reverse_first = arrays.direction[couple[:, 0]] < 0
        couple[reverse_first] = couple[reverse_first, ::-1]
        found.append(couple)
        remaining = np.delete(remaining, np.concatenate([chosen, chosen + 1]))


def _without_successors(numbers: Numbers) -> Numbers:
    """Return ascending numbers without those that follow directly on one that is kept."""
    kept, last = [], -2
    for number in numbers.tolist():
        if number > last + 1:
            kept.append(number)
            last = number
    return np.array(kept, dtype=np.int64)


def _match_single_bins(
    arrays: SegmentArrays, group: Numbers, bin_match: Numbers, settings: PairingSettings
) -> tuple[Numbers, Numbers]:
    """Return unmatched rows forward and in reverse of the same bin, nearest in time first."""
    rows = slice_indices(*arrays.rows_of(group))
    free = rows[bin_match[rows] < 0]
    is_forward = arrays.direction[arrays.bin_segment[free]] > 0
    found: list[tuple[Numbers, Numbers]] = [(rows[:0], rows[:0])]
    for number in np.intersect1d(
        arrays.bin_number[free[is_forward]], arrays.bin_number[free[~is_forward]]
    ):
        in_bin = arrays.bin_number[free] == number
        forward, reverse = free[in_bin & is_forward], free[in_bin & ~is_forward]
        distance = np.abs(arrays.bin_time[forward][:, None] - arrays.bin_time[reverse])
        one, other = np.meshgrid(
            arrays.bin_segment[forward], arrays.bin_segment[reverse], indexing="ij"
        )
        distance[~_compatible(arrays, one, other, settings)] = np.inf
        i, j = _nearest_first(distance)
        found.append((forward[i], reverse[j]))
    forward, reverse = (np.concatenate(rows) for rows in zip(*found, strict=True))
    return forward, reverse


def _nearest_first(distance: Array) -> tuple[Numbers, Numbers]:
    """Return rows and columns matched by taking the smallest remaining distance, repeatedly.

    Rows and columns that are each other's nearest are matched sooner or later, so all of them are
    matched at once.
    """
    rows, columns = np.arange(distance.shape[0]), np.arange(distance.shape[1])
    found: list[tuple[Numbers, Numbers]] = [(rows[:0], columns[:0])]
    while rows.size and columns.size:
        remaining = distance[np.ix_(rows, columns)]
        nearest = remaining.argmin(axis=1)
        mutual = remaining.argmin(axis=0)[nearest] == np.arange(len(rows))
        mutual &= np.isfinite(remaining[np.arange(len(rows)), nearest])
        if not mutual.any():
            break
        found.append((rows[mutual], columns[nearest[mutual]]))
        rows, columns = rows[~mutual], np.delete(columns, nearest[mutual])
    i, j = (np.concatenate(numbers) for numbers in zip(*found, strict=True))
    return i, j
