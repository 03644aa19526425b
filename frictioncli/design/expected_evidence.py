r"""What a torque that a rival leaves is worth, where the noise is estimated anew.

A diagnosis does not know the noise. Where a rival leaves some of the torque, a stronger or slower
wandering may take it, which a slow torque suits better than a quick one. So the doubled log
likelihood falls only by

.. math:: \ell = \min_k \; n \ln \frac{t_k + \lambda_k}{n} + d_k

over noises :math:`V_k` of any scale: :math:`\lambda_k` is what is left of the torque under
:math:`V_k`, :math:`n` the pairs less what the base fits, :math:`t_k = \operatorname{tr} P_k V_0`
the square of the true noise that is expected under it, and :math:`d_k` the rise of the restricted
log determinant [1]_. Without a torque each term is twice a Kullback-Leibler divergence [2]_: the
price of a noise that is not the true one.

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

_STRONGER = (1.0, 2.0, 4.0)
"""Strengths of the wandering that are tried, relative to the true one."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Noises:
    """Noises of friction that a diagnosis may find, the true one first.

    Attributes
    ----------
    friction : tuple of Noise
        The noises. [N·m]
    square : ndarray, shape (noises,)
        Square of the true noise that is expected under each.
    determinant : ndarray, shape (noises,)
        Restricted log determinant above that of the true one.
    freedom : int
        Pairs less what the base fits of their means.
    """

    friction: tuple[Noise, ...]
    square: Array
    determinant: Array
    freedom: int

    def fall(self, left: Array) -> tuple[Array, Array]:
        """Return by how much the log likelihood falls, in the mean, doubled, and its variance.

        The variance is that of the fall itself. It is less than under a known noise, too: what
        chance adds to the torque is also taken for noise in part.

        Parameters
        ----------
        left : ndarray, shape (noises, ...)
            Squared length of what is left of the torque under each noise.
        """
        shape = (-1, *(1 for _ in left.shape[1:]))
        square, determinant = self.square.reshape(shape), self.determinant.reshape(shape)
        each = self.freedom * np.log((square + left) / self.freedom) + determinant
        best = np.argmin(each, axis=0)[np.newaxis]
        slope = self.freedom / (square + left)
        variance = left * np.square(slope)
        return tuple(np.take_along_axis(one, best, axis=0)[0] for one in (each, variance))


def noises_of(layout: PairLayout, true: Noise, extra: Array, base: Array) -> Noises:
    """Return noises that a diagnosis of rows may find, beside the true one.

    Parameters
    ----------
    layout : PairLayout
        The pairs.
    true : Noise
        Noise of friction that the rows have. [N·m]
    extra : ndarray, shape (pairs,)
        Variance that is known beforehand. [(N·m)²]
    base : ndarray, shape (pairs, columns)
        Pair means of the base's columns.
    """
    length = np.linalg.norm(base, axis=0)
    known = orth(base / np.where(length > 0, length, 1.0), rcond=1e-9)
    spans = [np.ptp(layout.time[layout.run == run]) for run in np.unique(layout.run)]
    times = {true.drift_time, max(true.drift_time, *spans)}
    tried = [
        replace(true, drift=strength * true.drift, drift_time=time)
        for time in sorted(times)
        for strength in _STRONGER
    ]
    covariances = [
        pair_covariance(noise, time=layout.time, run=layout.run, bins=layout.bins, extra=extra)
        for noise in tried
    ]
    # the true noise comes first: its time is the shortest, its strength the least
    whole = covariances[0].times(np.eye(len(layout.time)))
    expected = [_expected(one, whole, known) for one in covariances]
    square, determinant = np.array(expected).T
    return Noises(
        friction=tuple(tried),
        square=square,
        determinant=determinant - determinant[0],
        freedom=len(layout.time) - known.shape[1],
    )


def _expected(covariance: PairCovariance, true: Array, known: Array) -> tuple[float, float]:
    """Return the square of true noise expected under a covariance, and its log determinant.

    Both are restricted to what the columns ``known`` leave.
    """
    solved = covariance.solve(known)
    information = known.T @ solved
    taken = np.trace(np.linalg.solve(information, solved.T @ true @ solved))
    square = np.trace(covariance.solve(true)) - taken
    determinant = covariance.log_determinant + np.linalg.slogdet(information)[1]
    return float(square), float(determinant)
