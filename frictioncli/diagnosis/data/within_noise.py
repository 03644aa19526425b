r"""Noise of angle bins within a pair: correlated along the move, and of another size at each speed.

Torque noise has a memory of some tenths of a second, so that neighbouring bins of a fast move share
it. The correlation of two bins that are passed :math:`\Delta t = |\Delta q| / v` apart is

.. math:: R = (1 - \kappa)\,\delta + \kappa\, e^{-\Delta t/\theta}.

It is estimated from *pure error*, the scatter of neighbouring pairs at one speed about their common
course over the angle: no effect that is the same in these pairs contributes to it [1]_.

References
----------
.. [1] N. R. Draper and H. Smith, *Applied Regression Analysis*, 3rd ed., Wiley, 1998,
   doi:10.1002/9781118625590 (section 2.1: pure error).
"""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array

TIMES = (0.03, 0.06, 0.12, 0.25, 0.5)
"""Correlation times to try. [s]"""

SHARES = (0.25, 0.5, 0.75, 0.9)
"""Correlated shares of the variance to try."""

LEAST_FREEDOM = 60
"""Least number of degrees of freedom of pure error from which it is estimated."""

_RANK = 1e-9


@dataclass(frozen=True, slots=True)
class WithinNoise:
    """Correlation of the noise of angle bins within a pair.

    Attributes
    ----------
    time : float
        Correlation time along the move. [s]
    share : float
        Correlated share of the variance. [1]
    """

    time: float = 1.0
    share: float = 0.0

    def correlation(self, position: Array, speed: float) -> Array:
        """Return the correlation of bins, shape (bins, bins).

        Parameters
        ----------
        position : ndarray, shape (bins,)
            Centres of the bins. [deg]
        speed : float
            Speed of the pair. [deg/s]

        Examples
        --------
        >>> import numpy as np
        >>> noise = WithinNoise(time=0.1, share=0.5)
        >>> print(noise.correlation(np.array([0.0, 5.0]), 50.0).round(3))
        [[1.    0.184]
         [0.184 1.   ]]
        """
        apart = np.abs(position[:, np.newaxis] - position) / speed
        return (1 - self.share) * np.eye(len(position)) + self.share * np.exp(-apart / self.time)


def whitening(correlation: Array) -> tuple[Array, Array]:
    """Return the matrix that makes deviations from a mean white, and its eigenvalues.

    Parameters
    ----------
    correlation : ndarray, shape (bins, bins)
        Correlation of the bins.

    Returns
    -------
    matrix : ndarray, shape (bins, bins)
        Symmetric; it maps a constant to zero.
    eigenvalues : ndarray, shape (bins - 1,)
        Those of the covariance of the deviations that are not zero.
    """
    count = len(correlation)
    projection = np.eye(count) - 1 / count
    values, vectors = np.linalg.eigh(projection @ correlation @ projection)
    kept = values > _RANK * max(float(values[-1]), 1e-300)
    scaled = vectors[:, kept] / np.sqrt(values[kept])
    return scaled @ vectors[:, kept].T, values[kept]


def within_noise_of(blocks: list[tuple[float, Array, Array]]) -> WithinNoise:
    """Return the noise within pairs that is most likely.

    Parameters
    ----------
    blocks : list of (float, ndarray, ndarray)
        Of groups of pairs at one speed that cross the same bins: their speed [deg/s], the centres
        of the bins [deg], shape (bins,), and the deviations of each pair from its mean, less their
        mean over the pairs [N·m], shape (..., pairs, bins).

    Returns
    -------
    WithinNoise
        White noise where there is too little to estimate it from.
    """
    products: dict[tuple[float, bytes], tuple[float, Array, Array, float]] = {}
    for speed, position, error in blocks:
        freedom = error.size / error.shape[-1] * (1 - 1 / error.shape[-2])
        flat = error.reshape(-1, error.shape[-1])
        key = (round(float(np.log(speed)), 1), position.tobytes())
        known = products.get(key)
        inner, count = flat.T @ flat, freedom
        if known is not None:
            inner, count = inner + known[2], count + known[3]
        products[key] = (speed, position, inner, count)
    total = sum(one[3] * (len(one[1]) - 1) for one in products.values())
    if total < LEAST_FREEDOM:
        return WithinNoise()
    groups = list(products.values())
    found = [(_costs(TIMES[0], (0.0,), groups)[0], WithinNoise())]
    for time in TIMES:
        costs = _costs(time, SHARES, groups)
        found += [
            (cost, WithinNoise(time, share)) for cost, share in zip(costs, SHARES, strict=True)
        ]
    return min(found, key=lambda one: one[0])[1]


def _costs(
    time: float, shares: tuple[float, ...], groups: list[tuple[float, Array, Array, float]]
) -> list[float]:
    """Return -2 ln of the likelihood of each share, the variance at each speed maximised over.

    The deviations of all shares have the same eigenvectors: white noise has any.
    """
    costs = [0.0] * len(shares)
    for speed, position, inner, count in groups:
        projection = np.eye(len(position)) - 1 / len(position)
        correlation = WithinNoise(time, 1.0).correlation(position, speed)
        values, vectors = np.linalg.eigh(projection @ correlation @ projection)
        # the first is the constant, which deviations do not hold
        values, vectors = values[1:], vectors[:, 1:]
        powers = np.einsum("ij,ij->j", inner @ vectors, vectors)
        freedom = count * len(values)
        for number, share in enumerate(shares):
            mixed = 1 - share + share * values
            square = max(float(np.sum(powers / mixed)), 1e-300)
            costs[number] += freedom * np.log(square / freedom)
            costs[number] += count * float(np.sum(np.log(mixed)))
    return costs
