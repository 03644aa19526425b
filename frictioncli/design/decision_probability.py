r"""How surely a programme names the cause.

New rows add to the evidence of rival A against B, less that of A against itself
(:mod:`frictioncli.design.discrimination`, :mod:`frictioncli.design.expected_evidence`). If A is at
work, the logarithm of its odds, known by the data at hand, becomes normal with a mean that is
greater by that. Its variance is that of the evidence, as far as new rows make it. A is named where
it exceeds ln 19, a credible set of 95 %.
"""

import numpy as np
from scipy.stats import norm

from frictioncli.arrays import Array
from frictioncli.design.discrimination import Discrimination
from frictioncli.design.rivals import Question

NAMED = float(np.log(19.0))
"""Logarithm of the odds at which a credible set of 95 % has one name."""

_LEAST_VARIANCE = 1e-9
"""Variance of the odds by rows that tell nothing."""

_NODES = ((-(3**0.5), 1 / 6), (0.0, 2 / 3), (3**0.5, 1 / 6))
"""Places and weights of a mean over a normal distribution (Gauss and Hermite, three points)."""


def chances(question: Question, before: Discrimination, after: Discrimination) -> Array:
    """Return the probability that i, if it is at work, leaves j behind.

    Shape (rivals, rivals + others + 1); the last column is the base alone. The size of what is at
    work is as uncertain as the data at hand leave it.

    Parameters
    ----------
    question : Question
        The rivals with what the data at hand say.
    before, after : Discrimination
        How far apart they are in the rows at hand, and in those with the programme's.
    """
    found = np.zeros(after.left.shape[1:])
    odds, error = _odds(question), _size_error(question)
    for place, weight in _NODES:
        size = np.maximum(1 + place * error, 0.0)
        mean, variance = _added(before, after, size)
        found += weight * norm.cdf((odds + mean - NAMED) / np.sqrt(variance))
    np.fill_diagonal(found, 1.0)
    return found


def margins(
    question: Question, before: Discrimination, after: Discrimination, enough: float
) -> Array:
    """Return by how much odds exceed what a name needs, in the mean over all rivals.

    Logarithms, for each rival as the one at work; beyond ``enough`` they count no more. Other
    parameters are as of :func:`chances`.
    """
    margin = _odds(question) + _added(before, after)[0] - NAMED
    np.fill_diagonal(margin, np.nan)
    return np.asarray(np.nanmean(np.clip(margin, -enough, enough), axis=1))


def _odds(question: Question) -> Array:
    """Return logarithms of the odds by the data at hand, shape (rivals, rivals + others + 1)."""
    evidence = [rival.evidence for rival in (*question.rivals, *question.others)]
    own = np.array(evidence[: len(question.rivals)])
    return np.asarray(own[:, np.newaxis] - np.array([*evidence, 0.0]))


def _added(
    before: Discrimination, after: Discrimination, size: Array | float = 1.0
) -> tuple[Array, Array]:
    """Return what rows add to the odds in the mean, and the variance of that.

    What is at work has to find its own shape among many, as its rivals have.
    """
    known, _ = before.evidence(size)
    whole, variance = after.evidence(size)
    gained, fresh = whole - known, variance * (1 - after.share_of(before))
    mean, scatter = (each - np.diag(each)[:, np.newaxis] for each in (gained, fresh))
    return mean / 2, np.maximum(scatter, _LEAST_VARIANCE)


def _size_error(question: Question) -> Array:
    """Return the relative standard error of each rival's size."""
    statistic = np.array([max(rival.score.statistic, 1.0) for rival in question.rivals])
    return np.asarray(1 / np.sqrt(statistic))


def decided(question: Question, chance: Array) -> float:
    """Return the probability that the question ends with the right name alone."""
    share = question.probabilities
    weight = np.array([share[rival.name] for rival in question.rivals])
    return float(weight @ np.prod(chance, axis=1))
