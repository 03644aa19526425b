r"""Noise of consecutive rows as an autoregressive process, and its whitening.

Least squares is efficient, and its residuals comparable, where the noise of rows is independent.
The noise :math:`e_i` of filtered torques is not: it is predicted from the rows before by

.. math:: e_i = \sum_{k=1}^{p} \phi_k e_{i-k} + \varepsilon_i ,

and both sides of every equation lose what the rows before predict [1]_.

References
----------
.. [1] P. J. Brockwell and R. A. Davis, Time Series: Theory and Methods, 1991,
   doi:10.1007/978-1-4419-0320-4, section 5.2 (recursion of Durbin and Levinson).
"""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Numbers

_MOST_ORDER = 6
"""Greatest order of the process: 0.3 s of noise."""


@dataclass(frozen=True, slots=True)
class Whitening:
    """An autoregressive process, with the predictions of all smaller orders.

    Attributes
    ----------
    predictors : tuple of ndarray
        Coefficients of orders 0, 1, ... p; entry k has shape (k,), of the nearest row first.
    deviations : tuple of float
        Standard deviation of the noise that remains, by order. [torque unit]
    """

    predictors: tuple[Array, ...]
    deviations: tuple[float, ...]

    @property
    def order(self) -> int:
        """Order of the process."""
        return len(self.predictors) - 1

    def apply(self, values: Array, place: Numbers) -> Array:
        """Return values less what the rows before predict, over the deviation that remains.

        Parameters
        ----------
        values : ndarray, shape (rows, ...)
            Columns or right-hand side of the equations.
        place : ndarray of int, shape (rows,)
            Number of rows before, without a gap; the first ones use smaller orders.
        """
        order = np.minimum(place, self.order)
        shape = (-1, *([1] * (values.ndim - 1)))
        white = values.copy()
        for lag in range(1, self.order + 1):
            of_order = [
                predictor[lag - 1] if lag <= len(predictor) else 0.0
                for predictor in self.predictors
            ]
            coefficient = np.array(of_order)[order[lag:]]
            white[lag:] -= coefficient.reshape(shape) * values[:-lag]
        white /= np.array(self.deviations)[order].reshape(shape)
        return np.asarray(white)


def places(move: Numbers, number: Numbers) -> Numbers:
    """Return how many rows of the same move precede each one without a gap.

    Parameters
    ----------
    move, number : ndarray of int, shape (rows,)
        Move of each row, and its place in the recording.

    Examples
    --------
    >>> import numpy as np
    >>> places(np.array([0, 0, 0, 1]), np.array([4, 5, 7, 8])).tolist()
    [0, 1, 0, 0]
    """
    starts = np.ones(len(move), dtype=bool)
    starts[1:] = (np.diff(move) != 0) | (np.diff(number) != 1)
    index = np.arange(len(move))
    return np.asarray(index - np.maximum.accumulate(np.where(starts, index, 0)))


def whitening(residual: Array, place: Numbers) -> Whitening:
    """Return the autoregressive process of residuals, its order by Schwarz's criterion.

    Parameters
    ----------
    residual : ndarray, shape (rows,)
        Residuals of a fit. [torque unit]
    place : ndarray of int, shape (rows,)
        As :func:`places` gives it.

    Examples
    --------
    >>> import numpy as np
    >>> noise = np.random.default_rng(0).standard_normal(5000)
    >>> noise[1:] += noise[:-1]
    >>> found = whitening(noise, np.arange(5000))
    >>> round(float(np.var(found.apply(noise, np.arange(5000)))), 1)
    1.0
    """
    rows = len(residual)
    variance = max(float(np.mean(np.square(residual))), 1e-300)
    covariance = [variance]
    for lag in range(1, _MOST_ORDER + 1):
        later = np.flatnonzero(place >= lag)
        if len(later) < 10 * _MOST_ORDER:
            break
        covariance.append(float(residual[later] @ residual[later - lag]) / len(later))
    predictors, variances = _durbin_levinson(np.array(covariance))
    scores = [
        rows * np.log(left) + order * np.log(rows) for order, left in enumerate(variances.tolist())
    ]
    order = int(np.argmin(scores))
    return Whitening(
        tuple(predictors[: order + 1]), tuple(np.sqrt(variances[: order + 1]).tolist())
    )


def _durbin_levinson(covariance: Array) -> tuple[list[Array], Array]:
    """Return predictors and remaining variances of all orders from autocovariances."""
    predictors = [np.empty(0)]
    variances = [covariance[0]]
    for order in range(1, len(covariance)):
        last = predictors[-1]
        partial = (covariance[order] - last @ covariance[order - 1 : 0 : -1]) / variances[-1]
        partial = float(np.clip(partial, -0.99, 0.99))
        predictors.append(np.append(last - partial * last[::-1], partial))
        variances.append(variances[-1] * (1 - partial**2))
    return predictors, np.array(variances)
