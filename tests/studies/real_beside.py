"""Results of the program beside those of the independent script: which speeds, how far apart."""

from collections.abc import Sequence

from tests.studies.real_chain import Attempt, JointResult, SpeedFriction
from tests.studies.real_independent import Independent

_MOST = 3
"""Speeds that are shown."""


def counterpart(
    result: JointResult, attempt: Attempt, beside: Sequence[Independent]
) -> Independent | None:
    """Return the independent figures of a joint, of the same unit and side of the gear if any.

    Where both know one joint, its number is free.
    """
    single = len({one.joint for one in beside}) == 1 and len(attempt.joints) == 1
    own = [one for one in beside if one.joint == result.joint or single]
    return next((one for one in own if alike(result, one)), own[0] if own else None)


def alike(result: JointResult, other: Independent) -> bool:
    """Return whether both have the same unit, measured on the same side of the gear."""
    return (result.unit, result.side) == (other.unit, other.side)


def chosen_speeds(result: JointResult, other: Independent | None) -> list[SpeedFriction]:
    """Return the friction at three speeds at most, the lowest and the highest among them.

    Speeds at which there is an independent figure come first; a regression has no more than three.
    """
    if result.way == "regression":
        return result.frictions
    known = [one for one in result.frictions if other and other.at(one.speed) is not None]
    among = known or result.frictions
    if len(among) <= _MOST:
        return among
    return [among[0], among[len(among) // 2], among[-1]]


def deviations(result: JointResult, other: Independent | None) -> list[float]:
    """Return the program's friction over the independent one minus 1, at the speeds shown."""
    found = []
    for one in chosen_speeds(result, other):
        value = None if other is None else other.at(one.speed)
        if value:
            found.append(one.friction / value - 1)
    return found


def largest_change(one: Attempt, other: Attempt) -> float | None:
    """Return by how much friction differs at most between two runs of the chain, as a share.

    None where they have no joint and speed in common. Where both know a single joint, its number
    does not matter.
    """
    single = len(one.joints) == 1 and len(other.joints) == 1
    changes = []
    for left in one.joints:
        for right in other.joints:
            if left.joint != right.joint and not single:
                continue
            for a in left.frictions:
                near = [b for b in right.frictions if abs(b.speed - a.speed) < 0.01 * a.speed]
                changes += [abs(b.friction / a.friction - 1) for b in near]
    return max(changes, default=None)
