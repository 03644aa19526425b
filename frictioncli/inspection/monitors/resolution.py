"""Resolution of a channel: the step between its values where they lie on a grid."""

from dataclasses import dataclass, field

import numpy as np

from frictioncli.arrays import Array

_ENOUGH = 20_000
"""Distinct values that are used at most; far fewer show a step."""

_ROUNDING = 1e-9
"""Values this close together, as a share of the largest, are the same."""

_CANDIDATES = (0.0, 0.01, 0.05, 0.2)
_OFF_GRID = 0.01
_ON_GRID = 0.97
_BY_CHANCE = 2 * _OFF_GRID
_FEWEST = 3


@dataclass(frozen=True, slots=True)
class Resolution:
    """Resolution of a channel.

    Attributes
    ----------
    step : float
        Step between its values, in the unit of the channel.
    levels : int
        Distinct values, 20,000 at most.
    certainty : float
        Probability that this many values do not lie on the grid by chance. [-]
    """

    step: float
    levels: int
    certainty: float


@dataclass(slots=True)
class ResolutionMonitor:
    """Watches the values of one channel: their range and their grid."""

    lowest: float = np.inf
    highest: float = -np.inf
    _values: Array = field(default_factory=lambda: np.empty(0))
    _grid: Resolution | None = None
    _n_evaluated: int = 0

    def update(self, values: Array) -> None:
        """Add the next values; NaN are ignored."""
        values = values[np.isfinite(values)]
        if not len(values):
            return
        self.lowest = min(self.lowest, float(values.min()))
        self.highest = max(self.highest, float(values.max()))
        if len(self._values) < _ENOUGH:
            self._values = np.unique(np.concatenate((self._values, values)))

    def grid(self) -> Resolution | None:
        """Return the resolution; None where the values lie on no grid."""
        if self._n_evaluated != len(self._values):
            self._grid, self._n_evaluated = find_grid(self._values), len(self._values)
        return self._grid


def find_grid(values: Array) -> Resolution | None:
    """Return the step of which all differences of values are multiples; None without one.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Distinct values, ascending.

    Examples
    --------
    >>> import numpy as np
    >>> find_grid(np.array([0.0, 0.5, 1.0, 2.5])).step
    0.5
    """
    if len(values) < _FEWEST:
        return None
    steps = np.diff(values)
    steps = steps[steps > _ROUNDING * max(abs(values[0]), abs(values[-1]))]
    if len(steps) + 1 < _FEWEST:
        return None
    candidates = {float(np.quantile(steps, share, method="lower")) for share in _CANDIDATES}
    for candidate in sorted(candidates, reverse=True):
        step, share = _fitted(values - values[0], candidate)
        if share >= _ON_GRID:
            levels = len(steps) + 1
            return Resolution(step, levels, share * (1 - _BY_CHANCE ** (levels - 2)))
    return None


def _fitted(values: Array, step: float) -> tuple[float, float]:
    """Return the step fitted from a first guess, and the share of values on its grid."""
    with np.errstate(over="ignore", invalid="ignore"):  # damaged cells may be of any size
        numbers = np.round(values / step)
        fitted = float(numbers @ values / (numbers @ numbers))
        off = np.abs(values / fitted - np.round(values / fitted))
        return fitted, float(np.mean(off < _OFF_GRID))
