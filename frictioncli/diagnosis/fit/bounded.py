r"""Coefficients of candidates within their physical bounds, from inner products.

A candidate's coefficients *c* raise twice the log likelihood by
:math:`2 u^\mathsf{T} c - c^\mathsf{T} S c`, with the inner products *S* of what the null hypothesis
leaves of its columns and *u* of these with the misfit. The greatest value between the bounds is
found by trying which coefficients lie on a bound, until none would gain by leaving it: a candidate
has few.
"""

from itertools import product

import numpy as np

from frictioncli.arrays import Array, Flags, Indices

_RANK = 1e-9
"""Eigenvalues of the inner products at unit length below this count as zero."""


def bounded_coefficients(
    inner: Array, right: Array, lower: Array, upper: Array
) -> tuple[Array, Array, Flags]:
    """Return the best coefficients of each candidate within bounds.

    Parameters
    ----------
    inner : ndarray, shape (candidates, width, width)
        Inner products of what the null hypothesis leaves of the columns.
    right : ndarray, shape (candidates, width)
        Those with the misfit.
    lower, upper : ndarray, shape (width,)
        Bounds of the coefficients.

    Returns
    -------
    coefficients : ndarray, shape (candidates, width)
        The coefficients.
    gain : ndarray, shape (candidates,)
        Twice the gain in log likelihood.
    free : ndarray of bool, shape (candidates, width)
        Coefficients that lie on no bound and that the data determine.

    Examples
    --------
    >>> import numpy as np
    >>> inner, right = np.eye(2)[np.newaxis], np.array([[2.0, -1.0]])
    >>> found = bounded_coefficients(inner, right, np.zeros(2), np.full(2, 5.0))
    >>> print(found[0], found[1], found[2])
    [[2. 0.]] [4.] [[ True False]]
    """
    size = np.sqrt(np.maximum(np.diagonal(inner, axis1=1, axis2=2), 0.0))
    determined = size > 0
    if inner.shape[1] == 1:
        return _single(inner[:, 0, 0], right[:, 0], float(lower[0]), float(upper[0]))
    everything = np.ones(inner.shape[1], bool)
    coefficients, gain = _solved(inner, right, everything, np.zeros_like(right))
    free = determined.copy()
    outside = np.any((coefficients < lower) | (coefficients > upper), axis=1)
    if not outside.any():
        return coefficients, gain, free
    where = np.flatnonzero(outside)
    best = np.zeros(len(where))
    coefficients[where], free[where] = 0.0, False
    states = [
        [0, *([1] if np.isfinite(low) else []), *([2] if np.isfinite(high) else [])]
        for low, high in zip(lower, upper, strict=True)
    ]
    on_bound = np.column_stack([np.zeros_like(lower), np.nan_to_num(lower), np.nan_to_num(upper)])
    unsolved = np.arange(len(where))
    for state in product(*states):
        at, there = np.array(state), where[unsolved]
        fixed = np.broadcast_to(on_bound[np.arange(len(at)), at], right[there].shape)
        tried, value = _solved(inner[there], right[there], at == 0, fixed)
        inside = np.all((tried >= lower - 1e-12) & (tried <= upper + 1e-12), axis=1)
        better = inside & (value > best[unsolved])
        best[unsolved[better]] = value[better]
        coefficients[there[better]] = tried[better]
        free[there[better]] = (at == 0) & determined[there[better]]
        unsolved = unsolved[~(inside & _is_best(inner[there], right[there], tried, at))]
        if not unsolved.size:
            break
    gain[where] = best
    return coefficients, gain, free


def _is_best(inner: Array, right: Array, tried: Array, at: Indices) -> Flags:
    """Return where no coefficient on a bound would gain by leaving it.

    The gain is concave, so that nothing else between the bounds is better then.
    """
    slope = right - np.einsum("gij,gj->gi", inner, tried)
    outward = np.where(at == 1, -slope, np.where(at == 2, slope, 0.0))
    return np.asarray(np.all(outward >= 0.0, axis=1))


def _single(inner: Array, right: Array, lower: float, upper: float) -> tuple[Array, Array, Flags]:
    """Return the same of candidates with a single coefficient."""
    determined = inner > 0
    free = np.where(determined, right / np.where(determined, inner, 1.0), 0.0)
    coefficients = np.clip(free, lower, upper)
    gain = 2 * right * coefficients - np.square(coefficients) * inner
    inside = (free >= lower) & (free <= upper)
    # on a bound that explains nothing there is no effect
    coefficients = np.where(inside | (gain > 0), coefficients, 0.0)
    return coefficients[:, np.newaxis], np.maximum(gain, 0.0), (inside & determined)[:, np.newaxis]


def _solved(inner: Array, right: Array, free: Array, fixed: Array) -> tuple[Array, Array]:
    """Return coefficients with some of them fixed, and twice the gain in log likelihood."""
    coefficients = np.where(free, 0.0, fixed)
    if free.any():
        own = inner[:, free][:, :, free]
        rest = right[:, free] - np.einsum("gij,gj->gi", inner[:, free], coefficients)
        coefficients[:, free] = np.einsum("gij,gj->gi", pseudo_inverse(own), rest)
    gain = 2 * np.sum(right * coefficients, axis=1)
    gain = gain - np.einsum("gi,gij,gj->g", coefficients, inner, coefficients)
    return coefficients, np.maximum(gain, 0.0)


def pseudo_inverse(inner: Array) -> Array:
    """Return the pseudo-inverses of inner products of few columns, scaled to unit length."""
    size = np.sqrt(np.maximum(np.diagonal(inner, axis1=1, axis2=2), 0.0))
    size = np.where(size > 0, size, np.inf)
    if inner.shape[1] == 1:
        return np.asarray(1 / np.square(size)[:, :, np.newaxis])
    sizes = size[:, :, np.newaxis] * size[:, np.newaxis, :]
    # as numpy.linalg.pinv, which takes three times as long for matrices of this size
    values, vectors = np.linalg.eigh(inner / sizes)
    kept = np.abs(values) > _RANK * np.abs(values).max(axis=1, keepdims=True)
    inverse = np.divide(1.0, values, where=kept, out=np.zeros_like(values))
    return np.asarray((vectors * inverse[:, np.newaxis]) @ vectors.swapaxes(1, 2) / sizes)
