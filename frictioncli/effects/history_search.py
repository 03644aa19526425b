"""Histories to try for a change, and the search for the pairs at which it came and went."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import combinations

import numpy as np

from frictioncli.arrays import Array, Indices
from frictioncli.effects.base import EffectTable
from frictioncli.effects.history import (
    Shape,
    Stretch,
    distinct,
    history,
    present,
    run_spans,
    spans_with,
    stretches,
    with_run,
)
from frictioncli.effects.pair_series import measured_share, pair_heads, series_starts

_MOST = 250
"""Greatest number of histories tried; the cost of a search is proportional to it."""

_BOUNDARIES = 12
"""Moments between which a single stretch is tried, beside the starts of runs."""

_SHARES = 16
"""Parts of a run at whose boundaries a recurring change is tried."""

_PARTS = 5
"""Parts of a run between whose boundaries a recurring change that also ends is tried."""

_MOMENTS_OF_RUN = 7
"""Moments of a run from which on, or up to which, a change is tried beside the other runs."""

_STRETCH_COST = 4.0
"""Log likelihood that a further stretch must gain."""

_MOST_RUNS = 30
"""Greatest number of runs tried one by one."""


def histories(table: EffectTable) -> list[Shape]:
    """Return the histories to try: lasting ones, recurring ones and single stretches.

    Work on a joint takes place between two measuring series, so that their starts are tried;
    :func:`refined_history` moves them to a pair. The absence of a change up to a moment is not
    tried beside its presence from there on, which differs from it by what the base model explains.

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins of all runs.

    Returns
    -------
    list of dict
        At most 250 histories, all of different pairs.
    """
    spans, moments = run_spans(table), series_starts(table)
    begins = np.array([begin for begin, _ in spans[1:]])
    others = list(_recurring(table, spans))
    others += [history([spans[place]]) for place in 1 + _evenly(len(spans) - 2, _MOST_RUNS)]
    boundaries = np.union1d(_thinned(moments, _BOUNDARIES), _thinned(begins, _BOUNDARIES))
    pairs = combinations(_thinned(boundaries, _BOUNDARIES + 2).tolist(), 2)
    others += [history([pair]) for pair in pairs]
    lasting = np.union1d(_thinned(moments, max(_MOST - len(others), 40)), begins)
    shapes = [history([(float(moment), 1.0)]) for moment in lasting]
    share = measured_share(table)[pair_heads(table).first]
    return distinct([*shapes, *others], share)[:_MOST]


def leaves_out(table: EffectTable, rows: Indices, shapes: Sequence[Mapping[str, float]]) -> bool:
    """Return whether some measuring series begin with no change that is tried.

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins of all runs.
    rows : ndarray of int
        Rows of the runs whose history is searched.
    shapes : sequence of mapping of str to float
        The histories that are tried.
    """
    share, starts = measured_share(table)[rows], series_starts(table, most=len(rows) + 1)
    own = starts[(starts > share.min()) & (starts <= share.max())]
    tried = {begin for shape in shapes for begin, _ in stretches(shape)}
    return not tried.issuperset(own.tolist())


def _evenly(count: int, most: int) -> Indices:
    """Return places of at most so many of a number of items, at even distances."""
    if count < 1:
        return np.empty(0, np.intp)
    return np.unique(np.linspace(0, count - 1, min(most, count)).round().astype(np.intp))


def _thinned(moments: Array, most: int) -> Array:
    """Return at most so many of the moments, evenly."""
    return moments[_evenly(len(moments), most)]


def _recurring(table: EffectTable, spans: Sequence[Stretch]) -> Iterable[Shape]:
    """Yield histories that are the same in each of several runs, by share or by hours."""
    if len(spans) < 2:
        return
    heads = pair_heads(table)
    share, time = measured_share(table)[heads.first], table.time[heads.first]
    places = [np.flatnonzero((share >= begin) & (share < end)) for begin, end in spans]

    def at(part: float) -> list[float]:
        return [float(np.sort(share[own])[int(part * len(own))]) for own in places]

    for number in range(1, _SHARES):
        yield history(zip(at(number / _SHARES), (end for _, end in spans), strict=True))
    longest = max(float(np.ptp(time[own])) for own in places)
    for number in range(1, _SHARES):
        hour = number / _SHARES * longest
        later = [share[own][time[own] - time[own].min() >= hour] for own in places]
        yield history(
            (float(left.min()), end)
            for left, (_, end) in zip(later, spans, strict=True)
            if left.size
        )
    for first, last in combinations(range(1, _PARTS), 2):
        yield history(zip(at(first / _PARTS), at(last / _PARTS), strict=True))


def refined_history(
    shape: Mapping[str, float],
    table: EffectTable,
    rows: Indices,
    score: Callable[[Shape], float],
) -> Shape:
    """Return the history with the highest score near a given one, resolved to single pairs.

    Run by run it is tried that the change is there throughout, not at all, from a moment on or up
    to one; then each moment is moved by ever smaller steps. The history of other runs than those of
    ``rows`` stays.

    Parameters
    ----------
    shape : mapping of str to float
        The history to start from.
    table : EffectTable
        Pairs and angle bins of all runs.
    rows : ndarray of int
        Rows of the runs whose history is searched.
    score : callable
        Log likelihood of a history.

    Returns
    -------
    dict of str to float
        The history.
    """
    share = np.unique(measured_share(table)[rows])
    spans = spans_with(table, share)
    best = history(stretches(shape))
    highest = score(best) - _STRETCH_COST * len(stretches(best))

    def improved(candidate: Shape) -> bool:
        nonlocal best, highest
        there = present(share, candidate)
        if not there.any() or there.all():
            return False
        value = score(candidate) - _STRETCH_COST * len(stretches(candidate))
        if value > highest:
            best, highest = candidate, value
            return True
        return False

    if len(spans) > 1:
        for span in spans[:_MOST_RUNS]:
            for parts in _parts_of_run(span, share):
                improved(with_run(best, span, parts))
    step = max(len(share) // _SHARES, 1)
    while step:
        for number in range(2 * len(stretches(best))):
            for way in (-step, step):
                while improved(_moved(best, number, way, share, spans)):
                    pass
        step //= 2
    return best


def _parts_of_run(span: Stretch, share: Array) -> Iterable[list[Stretch]]:
    """Yield what a run may have of a change: all, nothing, or what follows or precedes a moment."""
    yield [span]
    yield []
    own = share[(share >= span[0]) & (share < span[1])]
    for moment in own[_evenly(len(own), _MOMENTS_OF_RUN + 2)][1:-1]:
        yield [(float(moment), span[1])]
        yield [(span[0], float(moment))]


def _moved(shape: Shape, number: int, way: int, share: Array, spans: Sequence[Stretch]) -> Shape:
    """Return a history with one of its moments moved by so many pairs, if it is in these runs."""
    parts = [list(part) for part in stretches(shape)]
    if number >= 2 * len(parts):
        return shape
    edge = parts[number // 2][number % 2]
    if edge not in share and not (edge == 1.0 and spans[-1][1] == 1.0):
        return shape
    edges = np.append(share, 1.0) if spans[-1][1] == 1.0 else share
    place = int(np.searchsorted(edges, edge)) + way
    parts[number // 2][number % 2] = float(edges[min(max(place, 0), len(edges) - 1)])
    return history((begin, end) for begin, end in parts)
