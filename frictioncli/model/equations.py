"""Weighted equations of a fit of equation (16), their derivatives and their summary."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.model.friction import FrictionParameters

COEFFICIENTS = ("tau_c", "alpha", "beta", "gamma")
"""The parameters in which equation (16) is linear, in the order used throughout."""

_CACHED = 1 << 13
"""Equations of one chunk, few enough for the processor's cache."""

_BINS = 256
"""Temperature bins of a summary: 0.2 °C each over a span of 50 °C."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Equations:
    """Weighted equations of a fit; each row is already divided by its standard deviation.

    Attributes
    ----------
    constant, squared_load, root_speed : ndarray, shape (rows,)
        Columns of tau_c, alpha and beta; the column of gamma is
        ``root_speed * exp(-delta * temperature)``.
    temperature : ndarray, shape (rows,)
        Temperature; any finite number where ``root_speed`` is zero. [°C]
    friction : ndarray, shape (rows,)
        Right-hand side: friction torque over its standard deviation.
    """

    constant: Array
    squared_load: Array
    root_speed: Array
    temperature: Array
    friction: Array

    def __len__(self) -> int:
        return len(self.friction)

    def columns(self, terms: tuple[str, ...], delta: float) -> list[Array]:
        """Return the column of each coefficient for a given delta, shape (rows,) each.

        Parameters
        ----------
        terms : tuple of str
            Those of :data:`COEFFICIENTS` that are fitted.
        delta : float
            Rate of the decrease with temperature. [1/°C]
        """
        column = {
            "tau_c": self.constant,
            "alpha": self.squared_load,
            "beta": self.root_speed,
            "gamma": self.root_speed * np.exp(-delta * self.temperature),
        }
        return [column[term] for term in terms]

    def chunks(self) -> Iterator["Equations"]:
        """Yield the equations in chunks that fit into the processor's cache."""
        for begin in range(0, len(self), _CACHED):
            rows = slice(begin, begin + _CACHED)
            yield Equations(
                constant=self.constant[rows],
                squared_load=self.squared_load[rows],
                root_speed=self.root_speed[rows],
                temperature=self.temperature[rows],
                friction=self.friction[rows],
            )


def jacobian(equations: Equations, terms: tuple[str, ...], parameters: FrictionParameters) -> Array:
    """Return the derivatives of the weighted model by ``terms`` and, with gamma, by delta.

    Parameters
    ----------
    equations : Equations
        Weighted equations.
    terms : tuple of str
        Those of :data:`COEFFICIENTS` that are fitted.
    parameters : FrictionParameters
        Where the derivatives are taken.

    Returns
    -------
    ndarray, shape (rows, parameters)
        One column per parameter, contiguous in memory.
    """
    columns = equations.columns(terms, parameters.delta)
    if "gamma" in terms:
        decaying = columns[terms.index("gamma")]
        columns.append(-parameters.gamma * equations.temperature * decaying)
    return np.stack(columns).T


def summarised(equations: Equations) -> Equations:
    """Return few equations with nearly the same sum of squared residuals for all parameters.

    The sum of squares consists of inner products of the columns and the right-hand side. Only the
    column of gamma depends on delta, by a factor of the temperature; so products with root_speed
    are summed in bins of temperature, each of which gives one equation. Three more equations,
    without root_speed, complete the products of the other columns. The only approximation is the
    width of the bins.

    Parameters
    ----------
    equations : Equations
        Weighted equations.

    Returns
    -------
    Equations
        At most 259 equations.
    """
    low, span = float(equations.temperature.min()), float(np.ptp(equations.temperature))
    # the highest temperature belongs to the last bin
    scale = _BINS * (1 - 1e-9) / max(span, 1e-9)
    sums, products = np.zeros((5, _BINS)), np.zeros((3, 3))
    for chunk in equations.chunks():
        code = ((chunk.temperature - low) * scale).astype(np.intp)
        columns = np.stack(
            [
                chunk.constant,
                chunk.squared_load,
                chunk.friction,
                chunk.root_speed,
                chunk.root_speed * chunk.temperature,
            ]
        )
        products += columns[:3] @ columns[:3].T
        sums += [np.bincount(code, chunk.root_speed * column, _BINS) for column in columns]
    *shared, squares, weighted_temperature = sums[:, sums[3] > 0]
    root_speed = np.sqrt(squares)
    bins = np.stack(shared) / root_speed
    rest = _rows_with_products(products - bins @ bins.T, products)
    constant, squared_load, friction = np.hstack([bins, rest])
    return Equations(
        constant=constant,
        squared_load=squared_load,
        root_speed=np.append(root_speed, np.zeros(len(rest))),
        temperature=np.append(weighted_temperature / squares, np.full(len(rest), low)),
        friction=friction,
    )


def _rows_with_products(products: Array, scale: Array) -> Array:
    """Return columns with given inner products, shape (n, n).

    Parameters
    ----------
    products : ndarray, shape (n, n)
        The inner products; negative eigenvalues, which are rounding errors, count as zero.
    scale : ndarray, shape (n, n)
        Inner products of the same units, by whose diagonal they are scaled.
    """
    size = np.sqrt(np.maximum(np.diag(scale), 1e-300))
    values, vectors = np.linalg.eigh(products / np.outer(size, size))
    return np.asarray(size[:, np.newaxis] * vectors * np.sqrt(np.maximum(values, 0.0)))
