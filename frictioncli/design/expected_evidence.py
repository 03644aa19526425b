r"""Expected evidence against a rival where the noise is estimated together with the model.

A diagnosis does not know the noise. A torque that a rival cannot fit may be absorbed by a stronger
or slower drift of the noise; this suits a slow torque better than a fast one. Twice the log
likelihood therefore falls only by

.. math:: \ell = \min_k \; n \ln \frac{t_k + \lambda_k}{n} + d_k

over noise covariances :math:`V_k` of any scale: :math:`\lambda_k` is the noncentrality of the
torque under :math:`V_k`, :math:`n` the residual degrees of freedom,
:math:`t_k = \operatorname{tr} P_k V_0` the expected sum of squares of the true noise under
:math:`V_k`, and :math:`d_k` the rise of the restricted log determinant [1]_. Without a torque each
term is twice a Kullback-Leibler divergence [2]_, the cost of a wrong noise.

References
----------
.. [1] H. D. Patterson and R. Thompson, "Recovery of inter-block information when block sizes are
   unequal," Biometrika 58(3), 1971, doi:10.1093/biomet/58.3.545 (restricted likelihood).
.. [2] S. Kullback and R. A. Leibler, "On information and sufficiency," Ann. Math. Stat. 22(1),
   1951, doi:10.1214/aoms/1177729694.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import orth

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.pair_layout import PairLayout
from frictioncli.model.noise import Noise, PairCovariance, pair_covariance

_DRIFT_FACTORS = (1.0, 2.0, 4.0)
"""Strengths of the drift that a diagnosis may find, relative to the true one."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CandidateNoises:
    """Noises of friction that a diagnosis may find, the true one first.

    Attributes
    ----------
    noises : tuple of Noise
        The noises. [N·m]
    expected_squares : ndarray, shape (noises,)
        Expected sum of squares of the true noise, whitened by each noise.
    log_determinants : ndarray, shape (noises,)
        Restricted log determinants, relative to that of the true noise.
    degrees_of_freedom : int
        Number of pairs less the rank of the base model in their means.
    """

    noises: tuple[Noise, ...]
    expected_squares: Array
    log_determinants: Array
    degrees_of_freedom: int

    def log_likelihood_ratio(self, noncentrality: Array) -> tuple[Array, Array]:
        """Return twice the mean, and the variance, of the log likelihood ratio of truth and rival.

        The variance, too, is less than under a known noise, because part of the random component
        along the torque is taken for noise.

        Parameters
        ----------
        noncentrality : ndarray, shape (noises, ...)
            Squared length of the torque that the rival cannot fit, whitened by each noise.

        Returns
        -------
        twice_mean, variance : ndarray, shape (...)
            Under the noise with the highest likelihood.
        """
        shape = (-1, *(1 for _ in noncentrality.shape[1:]))
        squares = self.expected_squares.reshape(shape)
        log_determinants = self.log_determinants.reshape(shape)
        count = self.degrees_of_freedom
        twice_mean = count * np.log((squares + noncentrality) / count) + log_determinants
        best = np.argmin(twice_mean, axis=0)[np.newaxis]
        slope = count / (squares + noncentrality)
        variance = noncentrality * np.square(slope)
        return tuple(np.take_along_axis(one, best, axis=0)[0] for one in (twice_mean, variance))


def candidate_noises(layout: PairLayout, true: Noise, extra: Array, base: Array) -> CandidateNoises:
    """Return the noises that a diagnosis of some rows may find beside the true one.

    Parameters
    ----------
    layout : PairLayout
        The pairs.
    true : Noise
        True noise of friction. [N·m]
    extra : ndarray, shape (pairs,)
        Additional variance of the pair means that is known. [(N·m)²]
    base : ndarray, shape (pairs, columns)
        Pair means of the base model's columns.

    Returns
    -------
    CandidateNoises
        Noises with stronger and slower drift.
    """
    length = np.linalg.norm(base, axis=0)
    nuisance = orth(base / np.where(length > 0, length, 1.0), rcond=1e-9)
    spans = [np.ptp(layout.time[layout.run == run]) for run in np.unique(layout.run)]
    times = {true.drift_time, max(true.drift_time, *spans)}
    # the true noise comes first: its drift time is the shortest, its factor the least
    noises = [
        replace(true, drift=factor * true.drift, drift_time=time)
        for time in sorted(times)
        for factor in _DRIFT_FACTORS
    ]
    covariances = [
        pair_covariance(noise, time=layout.time, run=layout.run, bins=layout.bins, extra=extra)
        for noise in noises
    ]
    true_covariance = covariances[0].times(np.eye(len(layout.time)))
    expected = [_restricted(one, true_covariance, nuisance) for one in covariances]
    squares, log_determinants = np.array(expected).T
    return CandidateNoises(
        noises=tuple(noises),
        expected_squares=squares,
        log_determinants=log_determinants - log_determinants[0],
        degrees_of_freedom=len(layout.time) - nuisance.shape[1],
    )


def _restricted(covariance: PairCovariance, true: Array, nuisance: Array) -> tuple[float, float]:
    """Return the expected square of the true noise under a covariance, and its log determinant.

    Both are restricted to the space orthogonal to the nuisance columns.
    """
    solved = covariance.solve(nuisance)
    information = nuisance.T @ solved
    fitted = np.trace(np.linalg.solve(information, solved.T @ true @ solved))
    square = np.trace(covariance.solve(true)) - fitted
    log_determinant = covariance.log_determinant + np.linalg.slogdet(information)[1]
    return float(square), float(log_determinant)
