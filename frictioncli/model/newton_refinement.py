"""Newton refinement of the minimum of a summary to that of all equations."""

import numpy as np

from frictioncli.arrays import Array
from frictioncli.model.equations import COEFFICIENTS, Equations, jacobian
from frictioncli.model.friction import FrictionParameters

_STEPS = 12
"""Greatest number of steps; each reduces the distance a hundredfold, so that three are usual."""

_SMALL_STEP = 1e-7
"""The steps end where the next one would be this small. [standard errors]"""


def refined_minimum(
    equations: Equations, summary: Equations, terms: tuple[str, ...], start: FrictionParameters
) -> tuple[FrictionParameters, float] | None:
    """Return the minimum of all equations near that of their summary, and its sum of squares.

    Newton's method with the gradient of all equations and the Hessian of the summary. An inexact
    Hessian needs more steps but leads to the same minimum.

    Parameters
    ----------
    equations : Equations
        Weighted equations.
    summary : Equations
        Few equations with nearly the same sum of squares.
    terms : tuple of str
        Coefficients that are fitted, with gamma.
    start : FrictionParameters
        Minimum of the summary.

    Returns
    -------
    (FrictionParameters, float) or None
        None where the minimum is at a bound, or the steps do not converge.
    """
    names = (*terms, "delta")
    values = np.array([getattr(start, name) for name in names])
    if (values <= 0).any():
        return None
    normal, hessian = _hessian(summary, terms, start)
    size = np.sqrt(np.diag(normal))
    scaled = hessian / np.outer(size, size)
    if np.linalg.eigvalsh(scaled)[0] <= 0:
        return None
    rounding = 1e-13 * float(np.linalg.norm(summary.friction))
    previous = 0.0
    for _ in range(_STEPS):
        gradient, squares = _negative_gradient(equations, terms, _parameters(names, values))
        step = np.linalg.solve(scaled, gradient / size) / size
        values = values + step
        # length in units of the standard errors of the modelled friction
        length = float(np.sqrt(step @ normal @ step))
        if (values <= 0).any() or (previous and length > previous):
            return None
        next_length = length * length / previous if previous else length
        if next_length <= max(_SMALL_STEP * np.sqrt(squares / len(equations)), rounding):
            return _parameters(names, values), squares - float(gradient @ step)
        previous = length
    return None


def _parameters(names: tuple[str, ...], values: Array) -> FrictionParameters:
    found = dict.fromkeys(COEFFICIENTS, 0.0) | dict(zip(names, values.tolist(), strict=True))
    return FrictionParameters(**found)


def _negative_gradient(
    equations: Equations, terms: tuple[str, ...], at: FrictionParameters
) -> tuple[Array, float]:
    """Return the negative gradient of half the sum of squares, and the sum of squares."""
    gradient = np.zeros(len(terms) + 1)
    squares = 0.0
    for chunk in equations.chunks():
        columns = chunk.columns(terms, at.delta)
        residual = chunk.friction.copy()
        for term, column in zip(terms, columns, strict=True):
            residual -= getattr(at, term) * column
        columns.append(-at.gamma * chunk.temperature * columns[terms.index("gamma")])
        gradient += [column @ residual for column in columns]
        squares += float(residual @ residual)
    return gradient, squares


def _hessian(
    summary: Equations, terms: tuple[str, ...], at: FrictionParameters
) -> tuple[Array, Array]:
    """Return the normal matrix at a minimum, and the Hessian of half the sum of squares."""
    derivatives = jacobian(summary, terms, at).T
    coefficients = np.array([getattr(at, term) for term in terms])
    residual = summary.friction - coefficients @ derivatives[:-1]
    normal = derivatives @ derivatives.T
    hessian, gamma = normal.copy(), terms.index("gamma")
    hessian[-1, -1] += (summary.temperature * derivatives[-1]) @ residual
    hessian[-1, gamma] -= derivatives[-1] @ residual / at.gamma
    hessian[gamma, -1] = hessian[-1, gamma]
    return normal, hessian
