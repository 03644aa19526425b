"""Joints that have names instead of numbers: ``/joint_states/elbow/effort``, ``knee_pos``."""

import re
from collections.abc import Sequence

from frictioncli.logs.channels.channel_names import MEANINGS, POSITION, TORQUE, VELOCITY

_PARTS = re.compile(r"[_ .\-]+")
_PLAIN = re.compile(r"[^a-z0-9]")
_BODY = re.compile(
    r"joint|axis|achse|gelenk|shoulder|elbow|forearm|upperarm|wrist|finger|thumb|gripper|base|waist"
    r"|torso|neck|head|hip|thigh|knee|calf|shank|ankle|foot|wheel|pan|tilt|lift|yaw|pitch|roll",
    re.I,
)
"""What names of joints contain; other words in front of a quantity say what kind it is of."""

COMMAND = re.compile(r"cmd|command|target|desired|setpoint|soll|goal|reference", re.I)
"""Words of names that tell what was asked for, not what was measured."""

_NO_JOINT = re.compile(
    r"(?:err|filt|est|model|ext|grav|fric|comp|limit|ref|des|set|act|meas|obs|sim|calc|pred)\w*"
    r"|min|max|mean|std|rms|raw|offset|ff|fb|fbk|real|motor|link|load|drive|total|norm|dot"
    r"|left|right|input|output|in|out|[dmlxyz]|\d+",
    re.I,
)
"""Words beside a quantity that say what kind it is of; others are joints, if enough have all."""
_LEAST_UNKNOWN = 3
"""Least number of joints with a position and a torque whose names nothing else tells."""

_MOST_JOINTS = 99
"""As many joints as a log may have by their numbers, which have two digits."""
_OF_JOINTS = (POSITION, VELOCITY, TORQUE)
_LONGEST = 3
"""Greatest number of words of a quantity's name, as in ``actual joint position``."""


def named_joints(names: Sequence[str], least: int = 2) -> dict[int, tuple[str, str]]:
    """Return the joint's name, and the name of the quantity, of columns that have both.

    A joint has a position and a torque of its name, and only where enough joints have such names,
    and not hundreds, does a name stand for one.

    Parameters
    ----------
    names : sequence of str
        Names of the columns, without units.
    least : int, optional
        How many joints are enough: one where a log has no other position.

    Returns
    -------
    dict of int to (str, str)
        By index of the column.

    Examples
    --------
    >>> columns = ["t", "hip_pos", "hip_torque", "knee_pos", "knee_torque", "target_pos"]
    >>> named_joints(columns)[3]
    ('knee', 'pos')
    """
    known = _joints_of(names, least, known=True)
    more = _joints_of(names, _LEAST_UNKNOWN, known=False)
    return more if len(more) > len(known) else known


def _joints_of(names: Sequence[str], least: int, *, known: bool) -> dict[int, tuple[str, str]]:
    found = {column: parts for column, name in enumerate(names) if (parts := _parted(name, known))}
    quantities: dict[str, set[str]] = {}
    for joint, text in found.values():
        quantities.setdefault(joint, set()).add(MEANINGS[_key(text)].quantity)
    joints = {name for name, of_it in quantities.items() if {POSITION, TORQUE} <= of_it}
    if not least <= len(joints) <= _MOST_JOINTS:
        return {}
    return {column: parts for column, parts in found.items() if parts[0] in joints}


def _parted(name: str, known: bool) -> tuple[str, str] | None:
    """Return the names of joint and quantity; None where the name is of another kind.

    If not ``known``, words that are no part of a body may name a joint.
    """
    path = [part for part in name.split("/") if part]
    if name.startswith("/") and len(path) > 1:
        # the name of a topic is no joint's: of a joint's values at least the last part differs
        return (path[-2], path[-1]) if _is_quantity(path[-1]) else None
    if COMMAND.search(name):
        return None
    words = _PARTS.split(name)
    for count in range(1, min(_LONGEST, len(words) - 1) + 1):
        for joint, quantity in (
            (words[:-count], words[-count:]),
            (words[count:], words[:count]),
        ):
            if _is_quantity("".join(quantity)) and _may_be_joint(joint, known):
                return "_".join(joint), "_".join(quantity)
    return None


def _may_be_joint(words: Sequence[str], known: bool) -> bool:
    if _BODY.search("_".join(words)):
        return True
    # FR_0 is a joint, 0 none: numbers are read elsewhere
    return (
        not known
        and not _NO_JOINT.fullmatch(words[0])
        and not any(_NO_JOINT.fullmatch(word) and not word.isdigit() for word in words)
    )


def _is_quantity(text: str) -> bool:
    meaning = MEANINGS.get(_key(text))
    return meaning is not None and meaning.quantity in _OF_JOINTS


def _key(text: str) -> str:
    return _PLAIN.sub("", text.lower())
