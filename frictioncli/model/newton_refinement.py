"""The last steps to the minimum of many equations, from that of their summary."""

import numpy as np

from frictioncli.arrays import Array
from frictioncli.model.equations import COEFFICIENTS, Equations, jacobian
from frictioncli.model.friction import FrictionParameters

_STEPS = 12
"""Each step divides what is left by a hundred or more; two or three are usual."""

_ENOUGH = 1e-7
"""The steps end where the next one would be this small. [standard errors]"""


def settled(
    equations: Equations, summary: Equations, terms: tuple[str, ...], start: FrictionParameters
) -> tuple[FrictionParameters, float] | None:
    """Return the minimum of all equations near that of their summary, and its misfit.

    The steps are those of Newton's method with the slopes of all equations and the curvature of
    the summary. A wrong curvature makes more steps of it but no other minimum.

    Parameters
    ----------
    equations : Equations
        Weighted equations.
    summary : Equations
        Few equations with nearly the same misfit.
    terms : tuple of str
        Coefficients that are fitted, with gamma.
    start : FrictionParameters
        Minimum of the summary.

    Returns
    -------
    (FrictionParameters, float) or None
        None where the minimum is at a bound, or the steps do not settle.
    """
    names = (*terms, "delta")
    values = np.array([getattr(start, name) for name in names])
    if (values <= 0).any():
        return None
    normal, curvature = _curvature(summary, terms, start)
    size = np.sqrt(np.diag(normal))
    scaled = curvature / np.outer(size, size)
    if np.linalg.eigvalsh(scaled)[0] <= 0:
        return None
    rounding = 1e-13 * float(np.linalg.norm(summary.friction))
    before = 0.0
    for _ in range(_STEPS):
        slope, misfit = _slope(equations, terms, _parameters(names, values))
        step = np.linalg.solve(scaled, slope / size) / size
        values = values + step
        # how far the modelled friction moves: one sigma is one standard error
        moved = float(np.sqrt(step @ normal @ step))
        if (values <= 0).any() or (before and moved > before):
            return None
        following = moved * moved / before if before else moved
        if following <= max(_ENOUGH * np.sqrt(misfit / len(equations)), rounding):
            return _parameters(names, values), misfit - float(slope @ step)
        before = moved
    return None


def _parameters(names: tuple[str, ...], values: Array) -> FrictionParameters:
    found = dict.fromkeys(COEFFICIENTS, 0.0) | dict(zip(names, values.tolist(), strict=True))
    return FrictionParameters(**found)


def _slope(
    equations: Equations, terms: tuple[str, ...], at: FrictionParameters
) -> tuple[Array, float]:
    """Return the negative slopes of half the misfit over terms and delta, and the misfit."""
    slope = np.zeros(len(terms) + 1)
    misfit = 0.0
    for part in equations.parts():
        columns = part.columns(terms, at.delta)
        residual = part.friction.copy()
        for term, column in zip(terms, columns, strict=True):
            residual -= getattr(at, term) * column
        columns.append(-at.gamma * part.temperature * columns[terms.index("gamma")])
        slope += [column @ residual for column in columns]
        misfit += float(residual @ residual)
    return slope, misfit


def _curvature(
    summary: Equations, terms: tuple[str, ...], at: FrictionParameters
) -> tuple[Array, Array]:
    """Return the normal matrix at a minimum, and the second derivatives of half the misfit."""
    derivatives = jacobian(summary, terms, at).T
    coefficients = np.array([getattr(at, term) for term in terms])
    residual = summary.friction - coefficients @ derivatives[:-1]
    normal = derivatives @ derivatives.T
    curvature, gamma = normal.copy(), terms.index("gamma")
    curvature[-1, -1] += (summary.temperature * derivatives[-1]) @ residual
    curvature[-1, gamma] -= derivatives[-1] @ residual / at.gamma
    curvature[gamma, -1] = curvature[-1, gamma]
    return normal, curvature
