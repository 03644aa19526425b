r"""Histories: when a change was there.

A change of friction or of payload comes, goes and recurs. It is there in one stretch of the
measurements or in several; a stretch lasts from one moment to another, and one that ends with the
last pair is lasting. Moments are shares of all pairs, in order of time: a moment within a run is
then resolved as well as one between two runs, however long the joint rested in between.

As shape parameters, the first stretch is ``moment`` and ``end``, the next ``moment_2`` and
``end_2``, and so on.
"""

from collections.abc import Iterable, Mapping

import numpy as np

from frictioncli.arrays import Array, Flags
from frictioncli.effects.base import EffectTable
from frictioncli.effects.pair_series import measured_share, pair_heads
from frictioncli.effects.parameter import Parameter

Shape = dict[str, float]
"""Shape parameters of a history."""

Stretch = tuple[float, float]
"""Shares of all pairs measured before a stretch, and before what follows it."""

SHAPE = (
    Parameter(
        name="moment",
        symbol="m",
        unit="share of pairs",
        lower=0.0,
        upper=1.0,
        description="Share of all pairs measured before the change is there",
    ),
    Parameter(
        name="end",
        symbol="e",
        unit="share of pairs",
        lower=0.0,
        upper=1.0,
        description="Share of all pairs measured before it ends; 1 for a lasting change",
    ),
)
"""Shape parameters of the first stretch of a history."""

LASTING: Shape = {"moment": 0.0, "end": 1.0}
"""History of a change that is there from the first pair to the last."""


def stretches(shape: Mapping[str, float]) -> list[Stretch]:
    """Return the stretches of a history, in order; empty ones are left out.

    Parameters
    ----------
    shape : mapping of str to float
        Shape parameters; the end of a stretch without one is that of the measurements.

    Examples
    --------
    >>> stretches({"moment": 0.25, "end": 0.5, "moment_2": 0.75})
    [(0.25, 0.5), (0.75, 1.0)]
    """
    names = [name for name in shape if name.startswith("moment")]
    ends = (shape.get(name.replace("moment", "end"), 1.0) for name in names)
    pairs = zip((shape[name] for name in names), ends, strict=True)
    return sorted((float(begin), float(end)) for begin, end in pairs if begin < end)


def history(parts: Iterable[Stretch]) -> Shape:
    """Return the shape parameters of a history; stretches that touch are joined.

    Parameters
    ----------
    parts : iterable of (float, float)
        Stretches in any order. Without any, the change is never there.

    Examples
    --------
    >>> history([(0.75, 1.0), (0.25, 0.375), (0.375, 0.5)])
    {'moment': 0.25, 'end': 0.5, 'moment_2': 0.75, 'end_2': 1.0}
    """
    joined: list[Stretch] = []
    for begin, end in sorted(part for part in parts if part[0] < part[1]):
        if joined and begin <= joined[-1][1]:
            joined[-1] = (joined[-1][0], max(end, joined[-1][1]))
        else:
            joined.append((begin, end))
    shape = {"moment": 1.0, "end": 1.0}
    for number, (begin, end) in enumerate(joined, start=1):
        suffix = f"_{number}" if number > 1 else ""
        shape |= {f"moment{suffix}": begin, f"end{suffix}": end}
    return shape


def present(share: Array, shape: Mapping[str, float]) -> Flags:
    """Return where a change is there, of the shape of ``share``.

    Parameters
    ----------
    share : ndarray
        Shares of all pairs measured before. [-]
    shape : mapping of str to float
        The history.
    """
    there = np.zeros(np.shape(share), bool)
    for begin, end in stretches(shape):
        there |= (share >= begin) & (share < end)
    return there


def presence(table: EffectTable, shape: Mapping[str, float]) -> Array:
    """Return 1 where a change is there and 0 elsewhere, shape (rows,). [-].

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    shape : mapping of str to float
        The history.
    """
    return np.where(present(measured_share(table), shape), 1.0, 0.0)


def rescaled(shape: Mapping[str, float], observed: float) -> Shape:
    """Return a history in terms of more pairs, of which those at hand are a share.

    A lasting change goes on in the further pairs.

    Parameters
    ----------
    shape : mapping of str to float
        The history of the pairs at hand.
    observed : float
        Their share. [-]

    Examples
    --------
    >>> rescaled({"moment": 0.5, "end": 1.0}, 0.5)
    {'moment': 0.25, 'end': 1.0}
    """
    return history(
        (begin * observed, end * observed if end < 1.0 else 1.0) for begin, end in stretches(shape)
    )


def since_start(shape: Mapping[str, float], share: Array) -> Shape:
    """Return a history, or its complement, such that the change is absent at first.

    The base model explains what is always there, so that the presence of a change and its absence
    with the opposite sign are the same: what is there at first counts as the base.

    Parameters
    ----------
    shape : mapping of str to float
        The history.
    share : ndarray, shape (pairs,)
        Shares of all pairs measured before, of the pairs at hand. [-]

    Examples
    --------
    >>> import numpy as np
    >>> since_start({"moment": 0.0, "end": 0.25}, np.array([0.0, 0.25]))
    {'moment': 0.25, 'end': 1.0}
    """
    if not present(share.min(), shape):
        return history(stretches(shape))
    edges = [0.0, *(edge for part in stretches(shape) for edge in part), 1.0]
    return history(zip(edges[::2], edges[1::2], strict=True))


def run_spans(table: EffectTable) -> list[Stretch]:
    """Return the stretch of each run, in order of time.

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins of all runs.
    """
    heads = pair_heads(table)
    share, run = measured_share(table)[heads.first], table.run[heads.first]
    begins = sorted(float(share[run == number].min()) for number in np.unique(run))
    return list(zip(begins, [*begins[1:], 1.0], strict=True))


def spans_with(table: EffectTable, share: Array) -> list[Stretch]:
    """Return the spans of the runs that have some of these pairs, in order.

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins of all runs.
    share : ndarray
        Shares of all pairs measured before some of them. [-]
    """
    return [span for span in run_spans(table) if present(share, history([span])).any()]


def distinct(shapes: Iterable[Shape], share: Array) -> list[Shape]:
    """Return the histories that differ in some pairs; the first of those that do not.

    A change that is in all of the pairs, or in none of them, is left out.

    Parameters
    ----------
    shapes : iterable of dict
        Histories.
    share : ndarray, shape (pairs,)
        Shares of all pairs measured before, of the pairs at hand. [-]
    """
    found: dict[bytes, Shape] = {}
    for shape in shapes:
        there = present(share, shape)
        if there.any() and not there.all():
            found.setdefault(there.tobytes(), shape)
    return list(found.values())


def with_run(shape: Mapping[str, float], span: Stretch, parts: Iterable[Stretch]) -> Shape:
    """Return a history in which that of one run is replaced.

    Parameters
    ----------
    shape : mapping of str to float
        The history of all runs.
    span : (float, float)
        The stretch of the run.
    parts : iterable of (float, float)
        Stretches within the run.

    Examples
    --------
    >>> with_run({"moment": 0.25, "end": 1.0}, (0.5, 1.0), [(0.75, 1.0)])
    {'moment': 0.25, 'end': 0.5, 'moment_2': 0.75, 'end_2': 1.0}
    """
    begin, end = span
    kept = [(low, min(high, begin)) for low, high in stretches(shape)]
    kept += [(max(low, end), high) for low, high in stretches(shape)]
    return history([*kept, *parts])
