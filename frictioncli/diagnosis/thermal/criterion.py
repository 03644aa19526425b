r"""A criterion for rivals that counts parameters and knows that noise is correlated.

.. math:: \mathrm{BIC} = -2 \ln L + k \ln n

with the likelihood of the pair means under white pair noise and a drift (an Ornstein-Uhlenbeck
process), whose shares and correlation time are those that suit each rival best. A rival that leaves
slow structure must call it drift; it is judged by how probable such a drift is.

References
----------
.. [1] G. Schwarz, "Estimating the dimension of a model," Ann. Stat. 6(2), 1978,
   doi:10.1214/aos/1176344136.
"""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.pair_layout import PairLayout
from frictioncli.linear_algebra import gram_inverse
from frictioncli.model.noise import Noise, PairCovariance, pair_covariance

_DRIFT_SHARES = (0.05, 0.2, 0.4, 0.6, 0.8, 0.95)
"""Shares of the variance that may be drift, beside none."""

_DRIFT_TIMES = 5
"""Number of correlation times tried."""

_TOLERANCE = 1e-10
"""Directions of unit columns with less than this share of the squared length are undetermined."""


@dataclass(frozen=True, slots=True)
class NoiseFit:
    """The noise that suits the residual of a rival best.

    Attributes
    ----------
    log_likelihood : float
        Its log likelihood, up to a constant that all rivals share.
    covariance : PairCovariance
        Covariance of the pair means.
    """

    log_likelihood: float
    covariance: PairCovariance


def noise_fit(layout: PairLayout, residual: Array, design: Array) -> NoiseFit:
    """Return the noise that suits a residual best.

    Parameters
    ----------
    layout : PairLayout
        The pairs.
    residual : ndarray, shape (pairs,)
        Residual of the pair means. [N·m]
    design : ndarray, shape (pairs, parameters)
        Derivatives of the model by the fitted parameters.
    """
    length = np.linalg.norm(design, axis=0)
    columns = design[:, length > 0] / length[length > 0]
    gaps = np.diff(layout.time)[np.diff(layout.run) == 0]
    shortest = max(2 * float(np.median(gaps)), 1e-3) if gaps.size else 1.0
    longest = max(float(np.ptp(layout.time)), 2 * shortest)
    models = [(0.0, shortest)]
    models += [
        (share, float(time))
        for time in np.geomspace(shortest, longest, _DRIFT_TIMES)
        for share in _DRIFT_SHARES
    ]
    return max(
        (_fitted(layout, residual, columns, share, time) for share, time in models),
        key=lambda one: one.log_likelihood,
    )


def _fitted(
    layout: PairLayout, residual: Array, columns: Array, share: float, time: float
) -> NoiseFit:
    """Return the likelihood of a share of drift, the variance being the most likely one."""
    unit = Noise(
        point=0.0, pair=float(np.sqrt(1 - share)), drift=float(np.sqrt(share)), drift_time=time
    )
    covariance = _covariance(layout, unit)
    solved = covariance.solve(np.column_stack([columns, residual]))
    projected = columns.T @ solved[:, -1]
    inverse = gram_inverse(columns.T @ solved[:, :-1], tolerance=_TOLERANCE)
    square = float(residual @ solved[:, -1] - projected @ inverse @ projected)
    count = len(residual)
    variance = max(square, 1e-300) / count
    likelihood = -0.5 * (count * np.log(variance) + covariance.log_determinant)
    noise = Noise(
        point=0.0,
        pair=float(np.sqrt(variance * (1 - share))),
        drift=float(np.sqrt(variance * share)),
        drift_time=time,
    )
    return NoiseFit(float(likelihood), _covariance(layout, noise))


def _covariance(layout: PairLayout, noise: Noise) -> PairCovariance:
    return pair_covariance(noise, time=layout.time, run=layout.run, bins=layout.bins)


def information_criterion(fit: NoiseFit, parameters: int, pairs: int) -> float:
    """Return the Bayesian information criterion, the smaller the better.

    Parameters
    ----------
    fit : NoiseFit
        The noise of a rival.
    parameters : int
        Number of parameters that were fitted.
    pairs : int
        Number of pairs.
    """
    return -2 * fit.log_likelihood + parameters * float(np.log(pairs))
