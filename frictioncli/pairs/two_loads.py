r"""Moves that carry a load and moves that do not: a gripper's load that no channel tells.

Where a move forward carries another load than its partner in reverse, half of the difference
counts as friction. The torques of all moves are fitted by gravity and friction as of equation (16),
with one gravity for each of two groups of moves; each move then joins the group that fits it
better, in turns (clusterwise regression [1]_). Drift, warming and errors of the form are gradual
or common to all moves and leave no two groups that alternate.

References
----------
.. [1] H. Späth, "Algorithm 39: clusterwise linear regression," Computing 22, 1979,
   doi:10.1007/BF02265317.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd
import pyarrow as pa

from frictioncli.arrays import Array, Indices

_FEWEST_PAIRS = 20
"""Pairs from which groups are looked for."""

_MOST_PAIRS = 1000
"""Pairs that are looked at, the first ones."""

_MOST_ROWS = 50_000
"""Rows of a joint that are looked at."""

_LEFT = 0.3
"""Share of the RMS misfit that two groups leave at most; of joints with one load it is 0.6 to 1."""

_RARE = 0.1
"""Share of the moves in either group, and of the moves with another load than the move before."""

_MIXED = 0.05
"""Share of the pairs with two loads from which a user should know."""

_COLUMNS = [
    *("run", "joint", "pair", "speed", "position", "motor_temperature"),
    *("torque_forward", "torque_reverse"),
]

_ROUNDS = 15

_AS_LIKELY = 1.05
"""Misfit of groups, relative to the least, up to which they are as likely."""

_ONE_SPEED = 0.2
"""Width of a class of speeds, in the logarithm."""


@dataclass(frozen=True, slots=True)
class TwoLoads:
    """Two loads that moves carry in turns.

    Attributes
    ----------
    difference : float
        RMS of their difference over the angles. [torque unit]
    mixed : float
        Share of the pairs whose moves carry different ones.
    sure : bool
        Whether that share is beyond doubt. Where the load goes with the speed, friction that the
        speed has and a load in one direction look alike.
    """

    difference: float
    mixed: float
    sure: bool = True

    def text(self, unit: str) -> str:
        """Return what a user should know, and what to do."""
        carry, counts = ("carry", "counts") if self.sure else ("may carry", "would count")
        return (
            f"its moves carry two loads in turns, which differ by {self.difference:.2g} {unit}; in"
            f" {self.mixed:.0%} of the pairs both moves {carry}"
            f" different ones, and half of the difference {counts} as friction: log what is carried"
            " (column payload, in kg)"
        )


def loads_in_turns(
    batches: Iterable[pa.RecordBatch], signs: Mapping[int, int], unit: str
) -> dict[int, str]:
    """Return a warning for each joint whose pairs are of moves with different loads, by joint.

    Parameters
    ----------
    batches : iterable of RecordBatch
        Rows of :data:`frictioncli.schemas.PAIRS`, of each joint in order of time.
    signs : mapping of int to int
        Sign convention of the joints.
    unit : str
        Unit of torque.
    """
    kept: dict[int, list[pd.DataFrame]] = {joint: [] for joint in signs}
    for batch in batches:
        for joint, rows in batch.select(_COLUMNS).to_pandas().groupby("joint"):
            of_joint = kept.get(int(joint), [])
            if sum(map(len, of_joint)) < _MOST_ROWS:
                of_joint.append(rows)
        if all(sum(map(len, parts)) >= _MOST_ROWS for parts in kept.values()):
            break
    texts = {}
    for joint, parts in kept.items():
        found = two_loads(pd.concat(parts), signs[joint]) if parts else None
        if found is not None and found.mixed >= _MIXED:
            texts[joint] = found.text(unit)
    return texts


def two_loads(pairs: pd.DataFrame, sign: int) -> TwoLoads | None:
    """Return the two loads that the moves of a joint carry in turns; None where there is one.

    Parameters
    ----------
    pairs : DataFrame
        Rows of :data:`frictioncli.schemas.PAIRS` of a single joint, in order of time.
    sign : {+1, -1}
        Sign convention of its log.
    """
    pair = pairs.groupby(["run", "pair"], sort=False, observed=True).ngroup().to_numpy()
    known = pair < _MOST_PAIRS
    known &= np.isfinite(pairs[["torque_forward", "torque_reverse"]]).all(axis=1).to_numpy()
    rows, pair = pairs[known], np.unique(pair[known], return_inverse=True)[1]
    count = int(pair.max(initial=-1)) + 1
    if count < _FEWEST_PAIRS or len(rows) < 3 * count:
        return None
    moves = _Moves.of(rows, pair, sign)
    one = moves.fit(np.zeros(2 * count))
    whole = max(float(np.linalg.norm(one.residual)), 1e-300)
    found = [moves.grouped(start) for start in (moves.first_groups(one), *moves.by_speed(count))]
    least = min(fit.left for fit, _ in found)
    likely = [one for one in found if one[0].left <= _AS_LIKELY * least and _is_in_turns(one[1])]
    if least > _LEFT * whole or not likely:
        return None
    fit, group = max(likely, key=lambda one: _mixed(one[1]))
    difference = float(np.sqrt(np.mean(np.square(moves.gravity @ fit.difference))))
    sure = min(_mixed(group) for _, group in likely) >= _MIXED
    return TwoLoads(difference, _mixed(group), sure)


def _mixed(group: Array) -> float:
    """Return the share of the pairs whose moves are of different groups."""
    forward, reverse = np.split(group, 2)
    return float(np.mean(forward != reverse))


def _is_in_turns(group: Array) -> bool:
    """Return whether both groups are common, and follow each other often."""
    share = float(np.mean(group))
    changes = max(float(np.mean(np.diff(side) != 0)) for side in np.split(group, 2))
    return min(share, 1 - share, changes) >= _RARE


@dataclass(frozen=True, slots=True)
class _Fit:
    """Coefficients of gravity, friction and the second gravity's difference, and the residual."""

    gravity: Array
    friction: Array
    alpha: float
    difference: Array
    residual: Array

    @property
    def left(self) -> float:
        """Length of the residual."""
        return float(np.linalg.norm(self.residual))


@dataclass(frozen=True, slots=True)
class _Moves:
    """Torques of moves: forward rows first, then those in reverse.

    Attributes
    ----------
    torque, way : ndarray, shape (rows,)
        Torque, and direction with the sign of friction in it.
    speed : ndarray, shape (rows,)
        Speed, always positive.
    gravity, friction : ndarray, shape (rows, n)
        Orthonormal columns that span gravity, and friction without load.
    move : ndarray of int, shape (rows,)
        Number of the move.
    """

    torque: Array
    way: Array
    speed: Array
    gravity: Array
    friction: Array
    move: Indices

    @classmethod
    def of(cls, rows: pd.DataFrame, pair: Indices, sign: int) -> "_Moves":
        angle = np.radians(rows["position"].to_numpy(float))
        speed = rows["speed"].to_numpy(float)
        root = np.sqrt(speed)
        warm = rows["motor_temperature"].to_numpy(float)
        warm = np.nan_to_num(warm - pd.Series(warm).mean())
        gravity = np.column_stack([np.cos(angle), np.sin(angle), np.ones(len(angle))])
        friction = np.column_stack([np.ones(len(angle)), root, root * warm])
        way = np.repeat([1.0, -1.0], len(angle)) * sign
        return cls(
            torque=rows[["torque_forward", "torque_reverse"]].to_numpy(float).T.ravel(),
            way=way,
            speed=np.concatenate([speed, speed]),
            gravity=_orthonormal(np.vstack([gravity, gravity])),
            friction=_orthonormal(way[:, np.newaxis] * np.vstack([friction, friction])),
            move=np.concatenate([pair, pair + int(pair.max()) + 1]),
        )

    def fit(self, group: Array) -> _Fit:
        """Return the least squares fit with a second gravity for the moves of group 1."""
        second = self.gravity * group[self.move][:, np.newaxis]
        ends = np.cumsum([self.gravity.shape[1], self.friction.shape[1], second.shape[1]])
        columns = np.column_stack([self.gravity, self.friction, second, np.zeros(len(second))])
        scale = 1.0
        for _ in range(4):
            # columns of length 1, so that the normal equations lose no digit that counts
            found = np.linalg.lstsq(columns.T @ columns, columns.T @ self.torque, rcond=1e-12)[0]
            gravity, friction, difference, alpha = np.split(found, ends)
            residual = self.torque - columns @ found
            alpha = alpha / scale
            squared = np.square(self.gravity @ gravity + second @ difference)
            scale = max(float(np.linalg.norm(squared)), 1e-300)
            columns[:, -1] = self.way * squared / scale
        return _Fit(gravity, friction, float(alpha[0]), difference, residual)

    def grouped(self, group: Array) -> tuple[_Fit, Array]:
        """Return the fit and the groups to which a start leads."""
        fit = self.fit(group)
        for _ in range(_ROUNDS):
            better = self.better_groups(fit)
            if np.array_equal(better, group) or better.min() == better.max():
                break
            group = better
            fit = self.fit(group)
        return fit, group

    def by_speed(self, count: int) -> list[Array]:
        """Return groups of the moves in one direction at one speed, for each that is common."""
        speed = np.zeros(2 * count)
        speed[self.move] = self.speed
        level = np.unique(np.round(np.log(speed) / _ONE_SPEED), return_inverse=True)[1]
        forward = np.arange(2 * count) < count
        groups = [
            ((level == one) & side).astype(float)
            for one in range(int(level.max()) + 1)
            for side in (forward, ~forward)
        ]
        return [one for one in groups if float(np.mean(one)) >= _RARE]

    def first_groups(self, fit: _Fit) -> Array:
        """Return groups by how much more load each move has, cut where both scatter least."""
        load = self.gravity @ fit.gravity
        weight = np.maximum(np.bincount(self.move, np.square(load)), 1e-300)
        more = np.bincount(self.move, fit.residual * load) / weight
        ascending = np.sort(more)
        below = np.arange(1, len(more))
        sums = np.cumsum(ascending)[:-1]
        apart = sums / below - (ascending.sum() - sums) / (len(more) - below)
        cut = ascending[int(np.argmax(below * (len(more) - below) * np.square(apart)))]
        return (more > cut).astype(float)

    def better_groups(self, fit: _Fit) -> Array:
        """Return the group that fits each move better."""
        misfit = []
        for state in (0.0, 1.0):
            load = self.gravity @ (fit.gravity + state * fit.difference)
            model = load + self.friction @ fit.friction + self.way * fit.alpha * np.square(load)
            misfit.append(np.bincount(self.move, np.square(self.torque - model)))
        return (misfit[1] < misfit[0]).astype(float)


def _orthonormal(columns: Array) -> Array:
    """Return orthonormal columns with the same span."""
    left, singular, _ = np.linalg.svd(columns, full_matrices=False)
    return np.asarray(left[:, singular > 1e-9 * singular[0]], dtype=np.float64)
