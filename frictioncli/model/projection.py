"""Bounded variable projection: equation (16) is linear in all parameters but delta.

For a given delta the best non-negative coefficients follow from a small linear problem, so the fit
is a search over one number. It is scanned over its whole range first: the global minimum is found
from the data alone, without a starting value. Many equations are searched in a summary of few, and
settled on all of them.

References
----------
.. [1] G. H. Golub and V. Pereyra, "The differentiation of pseudo-inverses and nonlinear least
   squares problems whose variables separate," SIAM J. Numer. Anal. 10(2), 1973,
   doi:10.1137/0710036.
"""

import numpy as np
from scipy.optimize import brentq, nnls

from frictioncli.model.equations import COEFFICIENTS, Array, Equations, jacobian, summarised
from frictioncli.model.friction import FrictionParameters
from frictioncli.model.settling import settled

DELTA_BOUNDS = (1e-3, 0.3)
"""Range searched for delta: friction halves in 700 °C at one end, in 2.3 °C at the other. [1/°C]"""

_SCAN = np.geomspace(*DELTA_BOUNDS, 64)

_MANY = 2_000
"""More equations than this are searched in their summary."""

_SUMMARY_ERROR = 1e-4
"""Valleys that differ less than so much in the summary are told apart on all equations."""


def project(
    equations: Equations, terms: tuple[str, ...], delta: float
) -> tuple[FrictionParameters, float]:
    """Return the best non-negative coefficients for a given delta, and their misfit.

    Parameters
    ----------
    equations : Equations
        Weighted equations.
    terms : tuple of str
        Those of :data:`COEFFICIENTS` that are fitted; the others are zero.
    delta : float
        Rate of the fall with temperature. [1/°C]

    Returns
    -------
    FrictionParameters, float
        The coefficients with this delta, and the sum of squared weighted residuals.
    """
    coefficients, misfit = _non_negative(_triangles(equations, terms, np.array([delta]))[0])
    found = dict.fromkeys(COEFFICIENTS, 0.0) | dict(zip(terms, coefficients, strict=True))
    return FrictionParameters(**found, delta=delta), misfit


def minimise(equations: Equations, terms: tuple[str, ...]) -> FrictionParameters:
    """Return the parameters of the global least-squares minimum within the physical bounds.

    Parameters
    ----------
    equations : Equations
        Weighted equations.
    terms : tuple of str
        Coefficients that are fitted. Delta is fitted with gamma, and zero without.
    """
    if "gamma" not in terms:
        return project(equations, terms, 0.0)[0]
    if len(equations) <= _MANY:
        lows = [_lowest(equations, terms, *valley) for valley in _valleys(equations, terms)]
    else:
        lows = _lowest_of_many(equations, terms)
    return min(lows, key=lambda low: low[1])[0]


def _lowest_of_many(
    equations: Equations, terms: tuple[str, ...]
) -> list[tuple[FrictionParameters, float]]:
    """Return the minima, and their misfits, in the valleys that their summary shows as deepest."""
    summary = summarised(equations)
    valleys = _valleys(summary, terms)
    lows = [_lowest(summary, terms, *valley) for valley in valleys]
    deep = min(misfit for _, misfit in lows) * (1 + _SUMMARY_ERROR)
    found = []
    for (low, misfit), (start, end) in zip(lows, valleys, strict=True):
        if misfit <= deep:
            near = settled(equations, summary, terms, low)
            if near is None or not start <= near[0].delta <= end:
                near = _lowest(equations, terms, start, end)
            found.append(near)
    return found


def _valleys(equations: Equations, terms: tuple[str, ...]) -> list[tuple[float, float]]:
    """Return the ranges of delta in which the misfit has a local minimum."""
    triangles = _triangles(equations, terms, _SCAN)
    misfits = np.array([_non_negative(triangle)[1] for triangle in triangles])
    padded = np.concatenate([[np.inf], misfits, [np.inf]])
    lows = np.flatnonzero((misfits < padded[:-2]) & (misfits <= padded[2:]))
    last = len(_SCAN) - 1
    return [(float(_SCAN[max(i - 1, 0)]), float(_SCAN[min(i + 1, last)])) for i in lows.tolist()]


def _lowest(
    equations: Equations, terms: tuple[str, ...], low: float, high: float
) -> tuple[FrictionParameters, float]:
    """Return the minimum in a valley, and its misfit.

    It is where the slope over delta crosses zero: a search by the misfit itself would be blind
    within the square root of its rounding.
    """

    def slope(delta: float) -> float:
        parameters, _ = project(equations, terms, delta)
        derivatives = jacobian(equations, terms, parameters).T
        coefficients = np.array([getattr(parameters, term) for term in terms])
        # the coefficients are the best ones, so that only delta's own effect remains
        return -float(derivatives[-1] @ (equations.friction - coefficients @ derivatives[:-1]))

    if slope(low) >= 0:
        return project(equations, terms, low)
    if slope(high) <= 0:
        return project(equations, terms, high)
    return project(equations, terms, brentq(slope, low, high, xtol=1e-15, rtol=1e-14))


def _triangles(equations: Equations, terms: tuple[str, ...], deltas: Array) -> Array:
    """Return the QR triangles of coefficients' columns and right-hand side for several deltas."""
    system = np.empty((len(deltas), len(terms) + 1, len(equations)))
    for rows, delta in zip(system, deltas.tolist(), strict=True):
        rows[:-1] = equations.columns(terms, delta)
        rows[-1] = equations.friction
    return np.asarray(np.linalg.qr(np.swapaxes(system, 1, 2), mode="r"))


def _non_negative(triangle: Array) -> tuple[Array, float]:
    """Return the non-negative solution of ``triangle[:, :-1] x = triangle[:, -1]``, its misfit."""
    size = np.maximum(np.linalg.norm(triangle[:, :-1], axis=0), 1e-300)
    coefficients, norm = nnls(triangle[:, :-1] / size, triangle[:, -1])
    return coefficients / size, float(norm) ** 2
