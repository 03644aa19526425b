"""The load torque of each run against that of the others: payload, or the torque's scale."""

import numpy as np

from frictioncli.arrays import Array
from frictioncli.comparison.day_to_day import Scatter
from frictioncli.diagnosis.data.gravity import without_offset
from frictioncli.diagnosis.data.problem import Problem

DAY_TO_DAY = 0.5
"""Assumed standard deviation of the load torque from day to day. [%]"""

_LEAST_SHARE = 0.05
"""Gravity must be at least this share of the friction to be compared at all."""


def load_scales(problem: Problem) -> tuple[Array, Scatter] | None:
    """Return each run's load torque against what all share, and how it may scatter.

    The load torque of every run is the common gravity times a factor of its own, beside an offset,
    which sensors have.

    Parameters
    ----------
    problem : Problem
        All runs.

    Returns
    -------
    (ndarray, Scatter) or None
        Factors less 1, in percent, shape (runs,); none where the joint carries next to nothing.
    """
    table = problem.table
    gravity = without_offset(problem.load_base) @ problem.gravity
    if np.std(gravity) < _LEAST_SHARE * np.mean(np.abs(problem.friction)):
        return None
    runs = len(problem.runs)
    scales, variances = np.zeros(runs), np.zeros(runs)
    for run in range(runs):
        own = table.run == run
        columns = np.column_stack([gravity[own], np.ones(own.sum())])
        found, squares, rank, _ = np.linalg.lstsq(columns, problem.load[own], rcond=1e-9)
        if rank < 2:
            return None
        pairs = len(np.unique(table.pair[own]))
        left = float(squares[0]) / own.sum() if len(squares) else 0.0
        scales[run] = 100 * (found[0] - 1)
        # what bins of a pair share does not average out: a pair counts once
        variances[run] = 1e4 * left / (np.var(gravity[own]) * max(pairs - 2, 1))
    # gravity does not know how warm it is
    return scales, Scatter.of(np.diag(variances), np.zeros(runs), DAY_TO_DAY)
