"""Poses: where the other joints of an arm stand while one of them moves.

The weight that a joint carries depends on where the joints beyond it stand, and the direction in
which it pulls on where those before it stand. Each angle at which a joint stands is a *place* of
it; the places of all other joints are a joint's pose. Poses are numbered in the order in which they
occur, over all logs that are read together.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from frictioncli.arrays import Array, Flags, Numbers

SAME_PLACE = 1.0
"""Angles that differ by less are one place: gravity changes by less than 2 % between them. [deg]"""

_MOST_PLACES = 1000
"""Places of a joint that are told apart; a joint that creeps has any number of them."""

_STATED = 64
"""Poses of a joint whose angles are stated beside the samples."""

_TURN = 360.0  # [deg]

_MOVES, _UNKNOWN = -1, 0


@dataclass(slots=True)
class Poses:
    """Poses of each joint of an arm that have occurred so far.

    Attributes
    ----------
    angles : dict of int to list of float
        Angles of the places of each joint. [deg]
    numbers : dict of int to dict of tuple to int
        Number of each pose of a joint, from 0, by the other joints and their places.
    """

    angles: dict[int, list[float]] = field(default_factory=dict)
    numbers: dict[int, dict[tuple[tuple[int, int], ...], int]] = field(default_factory=dict)

    def places(self, joint: int, position: Array, stands: Flags) -> Numbers:
        """Return the place of a joint in each row, from 1; -1 while it moves, 0 where not known.

        A row is at the first place within :data:`SAME_PLACE`, so that nothing depends on how a log
        is cut into pieces.

        Parameters
        ----------
        joint : int
            The joint.
        position : ndarray, shape (rows,)
            Its position. [deg]
        stands : ndarray of bool, shape (rows,)
            Whether it stands.

        Examples
        --------
        >>> import numpy as np
        >>> Poses().places(2, np.array([0.1, 359.9, 20.0, 90.0]), np.array([1, 1, 0, 1], bool))
        array([ 1,  1, -1,  2])
        """
        known = self.angles.setdefault(joint, [])
        found = np.full(len(position), _MOVES)
        finite = np.isfinite(position)
        found[stands & ~finite] = _UNKNOWN
        waiting = np.flatnonzero(stands & finite)
        number = 0
        while len(waiting):
            if number == len(known):
                if number == _MOST_PLACES:
                    break
                known.append(float(position[waiting[0]] % _TURN))
            away = np.abs((position[waiting] - known[number] + _TURN / 2) % _TURN - _TURN / 2)
            number += 1
            found[waiting[away <= SAME_PLACE]] = number
            waiting = waiting[away > SAME_PLACE]
        return found

    def of(self, joint: int, places: Mapping[int, Numbers]) -> Array:
        """Return the number of a joint's pose in each row, NaN while another joint moves.

        Parameters
        ----------
        joint : int
            The joint.
        places : mapping of int to ndarray of int, shape (rows,)
            Places of all joints, as of :meth:`places`.

        Examples
        --------
        >>> import numpy as np
        >>> Poses().of(1, {1: np.array([1, -1, 1, 2]), 2: np.array([1, 1, -1, 2])})
        array([ 0.,  0., nan,  1.])
        """
        numbers = self.numbers.setdefault(joint, {})
        others = sorted(other for other in places if other != joint)
        rows = np.stack([places[other] for other in others], axis=1)
        starts = np.flatnonzero((rows[1:] != rows[:-1]).any(axis=1)) + 1
        starts = np.append(0, starts)[: len(rows)]
        found = []
        for start in starts.tolist():
            pose = tuple(zip(others, rows[start].tolist(), strict=True))
            moves = any(place == _MOVES for _, place in pose)
            found.append(np.nan if moves else numbers.setdefault(pose, len(numbers)))
        return np.repeat(np.array(found, float), np.diff(np.append(starts, len(rows))))

    def facts(self) -> dict[str, list[dict[str, float]]]:
        """Return the first poses of each joint as the angles of the other joints [deg]."""
        return {
            str(joint): [
                {
                    str(other): round(self.angles[other][place - 1], 2) % _TURN
                    for other, place in pose
                    if place != _UNKNOWN
                }
                for pose in list(numbers)[:_STATED]
            ]
            for joint, numbers in sorted(self.numbers.items())
            if numbers
        }
