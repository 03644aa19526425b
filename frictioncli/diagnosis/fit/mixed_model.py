r"""Mixed linear model of both channels, with its variance components by restricted likelihood.

The misfit *y* of the simulated torque is

.. math:: y = X \beta + \sum_j \omega_j Z_j \gamma_j + \varepsilon

with free coefficients :math:`\beta` of the base and of effects, random functions :math:`Z_j` of the
discrepancy and noise :math:`\varepsilon` in four parts: deviations within pairs, with variance
:math:`s_c`, and pair means, with covariance :math:`a_c V_c`, of each channel *c*. From inner
products of all columns alone follow the coefficients, and the variance components that maximise the
restricted likelihood times their prior [1]_, [2]_:

.. math::
    -2 \ell = \sum_c (n_c \ln s_c + m_c \ln a_c + \ln |V_c|) + y^\mathsf{T} P y
    + \ln |H| + \sum_j r_j \ln \omega_j^2 + \sum_j (\ln \omega_j - \mu)^2 / \varsigma^2 .

References
----------
.. [1] H. D. Patterson and R. Thompson, "Recovery of inter-block information when block sizes are
   unequal," Biometrika 58(3), 1971, doi:10.1093/biomet/58.3.545.
.. [2] D. A. Harville, "Maximum likelihood approaches to variance component estimation and to
   related problems," J. Am. Stat. Assoc. 72(358), 1977, doi:10.1080/01621459.1977.10480998.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import lapack

from frictioncli.arrays import Array
from frictioncli.diagnosis.fit.products import AnyProducts

_RIDGE = 1e-10
"""Added to the diagonal of columns of unit length: what no data determine stays finite."""

_VANISHING = 6.0
"""Difference of the logarithms of amplitudes beyond which a function is as good as none."""

LEAST_VARIANCE = 1e-18
"""Least variance, so that torques without noise can be weighted. [(N·m)²]"""


@dataclass(frozen=True, slots=True, kw_only=True)
class BaseProducts:
    """Inner products of the pair means of the base's columns under each noise model, decomposed.

    Attributes
    ----------
    size : ndarray, shape (noise models, columns)
        Length of each column; infinite where it is none.
    vectors : ndarray, shape (noise models, columns, columns)
        Eigenvectors of the products of columns of unit length.
    inverse : ndarray, shape (noise models, columns)
        Inverse of the eigenvalues; 0 where they count as zero.
    rank : int
        Greatest number of those that do not.
    determinant : ndarray, shape (noise models,)
        Logarithm of the determinant.
    """

    size: Array
    vectors: Array
    inverse: Array
    rank: int
    determinant: Array

    @classmethod
    def of(cls, own: Array) -> "BaseProducts":
        """Return the decomposition of inner products, shape (noise models, columns, columns)."""
        size = np.sqrt(np.maximum(np.diagonal(own, axis1=1, axis2=2), 0.0))
        size = np.where(size > 1e-12 * (1 + size.max(initial=0.0)), size, np.inf)
        values, vectors = np.linalg.eigh(own / (size[:, :, np.newaxis] * size[:, np.newaxis, :]))
        kept = values > 1e-8
        finite = np.where(np.isfinite(size), size, 1.0)
        logarithms = np.sum(np.where(kept, np.log(np.where(kept, values, 1.0)), 0.0), axis=1)
        return cls(
            size=size,
            vectors=vectors,
            inverse=np.where(kept, 1 / np.where(kept, values, 1.0), 0.0),
            rank=int(kept.sum(axis=1).max(initial=0)),
            determinant=logarithms + 2 * np.sum(np.log(finite), axis=1),
        )

    def explained(self, right: Array) -> Array:
        """Return what the base explains of a column, from its inner products with it.

        Parameters
        ----------
        right : ndarray, shape (noise models, columns)
            Inner products of the base with the column.
        """
        projected = ((right / self.size)[:, np.newaxis] @ self.vectors)[:, 0]
        return np.asarray(np.sum(np.square(projected) * self.inverse, axis=1))


@dataclass(frozen=True, slots=True, kw_only=True)
class Components:
    """What the variance components of a model belong to.

    Attributes
    ----------
    base : int
        Number of columns of the base, which come first.
    functions : tuple of slice
        Columns of each random function.
    widths : ndarray, shape (functions,)
        Numbers of their columns.
    prior : ndarray, shape (functions,)
        Logarithm of the amplitude that is expected of each.
    spread : ndarray, shape (functions,)
        Standard deviation of that logarithm.
    least : ndarray, shape (functions,)
        Least logarithm of the amplitude: a rival may not shrink the discrepancy below what is
        expected of any model.
    within : (int, int)
        Degrees of freedom of the deviations within pairs of friction and load.
    pairs : int
        Number of pairs.
    determinants : (ndarray, ndarray)
        Logarithm of the determinant of V of each noise model, of friction and load.
    drifts : (ndarray, ndarray)
        Variance of the drift within the runs of each noise model at scale 1.
    most_drift : (float, float)
        Greatest variance of it that is allowed, of friction and load. [(N·m)²]
    bases : (BaseProducts, BaseProducts) or None
        What is left of the base under each noise model, of friction and load; None where it is
        worked out from the products.
    """

    base: int
    functions: tuple[slice, ...]
    widths: Array
    prior: Array
    spread: Array
    least: Array
    within: tuple[int, int]
    pairs: int
    determinants: tuple[Array, Array]
    drifts: tuple[Array, Array]
    most_drift: tuple[float, float] = (np.inf, np.inf)
    bases: tuple[BaseProducts, BaseProducts] | None = None

    def beside_function(self, place: slice, amplitude: float) -> "Components":
        """Return the components with one more random function, of any amplitude.

        Parameters
        ----------
        place : slice
            Its columns.
        amplitude : float
            Logarithm of an amplitude as great as those of the others.
        """
        return replace(
            self,
            functions=(*self.functions, place),
            widths=np.append(self.widths, place.stop - place.start),
            prior=np.append(self.prior, amplitude),
            spread=np.append(self.spread, np.inf),
            least=np.append(self.least, amplitude - _VANISHING),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Variances:
    """Variance components.

    Attributes
    ----------
    noise : (int, int)
        Number of the noise model of the pair means of friction and load.
    within, between : (float, float)
        Variance of the deviations, and the scale of the noise of the pair means. [(N·m)²]
    amplitude : ndarray, shape (functions,)
        Logarithm of the amplitude of each random function.
    """

    noise: tuple[int, int]
    within: tuple[float, float]
    between: tuple[float, float]
    amplitude: Array


@dataclass(frozen=True, slots=True, kw_only=True)
class MixedFit:
    """Coefficients and likelihood of a model under given variance components.

    Attributes
    ----------
    variances : Variances
        The variance components.
    objective : float
        Minus twice the logarithm of the restricted likelihood times the prior.
    coefficients : ndarray, shape (columns,)
        Of the columns in order; those of the random functions are predictions.
    covariance : ndarray, shape (columns, columns)
        Their covariance.
    """

    variances: Variances
    objective: float
    coefficients: Array
    covariance: Array


def weights_of(components: Components, variances: Variances, count: int) -> Array:
    """Return the prior precision of each column, shape (count,); 0 where it is free."""
    ridge = np.zeros(count)
    precision = np.exp(-2 * variances.amplitude).tolist()
    for place, value in zip(components.functions, precision, strict=True):
        ridge[place] = value
    return ridge


def scales_of(variances: Variances) -> Array:
    """Return the variances within pairs and of pair means: of friction, then of load."""
    return np.array([variances.within, variances.between]).T.ravel()


def evaluate(
    components: Components, products: AnyProducts, known: int, variances: Variances
) -> MixedFit:
    """Return the fit of a model under given variance components.

    Parameters
    ----------
    components : Components
        What they belong to.
    products : Products
        Inner products of all columns.
    known : int
        Number of columns of the null hypothesis, which come first: its restricted likelihood is
        that of the candidate's too.
    variances : Variances
        The variance components.
    """
    return evaluate_chosen(components, products.chosen(variances.noise), known, variances)


def evaluate_chosen(
    components: Components, chosen: Array, known: int, variances: Variances
) -> MixedFit:
    """Return the same from the products under the noise models that are chosen.

    Parameters
    ----------
    components : Components
        What the variance components belong to.
    chosen : ndarray, shape (4, columns, columns)
        Inner products of all columns under the noise models of the variance components.
    known : int
        Number of columns of the null hypothesis.
    variances : Variances
        The variance components.
    """
    gram = ((1 / scales_of(variances)) @ chosen.reshape(4, -1)).reshape(chosen.shape[1:])
    count = len(gram) - 1
    ridge = weights_of(components, variances, count)
    size = np.sqrt(np.diagonal(gram)[:count] + ridge)
    size = np.where(size > 0, size, 1.0)
    inverse_sizes = np.outer(1 / size, 1 / size)
    # the matrix is symmetric: what is contiguous for numpy is so for LAPACK once transposed
    scaled = gram[:count, :count] * inverse_sizes
    scaled[np.diag_indices(count)] = 1.0 + _RIDGE
    factor, fault = lapack.dpotrf(scaled.T, lower=True)
    if fault:
        scaled[np.diag_indices(count)] = 1.0 + 1e-6
        factor, _ = lapack.dpotrf(scaled.T, lower=True)
    logarithms = np.log(np.diagonal(factor)) + np.log(size)
    half, _ = lapack.dpotri(factor, lower=True, overwrite_c=True)
    covariance = half.T + half
    covariance[np.diag_indices(count)] = np.diagonal(half)
    covariance *= inverse_sizes
    right = gram[:count, count]
    coefficients = covariance @ right
    square = max(float(gram[count, count] - coefficients @ right), 1e-300)
    objective = square + 2 * float(np.sum(logarithms[:known]))
    for channel in (0, 1):
        objective += components.within[channel] * np.log(variances.within[channel])
        objective += components.pairs * np.log(variances.between[channel])
        objective += float(components.determinants[channel][variances.noise[channel]])
    amplitude = variances.amplitude
    objective += 2 * float(components.widths @ amplitude)
    objective += float(np.sum(np.square((amplitude - components.prior) / components.spread)))
    return MixedFit(
        variances=variances,
        objective=float(objective),
        coefficients=coefficients,
        covariance=covariance,
    )
