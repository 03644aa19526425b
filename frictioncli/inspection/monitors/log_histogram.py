"""Histogram of positive values on a logarithmic scale: quantiles of streams of any length."""

from dataclasses import dataclass, field

import numpy as np

from frictioncli.arrays import Array, Indices, Numbers

_RESOLUTION = 1e-4
_SMALLEST, _LARGEST = 1e-12, 1e12
_HALF = 0.5
_MAD_TO_STD = 1.4826


@dataclass(slots=True)
class LogHistogram:
    """Histogram with bins of 0.01 % of the value; values up to 0 are ignored.

    Examples
    --------
    >>> import numpy as np
    >>> histogram = LogHistogram()
    >>> histogram.add(np.array([1.0, 2.0, 2.0, 5.0]))
    >>> histogram.quantile(0.5), histogram.above(3.0)
    (2.0, 1)
    """

    _keys: Numbers = field(default_factory=lambda: np.empty(0, np.int64))
    _counts: Array = field(default_factory=lambda: np.empty(0))
    _sums: Array = field(default_factory=lambda: np.empty(0))

    def add(self, values: Array, counts: Array | None = None) -> None:
        """Add values.

        Parameters
        ----------
        values : ndarray, shape (n,)
            Values in any unit.
        counts : ndarray, shape (n,), optional
            Weight of each value, 1 by default.
        """
        times = np.ones(len(values)) if counts is None else counts
        positive = np.isfinite(values) & (values > 0)
        values, times = values[positive], times[positive]
        if not len(values):
            return
        within = np.clip(values, _SMALLEST, _LARGEST)
        keys = np.concatenate((self._keys, np.floor(np.log(within) / _RESOLUTION).astype(np.int64)))
        self._keys, index = np.unique(keys, return_inverse=True)
        self._counts = _summed(index, np.concatenate((self._counts, times)))
        self._sums = _summed(index, np.concatenate((self._sums, times * values)))

    @property
    def total(self) -> int:
        """Number of values."""
        return int(self._counts.sum())

    def above(self, limit: float) -> int:
        """Return the number of values above a limit, accurate to 0.01 % of the limit."""
        return int(self._counts[self._values > limit].sum())

    def sum_above(self, limit: float) -> float:
        """Return the sum of the values above a limit, accurate to 0.01 % of the limit."""
        return float(self._sums[self._values > limit].sum())

    def quantile(self, share: float) -> float:
        """Return the quantile at a share of 0 to 1; NaN without values."""
        return _quantile(self._values, self._counts, share)

    def spread(self) -> float:
        """Return the standard deviation estimated from the median absolute deviation."""
        distance = np.abs(self._values - self.quantile(_HALF))
        order = np.argsort(distance)
        return _MAD_TO_STD * _quantile(distance[order], self._counts[order], _HALF)

    def densest(self) -> float:
        """Return the mean of the shortest half of the values; NaN without values."""
        if not len(self._keys):
            return float("nan")
        values = self._values
        reached = np.concatenate(([0.0], np.cumsum(self._counts)))
        last = np.searchsorted(reached, reached[:-1] + _HALF * reached[-1])
        fits = np.flatnonzero(last < len(reached))
        widths = values[last[fits] - 1] - values[fits]
        first = int(fits[np.argmin(widths)])
        half = slice(first, int(last[first]))
        return float(self._sums[half].sum() / self._counts[half].sum())

    def share_near(self, value: float, tolerance: float) -> float:
        """Return the share of values within a relative tolerance of a value."""
        near = np.abs(self._values - value) <= tolerance * value
        return float(self._counts[near].sum() / max(self._counts.sum(), 1))

    def missing_samples(self, period: float, longest: float) -> int:
        """Return how many samples are missing in steps of several periods, up to ``longest``."""
        values = self._values
        counted = values < longest
        skipped = np.maximum(np.round(values[counted] / period) - 1, 0)
        return int((skipped * self._counts[counted]).sum())

    @property
    def _values(self) -> Array:
        return self._sums / self._counts


def _summed(index: Indices, values: Array) -> Array:
    return np.asarray(np.bincount(index, values), np.float64)


def _quantile(ordered: Array, counts: Array, share: float) -> float:
    if not len(ordered):
        return float("nan")
    reached = np.cumsum(counts)
    return float(ordered[int(np.searchsorted(reached, share * reached[-1]))])
