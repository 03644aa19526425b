"""Tests of hypotheses against a null hypothesis whose variance components are given."""

from dataclasses import dataclass, replace

import numpy as np

from frictioncli.arrays import Array, Flags
from frictioncli.diagnosis.fit.bounded import bounded_coefficients, pseudo_inverse
from frictioncli.diagnosis.fit.hypotheses import HypothesisTest
from frictioncli.diagnosis.fit.mixed_model import MixedFit, Variances
from frictioncli.diagnosis.fit.transformed_columns import TransformedColumns
from frictioncli.diagnosis.noise.significance import NullDistribution, log_bayes_factor
from frictioncli.diagnosis.search.catalogue import Catalogue

_LEAST_LEFT = 1e-6
"""Least share of a column's squared length that base and accepted effects leave, to be fitted."""


@dataclass(frozen=True, slots=True)
class Screened:
    """A hypothesis under given variance components, shape by shape.

    Attributes
    ----------
    coefficients, gain, free
        As of :func:`bounded_coefficients`.
    covariance : ndarray, shape (shapes, width, width)
        Covariance of the coefficients that lie on no bound.
    inner : ndarray, shape (shapes, width, width)
        Inner products of what the null hypothesis leaves of the columns.
    whole : ndarray, shape (shapes, width)
        Squared lengths of the whole columns.
    """

    coefficients: Array
    gain: Array
    free: Flags
    covariance: Array
    inner: Array
    whole: Array


@dataclass(frozen=True, slots=True)
class LeftProducts:
    """What a null hypothesis leaves of the columns of a hypothesis, as inner products.

    Attributes
    ----------
    inner : ndarray, shape (shapes, width, width)
        Of the columns of each shape.
    right : ndarray, shape (shapes, width)
        Of these with the misfit.
    whole : ndarray, shape (shapes, width)
        Squared lengths of the whole columns.
    left : ndarray of bool, shape (shapes, width)
        Columns of which enough is left.
    taken : ndarray, shape (known columns, shapes * width)
        Coefficients of the known columns in each column.
    """

    inner: Array
    right: Array
    whole: Array
    left: Flags
    taken: Array


def screened(
    catalogue: Catalogue, number: int, columns: TransformedColumns, null: MixedFit
) -> Screened:
    """Return a hypothesis at each of its shapes under given variance components."""
    hypothesis = catalogue.hypotheses[number]
    one = left_products(catalogue, number, columns, null)
    inner, right, left = one.inner, one.right, one.left
    coefficients, gain, free = bounded_coefficients(
        inner, right, hypothesis.lower, hypothesis.upper
    )
    free = free & left
    covariance = pseudo_inverse(
        np.where(free[:, :, np.newaxis] & free[:, np.newaxis, :], inner, 0.0)
    )
    return Screened(coefficients, gain, free, covariance, inner, one.whole)


def left_products(
    catalogue: Catalogue, number: int, columns: TransformedColumns, null: MixedFit
) -> LeftProducts:
    """Return products of what the null hypothesis leaves of a hypothesis, shape by shape."""
    hypothesis = catalogue.hypotheses[number]
    across, own = catalogue.products(number, columns, null.variances)
    shapes, width = len(hypothesis.shapes), hypothesis.width
    right = across[-1] - null.coefficients @ across[:-1]
    taken = null.covariance @ across[:-1]
    blocks = across[:-1].reshape(-1, shapes, width)
    inner = own - np.einsum("nsi,nsj->sij", blocks, taken.reshape(-1, shapes, width))
    whole = np.diagonal(own, axis1=1, axis2=2)
    left = np.diagonal(inner, axis1=1, axis2=2) > _LEAST_LEFT * np.maximum(whole, 1e-12)
    inner = np.where(left[:, :, np.newaxis] & left[:, np.newaxis, :], inner, 0.0)
    right = np.where(left, right.reshape(shapes, width), 0.0)
    return LeftProducts(inner, right, whole, left, taken)


def of_size(found: Screened, rms: Array, least: float) -> Screened:
    """Return a hypothesis without those of its shapes that come out too small to matter.

    A small torque that no smooth error resembles, as a fine ripple, may explain more than a large
    one that the discrepancy can follow, and would hide it. All shapes stay where none is larger.

    Parameters
    ----------
    found : Screened
        The hypothesis at each of its shapes.
    rms : ndarray, shape (shapes, width)
        RMS of each column. [N·m per unit of the coefficient]
    least : float
        Least RMS torque that matters. [N·m]
    """
    small = np.linalg.norm(found.coefficients * rms, axis=1) < least
    if small.all():
        return found
    return replace(found, gain=np.where(small, 0.0, found.gain))


def test_of(
    catalogue: Catalogue, number: int, found: Screened, offset: float, variances: Variances
) -> HypothesisTest:
    """Return the test of a hypothesis from its fits at each shape.

    Parameters
    ----------
    catalogue : Catalogue
        Hypotheses.
    number : int
        Number of the hypothesis.
    found : Screened
        Its fits.
    offset : float
        Twice the log likelihood of the null hypothesis under these variance components, less that
        under those that suit it best.
    variances : Variances
        The variance components.
    """
    hypothesis = catalogue.hypotheses[number]
    grid = np.maximum(found.gain + offset, 0.0)
    best = int(np.argmax(grid))
    freedom = int(np.linalg.matrix_rank(found.inner[best], hermitian=True, tol=1e-12))
    null = NullDistribution(
        coefficients=freedom,
        freedom=_noise_freedom(catalogue, number, best, variances),
        shapes=catalogue.directions(number),
    )
    length = np.sqrt(np.maximum(np.diagonal(found.inner[best]), 0.0))
    return HypothesisTest(
        name=hypothesis.name,
        shape=hypothesis.shapes[best],
        coefficients=found.coefficients[best],
        covariance=found.covariance[best],
        statistic=float(grid[best]),
        p_value=min(1.0, len(catalogue.hypotheses) * null.p_value(float(grid[best]))),
        log_bayes_factor=log_bayes_factor(grid, int(found.free[best].sum())),
        freedom=freedom,
        null=null,
        size_scale=float(
            np.linalg.norm(hypothesis.rms[best]) / max(float(np.linalg.norm(length)), 1e-300)
        ),
        variances=variances,
        left_share=float(np.linalg.norm(length) / np.sqrt(max(found.whole[best].sum(), 1e-300))),
    )


def _noise_freedom(catalogue: Catalogue, number: int, shape: int, variances: Variances) -> float:
    """Return the degrees of freedom of the noise that a hypothesis is judged by.

    After Satterthwaite: the information on its coefficients comes from deviations within pairs
    and from pair means, each with a scale of its own.
    """
    components = catalogue.precomputed.components
    parts = np.array(catalogue.lengths(number, shape, variances))
    free = [
        components.within[0],
        max(components.pairs - components.base, 1),
    ]
    if parts.sum() == 0:
        return float(free[1])
    share = parts / parts.sum()
    return float(1 / np.sum(np.square(share) / np.array(free)))
