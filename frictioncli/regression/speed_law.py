r"""What friction has of the speed beside Coulomb friction and the root of equation (16).

Friction that falls at low speeds, or grows faster than the root, goes along a motion as its rate of
change does: what a law of the speed lacks is taken for a delay of the torque or for inertia. So the
law is free. It is a combination of :math:`e^{-|v|/s_k}` with scales that span the speeds, without
what a constant and the root of the speed have of it in these rows: these keep their meaning.
"""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array

_SCALES = 5
"""Exponentials of which the law is made."""

_LEAST_PART = 0.015
"""Combinations of exponentials with a smaller RMS are not told apart by the speeds."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SpeedLaw:
    """Functions of the speed of unit RMS, orthogonal to a constant and to the root.

    Attributes
    ----------
    scales : tuple of float
        Speeds over which the exponentials fall. [deg/s]
    weights : tuple of tuple of float
        For each function those of the constant, of the root and of the exponentials.
    """

    scales: tuple[float, ...] = ()
    weights: tuple[tuple[float, ...], ...] = ()

    @classmethod
    def of(cls, speed: Array) -> "SpeedLaw":
        """Return the law of rows.

        Parameters
        ----------
        speed : ndarray, shape (rows,)
            Their speeds. [deg/s]

        Examples
        --------
        >>> speed = np.linspace(1.0, 100.0, 500)
        >>> columns = SpeedLaw.of(speed).columns(speed)
        >>> stribeck = np.exp(-((speed / 9.0) ** 2))
        >>> known = np.column_stack([np.ones(500), np.sqrt(speed), columns])
        >>> left = stribeck - known @ np.linalg.lstsq(known, stribeck, rcond=None)[0]
        >>> bool(np.sqrt(np.mean(left**2)) < 0.03)
        True
        """
        if not len(speed):
            return NO_LAW
        scales = np.geomspace(max(float(speed.min()), 1e-3), max(float(speed.max()), 2e-3), _SCALES)
        base, falling = _terms(speed, scales)
        beside = np.linalg.lstsq(base, falling, rcond=None)[0]
        left = falling - base @ beside
        _, size, parts = np.linalg.svd(left, full_matrices=False)
        size /= np.sqrt(len(speed))
        kept = size > _LEAST_PART
        own = parts[kept].T / size[kept]
        weights = np.vstack([-beside @ own, own])
        return cls(scales=tuple(scales.tolist()), weights=tuple(map(tuple, weights.T.tolist())))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the coefficients."""
        return tuple(f"speed_{number + 1}" for number in range(len(self.weights)))

    def columns(self, speed: Array) -> Array:
        """Return the functions at some speeds.

        Parameters
        ----------
        speed : ndarray, shape (rows,)
            The speeds. [deg/s]

        Returns
        -------
        ndarray, shape (rows, functions)
            In the order of the names.
        """
        if not self.weights:
            return np.empty((len(speed), 0))
        return np.hstack(_terms(speed, np.array(self.scales))) @ np.array(self.weights).T


NO_LAW = SpeedLaw()
"""A law without functions."""


def _terms(speed: Array, scales: Array) -> tuple[Array, Array]:
    """Return a constant and the root of the speed, and its exponentials."""
    base = np.column_stack([np.ones(len(speed)), np.sqrt(speed)])
    return base, np.exp(-speed[:, np.newaxis] / scales)
