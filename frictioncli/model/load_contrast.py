r"""The load coefficient from within the pairs: equation (10), its noise and its differences by run.

Within a pair only the load varies, so that alpha is the slope of friction over the squared load.
"""

import numpy as np

from frictioncli.arrays import Array
from frictioncli.model.drift import run_starts
from frictioncli.model.observations import Observations
from frictioncli.model.run_differences import difference_of_estimates


def load_coefficient(observed: Observations) -> float:
    """Return alpha of equation (10) from within the pairs alone; 0 where load does not vary.

    Parameters
    ----------
    observed : Observations
        Friction of one joint.

    Returns
    -------
    float
        Load coefficient. [1/(N·m)]
    """
    if observed.load_contrast <= 0:
        return 0.0
    slope = observed.squared_load_within @ observed.friction_within / observed.load_contrast
    return max(float(slope), 0.0)


def point_noise(observed: Observations, alpha: float) -> float:
    """Return the standard deviation of one angle bin about its pair [N·m]."""
    within = observed.friction_within - alpha * observed.squared_load_within
    freedom = max(len(within) - len(observed.friction) - 1, 1)
    floor = 1e-6 * max(float(np.mean(np.abs(observed.friction))), 1e-12)
    return max(float(np.sqrt(within @ within / freedom)), floor)


def contrast_inflation(observed: Observations, alpha: float, point: float) -> float:
    """Return the factor by which the variance of alpha exceeds that of independent bins.

    Residuals shared by neighbouring bins of a pair, or by all pairs at an angle, make alpha less
    certain. The factor is the greater one of the cluster-robust variances, by pair and by angle,
    over the variance of independent bins.

    Parameters
    ----------
    observed : Observations
        Friction of one joint.
    alpha : float
        Load coefficient. [1/(N·m)]
    point : float
        Standard deviation of one angle bin about its pair. [N·m]

    Returns
    -------
    float
        The factor, 1 or more. [-]
    """
    if observed.load_contrast <= 0:
        return 1.0
    residual = observed.friction_within - alpha * observed.squared_load_within
    score = observed.squared_load_within * residual
    independent = point**2 * observed.load_contrast
    clusters = (observed.row_pair, np.unique(observed.row_position, return_inverse=True)[1])
    clustered = [float(np.sum(np.square(np.bincount(cluster, score)))) for cluster in clusters]
    return max(1.0, *(value / independent for value in clustered))


def contrast_by_run(observed: Observations) -> Array:
    """Return the sum of squares of the squared load about its pair means by run [(N·m)⁴]."""
    squares = np.bincount(
        observed.row_pair, np.square(observed.squared_load_within), len(observed.run)
    )
    return np.asarray(np.add.reduceat(squares, run_starts(observed.run)))


def load_difference(observed: Observations, alpha: float) -> float:
    """Return by how much alpha differs between runs, as a share of it [-].

    Each run has an alpha of its own, whose error allows for residuals that the bins of a pair
    share.

    Parameters
    ----------
    observed : Observations
        Friction of one joint.
    alpha : float
        Load coefficient of all runs. [1/(N·m)]
    """
    contrast, starts = contrast_by_run(observed), run_starts(observed.run)
    if alpha <= 0 or not contrast.any():
        return 0.0
    known = contrast > 1e-9 * np.max(contrast)
    divisor = np.where(known, contrast, 1.0)

    def by_pair(rows: Array) -> Array:
        """Return sums of rows over each pair."""
        return np.asarray(np.bincount(observed.row_pair, rows, len(observed.run)), dtype=float)

    square = observed.squared_load_within
    slope = np.add.reduceat(by_pair(square * observed.friction_within), starts) / divisor
    of_pair = np.repeat(slope, np.diff(np.append(starts, len(observed.run))))
    score = square * (observed.friction_within - of_pair[observed.row_pair] * square)
    # of independent bins, or of bins that share the error of their pair
    squares = by_pair(np.square(score)), np.square(by_pair(score))
    variance = np.maximum(*(np.add.reduceat(one, starts) for one in squares)) / np.square(divisor)
    return difference_of_estimates(slope[known] / alpha, variance[known] / alpha**2)
