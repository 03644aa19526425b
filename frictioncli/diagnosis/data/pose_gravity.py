r"""Which poses of the other joints have a gravity torque of their own.

The weight that a joint carries lies elsewhere where the joints beyond it stand elsewhere, and pulls
in another direction where those before it do. Over the joint's own angle gravity stays a cosine and
a sine in each pose; only their coefficients differ. Many poses differ in nothing that matters: a
joint that turns about the vertical, or a wrist without a tool. Each pose is therefore compared with
those before it, in the order of their rows, and joins the first from which its gravity cannot be
told; the tests go by pairs, as noise and drift are those of a pair [1]_.

References
----------
.. [1] A. C. Cameron and D. L. Miller, "A practitioner's guide to cluster-robust inference," J.
   Human Resources 50(2), 2015, doi:10.3368/jhr.50.2.317.
"""

import numpy as np

from frictioncli.arrays import Array, Flags, Indices

_ALPHA = 0.01
"""Chance that gravity which is the same counts as two. It does little harm: a further gravity costs
power where a change of payload goes with the pose, one too few names a change that nobody made."""

_FEW_PAIRS = 4
"""Pairs below which their scatter tells no noise: angle bins then count as independent."""

_MOST = 24
"""Further gravities, at most; other poses then have that of most rows."""

_TOLERANCE = 1e-9


def gravities_by_pose(
    load: Array, columns: Array, position: Array, pose: Array, pair: Indices
) -> tuple[tuple[int, ...], ...]:
    """Return the poses that share a gravity other than that of the pose with most rows.

    Parameters
    ----------
    load : ndarray, shape (rows,)
        Load torque. [N·m]
    columns : ndarray, shape (rows, columns)
        Columns of gravity in one pose, of which the first two are cosine and sine of the angle.
    position : ndarray, shape (rows,)
        Joint angle. [deg]
    pose : ndarray, shape (rows,)
        Number of the pose, NaN where unknown.
    pair : ndarray of int, shape (rows,)
        Number of the pair.

    Returns
    -------
    tuple of tuple of int
        Poses of each further gravity, by their numbers.

    Examples
    --------
    Three poses; in the second the joint carries less:

    >>> import numpy as np
    >>> pose, pair = np.repeat([0.0, 1.0, 2.0], 60), np.repeat(np.arange(15), 12)
    >>> position = np.tile(np.arange(5.0, 180.0, 15.0), 15)
    >>> angle = np.radians(position)
    >>> columns = np.column_stack([np.cos(angle), np.sin(angle), np.ones(180)])
    >>> noise = np.random.default_rng(1).normal(0, 0.1, 180)
    >>> load = np.where(pose == 1, 30.0, 40.0) * columns[:, 0] + noise
    >>> gravities_by_pose(load, columns, position, pose, pair)
    ((1,),)
    """
    numbers, counts = np.unique(pose[np.isfinite(pose)], return_counts=True)
    if len(numbers) < 2:
        return ()
    order = numbers[np.argsort(-counts, kind="stable")].astype(int).tolist()
    shared: list[list[int]] = [[order[0]]]
    for number in order[1:]:
        own = pose == number
        if len(np.unique(position[own])) < 3:
            # two angles or fewer tell no cosine from a sine
            shared[0].append(number)
            continue
        for one in shared:
            chosen = own | np.isin(pose, one)
            if not _differ(load[chosen], columns[chosen], own[chosen], pair[chosen]):
                one.append(number)
                break
        else:
            if len(shared) <= _MOST:
                shared.append([number])
            else:
                shared[0].append(number)
    return tuple(tuple(sorted(one)) for one in shared[1:])


def _differ(load: Array, columns: Array, own: Flags, pair: Indices) -> bool:
    """Return whether some rows have another cosine and sine than the others.

    A Wald test with the covariance of pairs, or of rows where there are few pairs.
    """
    from frictioncli.distributions import f_tail  # not needed to read a log

    more = columns[:, :2] * own[:, np.newaxis]
    all_columns = np.hstack([columns, more])
    size = np.linalg.norm(all_columns, axis=0)
    kept = size > 0
    scaled = all_columns[:, kept] / size[kept]
    inverse = np.linalg.pinv(scaled.T @ scaled, rcond=_TOLERANCE, hermitian=True)
    solution = inverse @ (scaled.T @ load)
    residual = load - scaled @ solution
    pairs = min(len(np.unique(pair[own])), len(np.unique(pair[~own])))
    if pairs < _FEW_PAIRS:
        freedom = max(len(load) - scaled.shape[1], 1)
        covariance = inverse * float(residual @ residual) / freedom
    else:
        _, code = np.unique(pair, return_inverse=True)
        scores = np.zeros((code.max() + 1, scaled.shape[1]))
        np.add.at(scores, code, scaled * residual[:, np.newaxis])
        freedom = max(pairs - 1, 1)
        covariance = inverse @ (scores.T @ scores) @ inverse * pairs / freedom
    tested = slice(int(kept[:-2].sum()), None)
    change, spread = solution[tested], covariance[tested, tested]
    wald = float(change @ np.linalg.pinv(spread, rcond=_TOLERANCE, hermitian=True) @ change)
    return bool(f_tail(wald / max(len(change), 1), len(change), freedom) < _ALPHA)
