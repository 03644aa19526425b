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

from frictioncli.arrays import Array
from frictioncli.model.equations import COEFFICIENTS, Equations, jacobian, summarised
from frictioncli.model.friction import FrictionParameters
from frictioncli.model.newton_refinement import settled

DELTA_BOUNDS = (1e-3, 0.3)
"""Range searched for delta: friction halves in 700 °C at one end, in 2.3 °C at the other. [1/°C]"""

_SCAN = np.geomspace(*DELTA_BOUNDS, 64)

_MANY = 2_000
"""More equations than this are searched in their summary."""

_HALVINGS = 50
"""Halvings of a valley's side in search of where it begins to fall."""

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
        lows = [_lowest(equations, terms, *_around(place)) for place in _valleys(equations, terms)]
    else:
        lows = _lowest_of_many(equations, terms)
    return min(lows, key=lambda low: low[1])[0]


def _lowest_of_many(
    equations: Equations, terms: tuple[str, ...]
) -> list[tuple[FrictionParameters, float]]:
    """Return the minima, and their misfits, in the valleys that their summary shows as deepest."""
    summary = summarised(equations)
    places = _valleys(summary, terms)
    lows = [_lowest(summary, terms, *_around(place)) for place in places]
    deep = min(misfit for _, misfit in lows) * (1 + _SUMMARY_ERROR)
    found = []
    for (low, misfit), place in zip(lows, places, strict=True):
        if misfit <= deep:
            start, _, end = _around(place)
            near = settled(equations, summary, terms, low)
            if near is None or not start <= near[0].delta <= end:
                near = _lowest(equations, terms, *_around(_descended(equations, terms, place)))
            found.append(near)
    return found


def _valleys(equations: Equations, terms: tuple[str, ...]) -> list[int]:
    """Return the places in the scan of delta at which the misfit has a local minimum."""
    triangles = _triangles(equations, terms, _SCAN)
    misfits = np.array([_non_negative(triangle)[1] for triangle in triangles])
    padded = np.concatenate([[np.inf], misfits, [np.inf]])
    lows = np.flatnonzero((misfits < padded[:-2]) & (misfits <= padded[2:]))
    return [int(place) for place in lows]


def _around(place: int) -> tuple[float, float, float]:
    """Return the low end, the lowest scanned one and the high end of delta in a valley."""
    low, high = max(place - 1, 0), min(place + 1, len(_SCAN) - 1)
    return float(_SCAN[low]), float(_SCAN[place]), float(_SCAN[high])


def _descended(equations: Equations, terms: tuple[str, ...], place: int) -> int:
    """Return the place in the scan from which the misfit falls to neither side, from a near one."""

    def misfit(at: int) -> float:
        inside = 0 <= at < len(_SCAN)
        return project(equations, terms, float(_SCAN[at]))[1] if inside else np.inf

    here = misfit(place)
    for way in (-1, 1):
        while (beside := misfit(place + way)) < here:
            place, here = place + way, beside
    return place


def _lowest(
    equations: Equations, terms: tuple[str, ...], low: float, middle: float, high: float
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

    way = np.sign(slope(middle))
    near, far = middle, low if way > 0 else high
    there = np.sign(slope(far))
    for _ in range(_HALVINGS if way and near != far else 0):
        if there == -way:
            delta = brentq(slope, min(near, far), max(near, far), xtol=1e-15, rtol=1e-14)
            return project(equations, terms, delta)
        # where gamma is zero the misfit is level: the valley ends before
        between = (near + far) / 2
        here = np.sign(slope(between))
        falls = project(equations, terms, between)[1] < project(equations, terms, near)[1]
        if here == way and falls:
            near = between
        else:
            far, there = between, here
    return project(equations, terms, near)


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
