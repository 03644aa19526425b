"""A coefficient beside others that are likely small, with an error that allows for them.

The other coefficients have a normal prior of mean 0. How wide it is, nobody knows: the fit is made
for each of several widths, and the results are averaged by the likelihood of the data under each
[1]_. Where the data show nothing of the other columns, the narrow widths decide, and a coefficient
whose column looks like theirs hardly loses precision; where the data show them, the wide ones do.

The error of one fit has two parts: the noise, and what the prior may have held back. Rows of a pair
share their noise [2]_. What belongs to an angle, and differs there from speed to speed, is found by
leaving out each angle in turn [3]_, since a few angles may decide alone.

References
----------
.. [1] J. A. Hoeting et al., "Bayesian model averaging: a tutorial," Statistical Science 14(4),
   1999, doi:10.1214/ss/1009212519.
.. [2] K.-Y. Liang and S. L. Zeger, "Longitudinal data analysis using generalized linear models,"
   Biometrika 73(1), 1986, doi:10.1093/biomet/73.1.13.
.. [3] A. C. Cameron and D. L. Miller, "A practitioner's guide to cluster-robust inference," Journal
   of Human Resources 50(2), 2015, doi:10.3368/jhr.50.2.317.
"""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Indices
from frictioncli.linear_algebra import gram_inverse

WIDTHS = (1e-5, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 1e-1)
"""Widths of the prior; the first one leaves practically nothing to the other columns."""

_LEAST_NOISE = 1e-12
"""Least variance of the noise, as a share of that of the target: rounding."""

_SINGULAR = 1e-13
"""Share of the greatest eigenvalue below which columns do not determine a direction."""

_ROUNDS = 3
"""Rounds in which noise and fit determine one another."""


@dataclass(frozen=True, slots=True)
class Coefficient:
    """The coefficient in question.

    Attributes
    ----------
    value, error : float
        Its estimate and standard error.
    change : float
        By how much the likely small columns changed the estimate.
    """

    value: float
    error: float
    change: float


@dataclass(frozen=True, slots=True)
class ShrunkRegression:
    """Least squares in which some coefficients are likely small.

    Attributes
    ----------
    columns : ndarray, shape (rows, columns)
        The first one is that of the coefficient in question.
    target : ndarray, shape (rows,)
        What the columns explain.
    unit : ndarray, shape (columns,)
        Standard deviation of each coefficient under a prior of width 1; infinite where it is free.
    pair, angle : ndarray of int, shape (rows,)
        Numbers of what rows share.
    freedom : int
        Degrees of freedom of the residuals.
    """

    columns: Array
    target: Array
    unit: Array
    pair: Indices
    angle: Indices
    freedom: int

    def first(self) -> Coefficient:
        """Return the first coefficient."""
        sums = _Sums.of(self.columns, self.target, self.angle)
        square = float(self.target @ self.target)
        noise = _Noise(square / self.freedom, 1.0, _LEAST_NOISE * square / len(self.target))
        for _ in range(_ROUNDS):
            noise = self._noise(sums, noise)
        strengths = sums.strengths(self.unit)
        fits = [self._first(sums, noise, width) for width in WIDTHS]
        values, variances, explained = np.transpose(fits)
        grown = np.outer(np.square(WIDTHS), strengths / noise.effective)
        likelihoods = 0.5 * (explained - np.sum(np.log1p(grown), axis=1))
        weights = np.exp(likelihoods - likelihoods.max())
        weights /= weights.sum()
        mean = float(weights @ values)
        error = float(np.sqrt(weights @ (variances + np.square(values - mean))))
        return Coefficient(mean, error, mean - float(values[0]))

    def _noise(self, sums: "_Sums", before: "_Noise") -> "_Noise":
        """Return the noise by the widest prior."""
        penalty = self._penalty(before, WIDTHS[-1])
        inverse, coefficients = sums.fitted(penalty)
        residual = self.target - self.columns @ coefficients
        variance = float(residual @ residual) / self.freedom
        alone = variance * float(inverse[0] @ sums.products @ inverse[0])
        shared = self._variance(sums, inverse, coefficients, penalty)
        return _Noise(variance, max(shared / max(alone, 1e-300), 1.0), before.least)

    def _first(self, sums: "_Sums", noise: "_Noise", width: float) -> tuple[float, float, float]:
        """Return the first coefficient, its variance, and the square explained over the noise."""
        penalty = self._penalty(noise, width)
        inverse, coefficients = sums.fitted(penalty)
        shrunk = np.isfinite(self.unit)
        independent = noise.variance * float(inverse[0] @ sums.products @ inverse[0])
        by_noise = max(independent, self._variance(sums, inverse, coefficients, penalty))
        held_back = inverse[0, shrunk] * penalty[shrunk] * width * self.unit[shrunk]
        explained = float(sums.moments @ coefficients) / noise.effective
        return float(coefficients[0]), by_noise + float(held_back @ held_back), explained

    def _penalty(self, noise: "_Noise", width: float) -> Array:
        return np.asarray(noise.effective / np.square(width * self.unit))

    def _variance(
        self, sums: "_Sums", inverse: Array, coefficients: Array, penalty: Array
    ) -> float:
        """Return the variance of the first coefficient by what pairs or angles share."""
        residual = self.target - self.columns @ coefficients
        by_pair = np.bincount(self.pair, (self.columns @ inverse[0]) * residual)
        changes = sums.without_each(penalty)[:, 0] - coefficients[0]
        share = 1.0 - 1.0 / len(changes)
        return float(max(by_pair @ by_pair, share * (changes @ changes)))


@dataclass(frozen=True, slots=True)
class _Noise:
    """Variance of independent rows, the factor of shared noise, and the least variance of both."""

    variance: float
    factor: float
    least: float

    @property
    def effective(self) -> float:
        """Variance of independent rows that would tell as little."""
        return max(self.variance * self.factor, self.least, 1e-300)


@dataclass(frozen=True, slots=True)
class _Sums:
    """Inner products of columns, and of columns and target, also of the rows of each angle."""

    products: Array
    moments: Array
    products_by_angle: Array
    moments_by_angle: Array

    @classmethod
    def of(cls, columns: Array, target: Array, angle: Indices) -> "_Sums":
        size = columns.shape[1]
        by_angle = np.empty((int(angle.max()) + 1, size, size))
        for i in range(size):
            for j in range(i + 1):
                sums = np.bincount(angle, columns[:, i] * columns[:, j])
                by_angle[:, i, j] = by_angle[:, j, i] = sums
        moments = np.column_stack([np.bincount(angle, column * target) for column in columns.T])
        return cls(by_angle.sum(axis=0), moments.sum(axis=0), by_angle, moments.astype(float))

    def fitted(self, penalty: Array) -> tuple[Array, Array]:
        """Return the inverse of the penalised products, and the coefficients."""
        matrix, unit = _scaled(self.products, penalty)
        inverse = gram_inverse(matrix, tolerance=_SINGULAR) * np.outer(unit, unit)
        return inverse, inverse @ self.moments

    def strengths(self, unit: Array) -> Array:
        """Return the eigenvalues of what free columns leave of the others, each in its unit."""
        shrunk = np.isfinite(unit)
        free, both = self.products[~shrunk][:, ~shrunk], self.products[~shrunk][:, shrunk]
        left = (
            self.products[shrunk][:, shrunk]
            - both.T @ gram_inverse(free, tolerance=_SINGULAR) @ both
        )
        return np.maximum(np.linalg.eigvalsh(left * np.outer(unit[shrunk], unit[shrunk])), 0.0)

    def without_each(self, penalty: Array) -> Array:
        """Return the coefficients without the rows of each angle, shape (angles, columns)."""
        matrix, unit = _scaled(self.products, penalty)
        left = matrix - self.products_by_angle * np.outer(unit, unit)
        inverse = gram_inverse(left, tolerance=_SINGULAR)
        moments = (self.moments - self.moments_by_angle) * unit
        return np.asarray(np.einsum("aij,aj->ai", inverse, moments) * unit)


def _scaled(products: Array, penalty: Array) -> tuple[Array, Array]:
    """Return penalised products with a diagonal of 1, and the factors of rows and columns."""
    matrix = products + np.diag(penalty)
    unit = 1.0 / np.sqrt(np.diag(matrix))
    return matrix * np.outer(unit, unit), unit
