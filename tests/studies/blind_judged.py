"""What is right and what is wrong of what is said of a joint of the blind study."""

from collections.abc import Mapping, Sequence

import numpy as np

from frictioncli.arrays import Array, Flags
from frictioncli.simulator.planted.unlisted import UNLISTED_EFFECTS
from tests.studies.blind_rows import Joint

AXES: Mapping[str, frozenset[str]] = {one.name: frozenset(one.axes) for one in UNLISTED_EFFECTS}
"""Axes along which an effect that no catalogue lists shows."""

SAME_HISTORY = 0.9
"""A history is right if it says of as many of the pairs whether the change was there."""

LEAST_OVERLAP = 0.05
"""A change is on the day kept out where it is in as great a share of all pairs there."""


def located(joint: Joint) -> bool:
    """Return whether structure is found along an axis along which what is hidden shows."""
    if joint.structure is None:
        return False
    return frozenset(joint.structure["axis"]) == AXES[joint.world.hidden]


def unnamed_and_located(joint: Joint) -> bool:
    """Return whether what no catalogue lists is left without a name and located."""
    return joint.verdict == "unnamed" and located(joint)


def said_as_such(joint: Joint) -> bool:
    """Return whether a change is named, with when it was there, and whether it was on the new day.

    The history counts on the day seen; of the day kept out only whether the change was there.
    """
    name, seen = joint.world.hidden, joint.numbers["share_seen"]
    truth = joint.hidden[0]["stretches"]
    there = sum(max(0.0, end - max(begin, seen)) for begin, end in truth) >= LEAST_OVERLAP
    return any(
        name in cause["effects"]
        and cause.get("holds_on_new_run") is there
        and same_history(truth, stretches(cause.get("parameters", {})), seen)
        for cause in joint.causes
    )


def stretches(parameters: Mapping[str, Sequence[float | None]]) -> list[tuple[float, float]]:
    """Return the stretches of a history from its shape parameters, as shares of all pairs."""
    found = []
    for name, (begin, *_) in parameters.items():
        if name.startswith("moment") and begin is not None:
            end = parameters.get(name.replace("moment", "end"), (1.0,))[0]
            found.append((begin, 1.0 if end is None else end))
    return found


def same_history(
    truth: Sequence[Sequence[float]], said: Sequence[Sequence[float]], seen: float
) -> bool:
    """Return whether a history is said of nearly all pairs of the runs seen as it was.

    Parameters
    ----------
    truth, said : sequence of (float, float)
        Stretches, as shares of all pairs.
    seen : float
        Share of the pairs that are in the runs seen.
    """
    share = np.linspace(0.0, seen, 1000, endpoint=False)
    return bool(np.mean(_presence(truth, share) == _presence(said, share)) >= SAME_HISTORY)


def _presence(stretches: Sequence[Sequence[float]], share: Array) -> Flags:
    there = np.zeros(len(share), dtype=bool)
    for begin, end in stretches:
        there |= (share >= begin) & (share < end)
    return there


def right(joint: Joint) -> str:
    """Return in one word what a joint's diagnosis is worth."""
    kind = joint.world.kind
    if joint.wrong:
        return "WRONG"
    if kind == "unlisted":
        good = unnamed_and_located(joint)
    elif kind == "change":
        good = said_as_such(joint)
    elif kind in ("clean", "ordinary"):
        good = True
    elif not joint.held:
        return "MISSED" if joint.shows else "unseen"
    elif not joint.alone:
        return "in set"
    else:
        good = True
    return "ok" if good else "MISSED"
