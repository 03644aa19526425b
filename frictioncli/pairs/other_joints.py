"""Samples of a joint while other joints of the same recording move, or stand elsewhere.

A joint that moves loads its neighbours with its inertia and turns the weight that they carry, which
the separation of friction and load cannot know. Such samples are left out, unless they are more
than half of what there is, or no pair would be left. Where the others come to stand elsewhere, in
another pose, gravity is another one: moves in different poses are no pair, unless none is left.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from frictioncli.arrays import Array, Flags, Numbers
from frictioncli.pairs.slices import reduce_slices, slice_indices

OTHER_MOVES = "other joint moves"
"""Reason why samples at constant speed are in no pair."""

STAND_ELSEWHERE = "other joints stop at other angles, or the payload changes"
"""Reason why samples of a move in a second pose or with a second payload are in no pair."""

OTHER_POSE = "the other joints are at other angles than for the partner"
"""Reason why samples whose partner has another pose are in no pair."""

LEFT_OUT = "left out"
KEPT = "used nonetheless; its torque includes what the others add"
"""What becomes of such samples."""

_MOST = 0.5
"""Share of a joint's samples at constant speed above which they are kept."""


@dataclass(slots=True)
class OtherMotion:
    """How many samples at constant speed were taken while another joint moved.

    Attributes
    ----------
    samples, shared : dict of int to int
        Samples in angle bins by joint, and those in bins during which another joint moved.
    seconds : dict of int to float
        Time that the latter took. [s]
    moves : dict of int to int
        Moves of the joint that hold some of them.
    others : dict of int to int
        The other joints that moved, as the sum of 2^(joint - 1).
    needed : set of int
        Joints of which no pair is left without such samples.
    across_poses : set of int
        Joints of which no pair is left in one pose.
    """

    samples: dict[int, int] = field(default_factory=dict)
    shared: dict[int, int] = field(default_factory=dict)
    seconds: dict[int, float] = field(default_factory=dict)
    moves: dict[int, int] = field(default_factory=dict)
    others: dict[int, int] = field(default_factory=dict)
    needed: set[int] = field(default_factory=set)
    across_poses: set[int] = field(default_factory=set)

    def add(
        self, joint: int, count: Numbers, segment: Numbers, shared: Flags, period: float
    ) -> None:
        """Add bins of a joint: their samples and moves, and whether another joint moved meanwhile.

        Parameters
        ----------
        joint : int
            The joint.
        count, segment : ndarray of int, shape (bins,)
            Samples and number of the move of each bin; a move is added at once.
        shared : ndarray of bool, shape (bins,)
            Whether another joint moved meanwhile.
        period : float
            Sampling period. [s]
        """
        self.samples[joint] = self.samples.get(joint, 0) + int(count.sum())
        found = int(count[shared].sum())
        self.shared[joint] = self.shared.get(joint, 0) + found
        self.seconds[joint] = self.seconds.get(joint, 0.0) + found * period
        self.moves[joint] = self.moves.get(joint, 0) + len(np.unique(segment[shared]))

    def share(self, joint: int) -> float:
        """Return the share of a joint's samples at constant speed while another one moved."""
        return self.shared.get(joint, 0) / max(self.samples.get(joint, 0), 1)

    def leaves_out(self, joint: int) -> bool:
        """Return whether such samples of a joint are left out."""
        return joint not in self.needed and 0 < self.share(joint) <= _MOST

    def tells_poses_apart(self, joint: int) -> bool:
        """Return whether only moves in one pose of the other joints are pairs of a joint."""
        known = not self.share(joint) or self.leaves_out(joint)
        return known and joint not in self.across_poses

    def facts(self, joint: int) -> dict[str, Any]:
        """Return what is known of such samples of a joint, as the tables of pairs state it."""
        others = self.others.get(joint, 0)
        return {
            "samples": self.shared[joint],
            "share": self.share(joint),
            "seconds": self.seconds[joint],
            "moves": self.moves[joint],
            "joints": [number + 1 for number in range(others.bit_length()) if others >> number & 1],
            "left_out": self.leaves_out(joint),
        }

    def kept(self, joints: Iterable[int]) -> dict[int, float]:
        """Return the share of such samples of those of some joints of which they are kept."""
        return {
            joint: self.share(joint)
            for joint in joints
            if self.share(joint) and not self.leaves_out(joint)
        }

    def texts(self, joints: Iterable[int]) -> list[str]:
        """Return a sentence for each of some joints during whose motion another one moves."""
        return [
            f"joint {joint}: another joint moves during {100 * self.share(joint):.0f} % of its"
            " motion at constant speed: " + (LEFT_OUT if self.leaves_out(joint) else KEPT)
            for joint in joints
            if self.share(joint)
        ] + [
            f"joint {joint}: no pair of moves in one pose of the other joints: used"
            " nonetheless; its friction includes half of the change of gravity between their poses"
            for joint in joints
            if joint in self.across_poses
        ]


def bins_with_marks(
    marked: Flags,
    position: Array,
    start: Numbers,
    stop: Numbers,
    width: float,
    segment: Numbers,
    number: Numbers,
) -> Flags:
    """Return which angle bins of segments hold a marked sample.

    Parameters
    ----------
    marked : ndarray of bool, shape (samples,)
        The marks.
    position : ndarray, shape (samples,)
        Joint angle. [deg]
    start, stop : ndarray of int, shape (segments,)
        First and past-the-end sample of each segment.
    width : float
        Width of the bins. [deg]
    segment, number : ndarray of int, shape (bins,)
        Segment and number of each bin.

    Returns
    -------
    ndarray of bool, shape (bins,)
        True where one sample or more is marked.
    """
    index = slice_indices(start, stop)
    marks = marked[index]
    if not marks.any():
        return np.zeros(len(segment), bool)
    owner = np.repeat(np.arange(len(start)), stop - start)[marks]
    crossed = np.floor(position[index[marks]] / width).astype(np.int64)
    lowest = min(int(crossed.min()), int(number.min(initial=0)))
    span = max(int(crossed.max()), int(number.max(initial=0))) - lowest + 1
    found: Flags = np.isin(segment * span + number - lowest, owner * span + crossed - lowest)
    return found


def joints_that_move(other_joints: Array, start: Numbers, stop: Numbers) -> int:
    """Return which other joints moved during segments, as the sum of 2^(joint - 1).

    Parameters
    ----------
    other_joints : ndarray, shape (samples,)
        The same for each sample; NaN where not known.
    start, stop : ndarray of int, shape (segments,)
        First and past-the-end sample of each segment.

    Examples
    --------
    >>> import numpy as np
    >>> joints_that_move(np.array([0.0, 5.0, 4.0, 2.0]), np.array([0]), np.array([3]))
    5
    """
    sets = np.unique(np.nan_to_num(other_joints[slice_indices(start, stop)])).astype(np.int64)
    return int(np.bitwise_or.reduce(sets)) if len(sets) else 0


def numbers_of_segments(number: Array, start: Numbers, stop: Numbers) -> tuple[Array, Flags]:
    """Return the number that most samples of each segment have, and the samples with another one.

    Parameters
    ----------
    number : ndarray, shape (samples,)
        Number of the pose, NaN while another joint moves; or payload [kg]. NaN where not known.
    start, stop : ndarray of int, shape (segments,)
        First and past-the-end sample of each segment.

    Returns
    -------
    number : ndarray, shape (segments,)
        The numbers, NaN where not known.
    other : ndarray of bool, shape (samples,)
        True where a sample of a segment has another number than the segment.

    Examples
    --------
    >>> import numpy as np
    >>> pose = np.array([1.0, np.nan, 2.0, 2.0, 3.0])
    >>> numbers_of_segments(pose, np.array([0, 4]), np.array([4, 5]))
    (array([2., 3.]), array([ True, False, False, False, False]))
    """
    other = np.zeros(len(number), bool)
    found = reduce_slices(np.fmin, number, start, stop)
    several = np.flatnonzero(reduce_slices(np.fmax, number, start, stop) > found)
    for segment in several.tolist():
        own = number[start[segment] : stop[segment]]
        values, counts = np.unique(own[np.isfinite(own)], return_counts=True)
        found[segment] = values[np.argmax(counts)]
        other[start[segment] : stop[segment]] = np.isfinite(own) & (own != found[segment])
    return found, other
