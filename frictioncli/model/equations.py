"""The weighted equations of a fit, their derivatives, and their summary where they are many."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.model.friction import FrictionParameters

COEFFICIENTS = ("tau_c", "alpha", "beta", "gamma")
"""The parameters in which equation (16) is linear, in the order used throughout."""

_CACHED = 1 << 13

_BINS = 256
"""Bins of temperature in a summary: of 50 °C, 0.2 °C each."""


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

    def __len__(self) -> int:
        return len(self.friction)

    def columns(self, terms: tuple[str, ...], delta: float) -> list[Array]:
        """Return what each of the coefficients multiplies for a given delta."""
        column = {
            "tau_c": self.constant,
            "alpha": self.squared_load,
            "beta": self.root_speed,
            "gamma": self.root_speed * np.exp(-delta * self.temperature),
        }
        return [column[term] for term in terms]

    def parts(self) -> Iterator["Equations"]:
        """Yield the equations in parts that stay in the processor's cache while they are used."""
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

    The shape is (rows, parameters), with the rows of one parameter side by side in memory.
    """
    columns = equations.columns(terms, parameters.delta)
    if "gamma" in terms:
        falling = columns[terms.index("gamma")]
        columns.append(-parameters.gamma * equations.temperature * falling)
    return np.stack(columns).T


def summarised(equations: Equations) -> Equations:
    """Return few equations with nearly the same misfit for all parameters.

    A misfit is made of sums of products of the columns and the right-hand side. Only root_speed
    changes with delta, by a factor of the temperature; so its products are summed in bins of
    temperature, each of which is one equation of the result. Three more, without root_speed, bring
    the products of the others to their whole sums. What is lost is the width of the bins.
    """
    low, span = float(equations.temperature.min()), float(np.ptp(equations.temperature))
    # the warmest equation belongs to the last bin
    scale = _BINS * (1 - 1e-9) / max(span, 1e-9)
    sums, whole = np.zeros((5, _BINS)), np.zeros((3, 3))
    for part in equations.parts():
        code = ((part.temperature - low) * scale).astype(np.intp)
        columns = np.stack(
            [
                part.constant,
                part.squared_load,
                part.friction,
                part.root_speed,
                part.root_speed * part.temperature,
            ]
        )
        whole += columns[:3] @ columns[:3].T
        sums += [np.bincount(code, part.root_speed * column, _BINS) for column in columns]
    *shared, squares, heat = sums[:, sums[3] > 0]
    root_speed = np.sqrt(squares)
    bins = np.stack(shared) / root_speed
    rest = _rows_with_products(whole, bins @ bins.T)
    constant, squared_load, friction = np.hstack([bins, rest])
    return Equations(
        constant=constant,
        squared_load=squared_load,
        root_speed=np.append(root_speed, np.zeros(len(rest))),
        temperature=np.append(heat / squares, np.full(len(rest), low)),
        friction=friction,
    )


def _rows_with_products(whole: Array, part: Array) -> Array:
    """Return columns, shape (n, n), whose products are what a part lacks of the whole."""
    size = np.sqrt(np.maximum(np.diag(whole), 1e-300))
    values, vectors = np.linalg.eigh((whole - part) / np.outer(size, size))
    return np.asarray(size[:, np.newaxis] * vectors * np.sqrt(np.maximum(values, 0.0)))
