"""Bounded variable projection: equation (16) is linear in all parameters but delta.

For a given delta the best non-negative coefficients follow from a small linear problem, so the fit
is a search over one number. It is scanned over its whole range first: the global minimum is found
from the data alone, without a starting value.

References
----------
.. [1] G. H. Golub and V. Pereyra, "The differentiation of pseudo-inverses and nonlinear least
   squares problems whose variables separate," SIAM J. Numer. Anal. 10(2), 1973,
   doi:10.1137/0710036.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar, nnls

from frictioncli.model.friction import FrictionParameters

Array = NDArray[np.float64]

COEFFICIENTS = ("tau_c", "alpha", "beta", "gamma")
"""The parameters in which equation (16) is linear, in the order used throughout."""

DELTA_BOUNDS = (1e-3, 0.3)
"""Range searched for delta: friction halves in 700 °C at one end, in 2.3 °C at the other. [1/°C]"""

_SCAN = np.geomspace(*DELTA_BOUNDS, 64)


@dataclass(frozen=True, slots=True, kw_only=True)
class Equations:
    """Weighted equations of a fit; each row is already divided by its standard deviation.

    Attributes
    ----------
    constant, squared_load, root_speed : ndarray, shape (rows,)
        What tau_c, alpha and beta multiply; gamma multiplies
        ``root_speed * exp(-delta * temperature)``.
    temperature : ndarray, shape (rows,)
        Temperature; any finite number where ``root_speed`` is zero. [°C]
    friction : ndarray, shape (rows,)
        Right-hand side.
    """

    constant: Array
    squared_load: Array
    root_speed: Array
    temperature: Array
    friction: Array

    def columns(self, terms: tuple[str, ...], delta: float) -> Array:
        """Return the columns of the linear problem for a given delta, shape (rows, terms)."""
        column = {
            "tau_c": self.constant,
            "alpha": self.squared_load,
            "beta": self.root_speed,
            "gamma": self.root_speed * np.exp(-delta * self.temperature),
        }
        return np.column_stack([column[term] for term in terms])


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
    system = np.column_stack([equations.columns(terms, delta), equations.friction])
    triangle = np.asarray(np.linalg.qr(system, mode="r"))
    size = np.maximum(np.linalg.norm(triangle[:, :-1], axis=0), 1e-300)
    coefficients, norm = nnls(triangle[:, :-1] / size, triangle[:, -1])
    found = dict.fromkeys(COEFFICIENTS, 0.0) | dict(zip(terms, coefficients / size, strict=True))
    return FrictionParameters(**found, delta=delta), float(norm) ** 2


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
    costs = np.array([project(equations, terms, delta)[1] for delta in _SCAN])
    padded = np.concatenate([[np.inf], costs, [np.inf]])
    basins = np.flatnonzero((costs <= padded[:-2]) & (costs <= padded[2:]))
    best: tuple[FrictionParameters, float] | None = None
    for i in basins.tolist():
        low, high = _SCAN[max(i - 1, 0)], _SCAN[min(i + 1, len(_SCAN) - 1)]
        search = minimize_scalar(
            lambda delta: project(equations, terms, delta)[1],
            bounds=(low, high),
            method="bounded",
            options={"xatol": 1e-9},
        )
        candidate = project(equations, terms, float(search.x))
        if best is None or candidate[1] < best[1]:
            best = candidate
    assert best is not None  # a finite scan has a lowest point
    return best[0]


def jacobian(equations: Equations, terms: tuple[str, ...], parameters: FrictionParameters) -> Array:
    """Return the derivatives of the weighted model by ``terms`` and, with gamma, by delta."""
    columns = equations.columns(terms, parameters.delta)
    if "gamma" not in terms:
        return columns
    by_delta = -parameters.gamma * equations.temperature * columns[:, terms.index("gamma")]
    return np.column_stack([columns, by_delta])
