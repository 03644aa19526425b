r"""Bounded variable projection: equation (16) is linear in all parameters but delta.

For a given delta the best non-negative coefficients follow from a small linear problem, so that the
fit is a search over one number [1]_,

.. math:: \min_\delta \; \min_{c \ge 0} \lVert y - X(\delta)\, c \rVert^2 .

Delta is scanned over its whole range first: the global minimum is found without a starting value.
Many equations are searched in a summary of few, and the minimum is refined on all of them.

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
from frictioncli.model.newton_refinement import refined_minimum

DELTA_BOUNDS = (1e-3, 0.3)
"""Range of delta: viscous friction halves within 700 °C at one end, 2.3 °C at the other. [1/°C]"""

_SCAN = np.geomspace(*DELTA_BOUNDS, 64)

_MANY = 2_000
"""More equations than this are searched in their summary."""

_HALVINGS = 50
"""Bisections in search of where the sum of squares begins to fall."""

_SUMMARY_ERROR = 1e-4
"""Minima of the summary that differ by a smaller share are compared on all equations."""


def project(
    equations: Equations, terms: tuple[str, ...], delta: float
) -> tuple[FrictionParameters, float]:
    """Return the best non-negative coefficients for a given delta, and their sum of squares.

    Parameters
    ----------
    equations : Equations
        Weighted equations.
    terms : tuple of str
        Those of :data:`COEFFICIENTS` that are fitted; the others are zero.
    delta : float
        Rate of the decrease with temperature. [1/°C]

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
        lows = [
            _minimum(equations, terms, *_bracket(place))
            for place in _local_minima(equations, terms)
        ]
    else:
        lows = _minima_of_many(equations, terms)
    return min(lows, key=lambda low: low[1])[0]


def _minima_of_many(
    equations: Equations, terms: tuple[str, ...]
) -> list[tuple[FrictionParameters, float]]:
    """Return the deepest minima of the summary, refined on all equations, with their squares."""
    summary = summarised(equations)
    places = _local_minima(summary, terms)
    lows = [_minimum(summary, terms, *_bracket(place)) for place in places]
    deep = min(misfit for _, misfit in lows) * (1 + _SUMMARY_ERROR)
    found = []
    for (low, misfit), place in zip(lows, places, strict=True):
        if misfit <= deep:
            start, _, end = _bracket(place)
            near = refined_minimum(equations, summary, terms, low)
            if near is None or not start <= near[0].delta <= end:
                near = _minimum(
                    equations, terms, *_bracket(_nearest_local_minimum(equations, terms, place))
                )
            found.append(near)
    return found


def _local_minima(equations: Equations, terms: tuple[str, ...]) -> list[int]:
    """Return the indices in the scan of delta at which the sum of squares has a local minimum."""
    triangles = _triangles(equations, terms, _SCAN)
    misfits = np.array([_non_negative(triangle)[1] for triangle in triangles])
    padded = np.concatenate([[np.inf], misfits, [np.inf]])
    lows = np.flatnonzero((misfits < padded[:-2]) & (misfits <= padded[2:]))
    return [int(place) for place in lows]


def _bracket(place: int) -> tuple[float, float, float]:
    """Return the scanned deltas below, at and above an index."""
    low, high = max(place - 1, 0), min(place + 1, len(_SCAN) - 1)
    return float(_SCAN[low]), float(_SCAN[place]), float(_SCAN[high])


def _nearest_local_minimum(equations: Equations, terms: tuple[str, ...], place: int) -> int:
    """Return the index of the local minimum to which the sum of squares descends from an index."""

    def squares(at: int) -> float:
        scanned = 0 <= at < len(_SCAN)
        return project(equations, terms, float(_SCAN[at]))[1] if scanned else np.inf

    least = squares(place)
    for step in (-1, 1):
        while (following := squares(place + step)) < least:
            place, least = place + step, following
    return place


def _minimum(
    equations: Equations, terms: tuple[str, ...], low: float, middle: float, high: float
) -> tuple[FrictionParameters, float]:
    """Return the minimum within a bracket of delta, and its sum of squares.

    It is the root of the derivative by delta: a search by the sum of squares itself would be exact
    to the square root of the rounding error only.
    """

    def slope(delta: float) -> float:
        parameters, _ = project(equations, terms, delta)
        derivatives = jacobian(equations, terms, parameters).T
        coefficients = np.array([getattr(parameters, term) for term in terms])
        # at the best coefficients only the explicit derivative by delta remains
        return -float(derivatives[-1] @ (equations.friction - coefficients @ derivatives[:-1]))

    sign = np.sign(slope(middle))
    near, far = middle, low if sign > 0 else high
    far_sign = np.sign(slope(far))
    for _ in range(_HALVINGS if sign and near != far else 0):
        if far_sign == -sign:
            delta = brentq(slope, min(near, far), max(near, far), xtol=1e-15, rtol=1e-14)
            return project(equations, terms, delta)
        # where gamma is zero the sum of squares is constant: the minimum lies nearer
        between = (near + far) / 2
        between_sign = np.sign(slope(between))
        falls = project(equations, terms, between)[1] < project(equations, terms, near)[1]
        if between_sign == sign and falls:
            near = between
        else:
            far, far_sign = between, between_sign
    return project(equations, terms, near)


def _triangles(equations: Equations, terms: tuple[str, ...], deltas: Array) -> Array:
    """Return the QR triangles of coefficients' columns and right-hand side for several deltas."""
    system = np.empty((len(deltas), len(terms) + 1, len(equations)))
    for rows, delta in zip(system, deltas.tolist(), strict=True):
        rows[:-1] = equations.columns(terms, delta)
        rows[-1] = equations.friction
    return np.asarray(np.linalg.qr(np.swapaxes(system, 1, 2), mode="r"))


def _non_negative(triangle: Array) -> tuple[Array, float]:
    """Return the solution x >= 0 of ``triangle[:, :-1] x = triangle[:, -1]``, and its squares."""
    size = np.maximum(np.linalg.norm(triangle[:, :-1], axis=0), 1e-300)
    coefficients, norm = nnls(triangle[:, :-1] / size, triangle[:, -1])
    return coefficients / size, float(norm) ** 2
