"""Search for shape parameters off their grid: downhill simplex in the unit cube."""

from collections.abc import Callable

import numpy as np
from scipy.optimize import minimize

from frictioncli.arrays import Array


def simplex_minimum(
    cost: Callable[[Array], float],
    start: Array,
    step: Array,
    *,
    evaluations: int,
    tolerance: tuple[float, float],
) -> tuple[Array, float]:
    """Return the place of the least cost in the unit cube that a simplex finds, and that cost.

    Parameters
    ----------
    cost : callable
        Of a place, shape (axes,).
    start : ndarray, shape (axes,)
        Place to begin with, from 0 to 1 along each axis.
    step : ndarray, shape (axes,)
        Size of the first simplex along each axis, towards the farther end.
    evaluations : int
        Greatest number of evaluations per axis.
    tolerance : (float, float)
        Differences of place and of cost at which the search ends.

    Examples
    --------
    >>> place, least = simplex_minimum(
    ...     lambda at: (at[0] - 0.3) ** 2,
    ...     np.array([0.5]),
    ...     np.array([0.1]),
    ...     evaluations=50,
    ...     tolerance=(1e-4, 1e-8),
    ... )
    >>> round(float(place[0]), 3)
    0.3
    """
    found = minimize(
        cost,
        start,
        method="Nelder-Mead",
        bounds=[(0.0, 1.0)] * len(start),
        options={
            "initial_simplex": np.vstack(
                [start, start + np.diag(np.where(start > 0.5, -step, step))]
            ),
            "maxfev": evaluations * len(start),
            "xatol": tolerance[0],
            "fatol": tolerance[1],
        },
    )
    return found.x, float(found.fun)
