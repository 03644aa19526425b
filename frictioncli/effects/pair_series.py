"""Functions shared by effects: values per pair, first-order lags over time, ends of the stroke."""

from dataclasses import dataclass, fields

import numpy as np
from scipy.linalg.lapack import dtbtrs

from frictioncli.arrays import Array, Flags, Indices
from frictioncli.effects.base import EffectTable

_FEW_SERIES = 5
"""With fewer series a change is tried before every pair."""

_MOST_MOMENTS = 480
"""Greatest number of moments tried for a change."""

_CUT_ALIKE = 10.0
"""Tolerance within which the same angle is cut off both ends of a stroke. [deg]"""


@dataclass(frozen=True, slots=True)
class PairHeads:
    """Positions of the pairs in a table.

    Attributes
    ----------
    first : ndarray of int, shape (pairs,)
        First row of each pair.
    of_row : ndarray of int, shape (rows,)
        Number of each row's pair.
    """

    first: Indices
    of_row: Indices

    def spread(self, per_pair: Array) -> Array:
        """Return one value per row from one value per pair."""
        return per_pair[self.of_row]

    def mean(self, per_row: Array) -> Array:
        """Return the mean over each pair's rows."""
        return np.add.reduceat(per_row, self.first) / np.bincount(self.of_row)

    def minimum(self, per_row: Array) -> Array:
        """Return the least value of each pair."""
        return np.asarray(np.minimum.reduceat(per_row, self.first))

    def maximum(self, per_row: Array) -> Array:
        """Return the greatest value of each pair."""
        return np.asarray(np.maximum.reduceat(per_row, self.first))


def rows_of(table: EffectTable, chosen: Flags | Indices) -> EffectTable:
    """Return some rows of a table.

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    chosen : ndarray of bool or int
        The rows.
    """
    names = [one.name for one in fields(EffectTable) if one.init]
    return EffectTable(**{name: getattr(table, name)[chosen] for name in names})


def pair_heads(table: EffectTable) -> PairHeads:
    """Return the positions of the pairs in a table; each run has its own pairs."""
    begins = starts(table.pair) | starts(table.run)
    return PairHeads(np.flatnonzero(begins), np.cumsum(begins) - 1)


def starts(labels: Indices) -> Flags:
    """Return where a label differs from the one before, True at first, shape (rows,)."""
    return np.concatenate([np.ones(min(1, len(labels)), bool), labels[1:] != labels[:-1]])


def first_order_lag(*, time: Array, value: Array, restart: Flags, time_constant: float) -> Array:
    r"""Return the difference of a first-order lag and its input.

    Parameters
    ----------
    time : ndarray, shape (pairs,)
        Times of the values, increasing between two restarts. [s]
    value : ndarray, shape (pairs,)
        Input, linear between two times.
    restart : ndarray of bool, shape (pairs,)
        Where the lag is reset to its input.
    time_constant : float
        Time constant of the lag. [s]

    Returns
    -------
    ndarray, shape (pairs,)
        Output minus input, in the unit of the input.

    Notes
    -----
    With :math:`\theta \dot y = u - y`, input :math:`u` linear over a step :math:`h` and lag
    :math:`x = y - u`, exactly

    .. math:: x_1 = x_0 e^{-h/\theta} - (u_1 - u_0) \frac{1 - e^{-h/\theta}}{h/\theta}

    Examples
    --------
    >>> import numpy as np
    >>> lag = first_order_lag(
    ...     time=np.array([0.0, 100.0, 1e6]),
    ...     value=np.array([20.0, 30.0, 30.0]),
    ...     restart=np.array([True, False, False]),
    ...     time_constant=100.0,
    ... )
    >>> print(lag.round(2) + 0.0)
    [ 0.   -6.32  0.  ]
    """
    ratio = np.maximum(np.diff(time), 0.0) / time_constant
    share = np.where(ratio > 0, -np.expm1(-ratio) / np.where(ratio > 0, ratio, 1.0), 1.0)
    return linear_recursion(decay=np.exp(-ratio), gain=-np.diff(value) * share, restart=restart)


def first_order_response(
    *, time: Array, level: Array, restart: Flags, time_constant: float
) -> Array:
    r"""Return the output of a first-order lag whose input is constant between two times.

    Parameters
    ----------
    time : ndarray, shape (pairs,)
        Times, increasing between two restarts. [s]
    level : ndarray, shape (pairs - 1,)
        Input from each time to the next.
    restart : ndarray of bool, shape (pairs,)
        Where the output is reset to zero.
    time_constant : float
        Time constant of the lag. [s]

    Returns
    -------
    ndarray, shape (pairs,)
        Output, in the unit of the input.

    Notes
    -----
    .. math:: y_1 = y_0 e^{-h/\theta} + u (1 - e^{-h/\theta})

    Examples
    --------
    >>> import numpy as np
    >>> response = first_order_response(
    ...     time=np.array([0.0, 100.0]),
    ...     level=np.array([2.0]),
    ...     restart=np.array([True, False]),
    ...     time_constant=100.0,
    ... )
    >>> print(response.round(3))
    [0.    1.264]
    """
    ratio = np.maximum(np.diff(time), 0.0) / time_constant
    return linear_recursion(decay=np.exp(-ratio), gain=-level * np.expm1(-ratio), restart=restart)


def linear_recursion(*, decay: Array, gain: Array, restart: Flags, first: float = 0.0) -> Array:
    """Return x with ``x[i + 1] = decay[i] x[i] + gain[i]``, shape (pairs,).

    Parameters
    ----------
    decay, gain : ndarray, shape (pairs - 1,)
        From each pair to the next.
    restart : ndarray of bool, shape (pairs,)
        Where x begins anew.
    first : float, optional
        x there.

    Examples
    --------
    >>> import numpy as np
    >>> linear_recursion(
    ...     decay=np.array([0.5, 0.5, 0.5]),
    ...     gain=np.array([0.0, 0.0, 1.0]),
    ...     restart=np.array([True, False, True, False]),
    ...     first=1.0,
    ... )
    array([1. , 0.5, 1. , 1.5])
    """
    banded = np.empty((2, len(restart)))
    banded[0] = 1.0
    banded[1, :-1] = np.where(restart[1:], 0.0, -decay)
    right = np.where(restart, first, np.append(0.0, gain)[: len(restart)])
    return np.asarray(dtbtrs(banded, right, uplo="L", diag="U")[0])


def measured_share(table: EffectTable) -> Array:
    """Return the share of all pairs that were measured before each row's pair, by the clock."""
    heads = pair_heads(table)
    clock = table.clock[heads.first]
    return heads.spread(np.searchsorted(np.sort(clock), clock, side="left") / len(clock))


def series_starts(table: EffectTable, most: int = _MOST_MOMENTS) -> Array:
    """Return the shares of all pairs measured before each measuring series, shape (moments,).

    Work on a joint takes place between two series. If a table has more than so many of them, only
    every second is returned, or every third, and so on.

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    most : int, optional
        Greatest number of moments.
    """
    heads = pair_heads(table)
    clock = table.clock[heads.first]
    share = np.searchsorted(np.sort(clock), clock, side="left") / len(clock)
    begins = np.unique(share[(table.order[heads.first] == 0) & (share > 0)])
    if len(begins) < _FEW_SERIES:
        begins = np.unique(share)[1:]
    return np.asarray(begins[:: max(1, -(-len(begins) // most))])


def stroke_ends(table: EffectTable, *, distance: Array | float) -> tuple[Array, Array]:
    """Return exponentials that decay from the low and from the high end of each pair's angles.

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    distance : float or ndarray, shape (rows,)
        Distance from the end at which they have decayed to 37 %. [deg]

    Returns
    -------
    low, high : ndarray, shape (rows,)
        1 in the outermost bin. [-]
    """
    heads = pair_heads(table)
    ends = heads.minimum(table.position), heads.maximum(table.position)
    return _decays(table.position, heads, ends, distance)


def turning_points(table: EffectTable, *, distance: float) -> tuple[Array, Array]:
    """Return exponentials that decay from the low and from the high reversal of each pair.

    A fast move reaches its speed later, so that its first bin lies further from the reversal, and
    its last one as far from the other. Pairs that lack the same angle at both ends of the range of
    their run are assumed to reverse at the ends of that range; others at their own ends.

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    distance : float
        Distance from the reversal at which they have decayed to 37 %. [deg]

    Returns
    -------
    low, high : ndarray, shape (rows,)
        1 at the reversal. [-]
    """
    heads = pair_heads(table)
    return _decays(table.angle, heads, reversals(table, heads), distance)


def reversals(table: EffectTable, heads: PairHeads) -> tuple[Array, Array]:
    """Return the angles between which the joint turns, as :func:`turning_points` takes them.

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    heads : PairHeads
        Positions of its pairs.

    Returns
    -------
    lowest, highest : ndarray, shape (pairs,)
        Angles of the reversals. [deg]
    """
    lowest, highest = heads.minimum(table.position), heads.maximum(table.position)
    run = table.run[heads.first]
    for number in np.unique(run):
        chosen = run == number
        least, most = np.min(lowest[chosen]), np.max(highest[chosen])
        cut_low, cut_high = lowest - least, most - highest
        same = chosen & (np.abs(cut_low - cut_high) < _CUT_ALIKE)
        lowest[same], highest[same] = least, most
    return lowest, highest


def _decays(
    angle: Array, heads: PairHeads, ends: tuple[Array, Array], distance: Array | float
) -> tuple[Array, Array]:
    """Return exponentials that decay from the low and from the high of each pair's two angles."""
    low = np.maximum(angle - heads.spread(ends[0]), 0.0)
    high = np.maximum(heads.spread(ends[1]) - angle, 0.0)
    return np.exp(-low / distance), np.exp(-high / distance)
