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

from dataclasses import dataclass, field, replace

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.fit.base_products import BaseProducts
from frictioncli.diagnosis.fit.block_cholesky import BlockCholesky
from frictioncli.diagnosis.fit.products import ChosenProducts, Products
from frictioncli.diagnosis.fit.transformed_columns import Places

_RIDGE = 1e-10
"""Added to the diagonal of columns of unit length: what no data determine stays finite."""

_STRONGER_RIDGES = (1e-6, 1e-3)
"""The same where rounding makes the products of many columns indefinite."""

_VANISHING = 6.0
"""Difference of the logarithms of amplitudes beyond which a function is as good as none."""

LEAST_VARIANCE = 1e-18
"""Least variance, so that torques without noise can be weighted. [(N·m)²]"""


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

    def with_most_drift(self, number: int, most: float) -> "Components":
        """Return the components with another greatest drift in one channel.

        Parameters
        ----------
        number : int
            0 for friction, 1 for load.
        most : float
            Greatest variance of the drift. [(N·m)²]
        """
        friction, load = np.where(np.arange(2) == number, most, self.most_drift)
        return replace(self, most_drift=(float(friction), float(load)))

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
    factor : BlockCholesky
        Factor of the normal equations of columns of unit length.
    size : ndarray, shape (columns,)
        Length of each column.
    """

    variances: Variances
    objective: float
    coefficients: Array
    factor: BlockCholesky
    size: Array
    _covariance: list[Array] = field(default_factory=list, init=False, repr=False)

    @property
    def covariance(self) -> Array:
        """Covariance of the coefficients, shape (columns, columns)."""
        if not self._covariance:
            self._covariance.append(self.factor.inverse() / np.outer(self.size, self.size))
        return self._covariance[0]

    def covariances(self) -> tuple[Array, Array]:
        """Return the covariance of the coefficients that show in friction, and in load.

        Those of a channel's own columns come first.
        """
        found = []
        for channel, own in enumerate(self.factor.sets[0]):
            size = self.size[np.concatenate([own, self.factor.sets[1]])]
            found.append(self.factor.inverse_beside(channel) / np.outer(size, size))
        return found[0], found[1]

    def covariance_of(self, place: slice) -> Array:
        """Return the covariance of the coefficients of columns that show in both channels."""
        others = self.factor.sets[1]
        own = np.searchsorted(others, np.arange(place.start, place.stop))
        inverse = self.factor.inverse_of_others()[np.ix_(own, own)]
        return np.asarray(inverse / np.outer(self.size[place], self.size[place]))


def weights_of(components: Components, variances: Variances, count: int) -> Array:
    """Return the prior precision of each column, shape (count,); 0 where it is free."""
    ridge = np.zeros(count)
    precision = np.exp(-2 * variances.amplitude).tolist()
    for place, value in zip(components.functions, precision, strict=True):
        ridge[place] = value
    return ridge


def evaluate(
    components: Components, products: Products, known: int, variances: Variances
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
    components: Components, chosen: ChosenProducts, known: int, variances: Variances
) -> MixedFit:
    """Return the same from the products under the noise models that are chosen.

    Parameters
    ----------
    components : Components
        What the variance components belong to.
    chosen : ChosenProducts
        Inner products of all columns under the noise models of the variance components.
    known : int
        Number of columns of the null hypothesis.
    variances : Variances
        The variance components.
    """
    places = chosen.places
    count = places.count - 1
    products = chosen.weighted(variances.within, variances.between)
    diagonal, right = np.zeros(count + 1), np.zeros(count + 1)
    for channel, product in enumerate(products):
        shown = places.shown(channel)
        diagonal[shown] += np.diagonal(product)
        right[shown] += product[-1]
    length = right[-1]
    right = right[:-1]
    size = np.sqrt(diagonal[:-1] + weights_of(components, variances, count))
    size = np.where(size > 0, size, 1.0)
    factor = _factor(products, size, places)
    logarithms = factor.logarithms() + np.log(size)
    coefficients = factor.solve(right / size) / size
    square = max(float(length - coefficients @ right), 1e-300)
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
        factor=factor,
        size=size,
    )


def _factor(products: list[Array], size: Array, places: Places) -> BlockCholesky:
    """Return the factor of the products of columns of unit length.

    Parameters
    ----------
    products : list of ndarray, shape (shown, shown)
        Of the columns that show in friction and load, the misfit last.
    size : ndarray, shape (columns,)
        Length of each column; with it, of a random function the prior counts.
    places : Places
        Where the columns show.
    """
    shared = places.shared[:-1]
    among = np.zeros((len(shared), len(shared)))
    own, across = [], []
    for place, product in zip(places.own, products, strict=True):
        width = len(place)
        rows = product[:width, :-1] / size[place, np.newaxis]
        own.append(rows[:, :width] / size[place])
        across.append(rows[:, width:] / size[shared])
        among += product[width:-1, width:-1]
    among /= np.outer(size[shared], size[shared])
    for ridge in (_RIDGE, *_STRONGER_RIDGES):
        for one in (*own, among):
            np.fill_diagonal(one, 1.0 + ridge)
        factor = BlockCholesky.of((places.own, shared), own, across, among)
        if factor is not None:
            return factor
    raise np.linalg.LinAlgError("products of columns are not those of real numbers")
