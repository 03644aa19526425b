r"""Probability that a programme identifies the cause.

New rows increase the expected log odds of the true rival A over rival B by their log likelihood
ratio, less the loss that A itself has because its shape must be estimated
(:mod:`frictioncli.design.discrimination`, :mod:`frictioncli.design.expected_evidence`). If A is the
cause, the log odds are taken as normal about that mean, with the variance that the new rows add. A
is named where they exceed ln 19: a 95 % credible set then has one member.
"""

import numpy as np
from scipy.special import ndtr

from frictioncli.arrays import Array
from frictioncli.design.discrimination import Discrimination
from frictioncli.design.rivals import Question

DECISIVE_LOG_ODDS = float(np.log(19.0))
"""Log odds at which a credible set of 95 % has one member."""

_LEAST_VARIANCE = 1e-9
"""Variance of the log odds where new rows carry no information."""

_NODES = ((-(3**0.5), 1 / 6), (0.0, 2 / 3), (3**0.5, 1 / 6))
"""Nodes and weights of the three-point Gauss-Hermite rule for a standard normal variable."""


def rule_out_probabilities(
    question: Question, before: Discrimination, after: Discrimination
) -> Array:
    """Return the probability that rival j is ruled out if rival i is the cause.

    Averaged over the uncertainty of the size of rival i in the observed rows.

    Parameters
    ----------
    question : Question
        Rivals with their evidence in the observed rows.
    before, after : Discrimination
        Noncentralities in the observed rows, and in observed and planned rows.

    Returns
    -------
    ndarray, shape (rivals, rivals + confounders + 1)
        Probabilities; the last column is the base model alone.
    """
    probability = np.zeros(after.noncentrality.shape[1:])
    log_odds, error = _log_odds(question), _relative_size_errors(question)
    for node, weight in _NODES:
        size = np.maximum(1 + node * error, 0.0)
        mean, variance = _log_odds_gain(before, after, size)
        probability += weight * ndtr((log_odds + mean - DECISIVE_LOG_ODDS) / np.sqrt(variance))
    np.fill_diagonal(probability, 1.0)
    return probability


def log_odds_margins(
    question: Question, before: Discrimination, after: Discrimination, bound: float
) -> Array:
    """Return by how much the expected log odds exceed the decisive ones.

    Parameters
    ----------
    question : Question
        Rivals with their evidence in the observed rows.
    before, after : Discrimination
        Noncentralities in the observed rows, and in observed and planned rows.
    bound : float
        Margins are clipped to ±bound.

    Returns
    -------
    ndarray, shape (rivals,)
        For each rival as the cause, the mean margin over all others.
    """
    margin = _log_odds(question) + _log_odds_gain(before, after)[0] - DECISIVE_LOG_ODDS
    np.fill_diagonal(margin, np.nan)
    return np.asarray(np.nanmean(np.clip(margin, -bound, bound), axis=1))


def decision_probability(question: Question, rule_out: Array) -> float:
    """Return the probability that only the right name remains.

    Parameters
    ----------
    question : Question
        Rivals with their probabilities.
    rule_out : ndarray, shape (rivals, rivals + confounders + 1)
        Result of :func:`rule_out_probabilities`.
    """
    probabilities = question.probabilities
    weight = np.array([probabilities[rival.name] for rival in question.rivals])
    return float(weight @ np.prod(rule_out, axis=1))


def _log_odds(question: Question) -> Array:
    """Return log odds in the observed rows, shape (rivals, rivals + confounders + 1)."""
    evidence = [rival.evidence for rival in (*question.rivals, *question.confounders)]
    of_rivals = np.array(evidence[: len(question.rivals)])
    return np.asarray(of_rivals[:, np.newaxis] - np.array([*evidence, 0.0]))


def _log_odds_gain(
    before: Discrimination, after: Discrimination, size: Array | float = 1.0
) -> tuple[Array, Array]:
    """Return the mean and variance of the log odds that the new rows add.

    The cause has to find its own shape among many, as its rivals have: its own loss is subtracted.
    """
    known, _ = before.log_likelihood_ratio(size)
    ratio, variance = after.log_likelihood_ratio(size)
    gain, new_variance = ratio - known, variance * (1 - after.share_from(before))
    mean, spread = (one - np.diag(one)[:, np.newaxis] for one in (gain, new_variance))
    return mean / 2, np.maximum(spread, _LEAST_VARIANCE)


def _relative_size_errors(question: Question) -> Array:
    """Return the relative standard error of each rival's size, shape (rivals,)."""
    statistic = np.array([max(rival.fit.statistic, 1.0) for rival in question.rivals])
    return np.asarray(1 / np.sqrt(statistic))
