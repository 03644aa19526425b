"""The parts of a column's name: quantity, joint number and unit."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

from frictioncli.logs.channels import units
from frictioncli.logs.channels.channel_names import (
    MEANINGS,
    MOTOR_TEMPERATURE,
    TIME,
    TOOL,
    Meaning,
)
from frictioncli.logs.channels.named_joints import COMMAND

_UNIT = re.compile(r"^(?P<name>.*?)[\[(](?P<unit>[^\[\]()]*)[\])]\s*$")
_UNIT_LAST = re.compile(
    r"^(?P<name>.+)[_ ](?P<unit>mNm|Nm|mA|degC|deg|rad|(?:deg|rad)[_/]?s|dps|rpm|RPM|ms|us|ns)$"
)
_UNIT_OF_QUANTITY = re.compile(
    r"^(?P<name>.+?)(?:[_ ]in)?[_ /,](?P<unit>"
    r"(?:deg(?:rees?)?|grad|°|rad(?:ians?)?)(?:(?:[_ ]per[_ ]|[_/])?s(?:ec)?|ps)?|rpm"
    r"|mrad|udeg|kgf[_.·*]?c?m|lbf[_.·*]?(?:ft|in)|ozf[_.·*]?in"
    r"|turns?|revs|rot|(?:turns?|revs?|rot)(?:[_ ]per[_ ]|[_/])s(?:ec)?"
    r"|[mk]?N[_ .·*]?m|N[_ .·*]?cm|mA|percent|pct|%|deg[_ ]?[CF]|°[CF]|[CFK]|celsius|kelvin"
    r"|s|sec|seconds?|[mun]s|100ns|kg|g)(?P<joint>[_ ][AJ]?\d{1,2})?$",
    re.I,
)
_JOINT_LAST = re.compile(
    r"^(?P<name>.*?)(?:(?<=[a-z])[AJ]|(?<![ _.\-(\[])[ _.\-(\[]+"
    r"(?:[AaJj](?:xis|chse|oint)?|[Gg]elenk)?[ _]?|)"
    r"(?P<joint>\d{1,2})[)\]]?$"
)
_JOINT_FIRST = re.compile(
    r"^(?:joint|axis|axle|achse|gelenk|motor|actuator|servo|drive|ax|[aj])[ _.]?(?P<joint>\d{1,2})"
    r"[ _.\-/]+(?P<name>.+)$",
    re.I,
)
MEASURED = re.compile(
    r"(?:^|(?<=[ _.\-]))(?:feedback|fbk|fdb|fb|actual|act|measured|meas|msr|present|inst|ist|value"
    r"|averaged|average|avg|joint[ _]?states?"
    r"|current(?=[ _.\-](?:joint[ _.\-])?(?:pos|ang|vel|speed|torque|temp)))(?=$|[ _.\-\d\[(])",
    re.I,
)
"""Words that only say that a value was measured; ``current`` before what is no current."""
WORD_ENDS = re.compile(r"(?<=[a-z])(?=[A-Z])")
"""Where a word of a name in camel case ends."""
_OF_MESSAGE = re.compile(
    r"^(?P<axis>axis\d\.)?(?:field|msg|data|feedback|robot|arm|measured|actual|sensors?|encoder"
    r"|controller|motor\.(?:current_control|foc)|motor_thermistor)\.",
    re.I,
)
"""What ``rostopic echo -p``, objects of JSON and others put before each value of a message."""
_SYMBOL = re.compile(r"^T[ _]?(?P<joint>\d{1,2})$", re.I)
_DESIRED = re.compile(r"(?<![a-z])(?:d?q|tau(?:_j)?|theta)_d(?![a-z])", re.I)
"""Desired values, as Franka names them; ``qd`` is a velocity."""
_PER = re.compile(r"[_ ]per[_ ]|_(?=s(?:ec)?$)", re.I)
_NO_KEY = re.compile(r"[^a-z0-9]")
_JOINT_IN_BRACKETS = re.compile(r"^(?:[AaJj](?:xis|chse|oint)?|[Gg]elenk)?[ _.]?\d{1,2}$")
_JOINT_ALONE = re.compile(r"^(?:joint|axis|achse|gelenk|motor|[aj])[ _]?\d{1,2}$", re.I)
_PARTS = re.compile(r"[/.]")


@dataclass(frozen=True, slots=True)
class KnownName:
    """What a name without its unit stands for.

    Attributes
    ----------
    meaning : Meaning
        Quantity, side of the gear and rank.
    joint : int or None
        Joint number as it is written; None where the name has none.
    family : str
        The name without joint number.
    """

    meaning: Meaning
    joint: int | None
    family: str


def split_unit(column: str) -> tuple[str, str]:
    """Return a column's name without its unit, and the unit as written ("" where there is none).

    Units stand in brackets, or are the last words of the name, before the joint's number or after
    it. Units of few letters, and those that also mean something else, count behind a known name of
    their quantity only: ``temp_C`` has one, ``phase_C`` has none.

    Examples
    --------
    >>> split_unit("AxisPos_Act1 [deg]")
    ('AxisPos_Act1', 'deg')
    >>> split_unit("tau_mNm")
    ('tau', 'mNm')
    >>> split_unit("torque_nm_2")
    ('torque_2', 'nm')
    >>> split_unit("q(2)")
    ('q(2)', '')
    """
    bare = column.strip().strip('"')
    found = _UNIT.match(bare)
    known = _split_known(bare) if found is None else None
    if known is not None:
        return known
    found = found or _UNIT_LAST.match(bare)
    if found is None or _JOINT_IN_BRACKETS.match(found["unit"].strip()):
        return bare, ""
    name, unit = found["name"].rstrip(), found["unit"].strip()
    if unit in ("x", "y", "z", "rx", "ry", "rz"):  # an axis of a coordinate frame, not a unit
        return f"{name} {unit}", ""
    return name, unit


def _split_known(bare: str) -> tuple[str, str] | None:
    """Return what :func:`split_unit` does where the unit is one of the quantity that has the name.

    ``T_s`` is no time, and ``t_k`` no temperature: that of a surface, and a number of a sample.
    """
    found = _UNIT_OF_QUANTITY.match(bare)
    if found is None:
        return None
    unit = _PER.sub("/", found["unit"]).replace("_", " ")
    known = known_name(found["name"], unit)
    if known is None or units.canonical(unit, known.meaning.quantity) is None:
        return None
    if found["name"] == ("T" if known.meaning.quantity == TIME else "t"):
        return None
    return found["name"] + (found["joint"] or ""), unit


def unit_in_name(column: str, quantity: str) -> str | None:
    """Return the unit of a quantity that a column's name has, None where it has none.

    Examples
    --------
    >>> unit_in_name("pos_estimate [turns]", "position")
    'turn'
    """
    return units.canonical(split_unit(column)[1], quantity)


def known_name(name: str, unit: str) -> KnownName | None:
    """Return what a name without its unit stands for, None where it is not known.

    ``T [°C]`` and ``T2 [°C]`` are no times.

    Parameters
    ----------
    name, unit : str
        As of :func:`split_unit`.

    Examples
    --------
    >>> known_name("arm.joint_2.position", "").joint
    2
    >>> known_name("T3", "degC").meaning.quantity
    'motor_temperature'
    """
    known = None if _DESIRED.search(name) else _first_known(_spellings(name))
    if not unit or units.canonical(unit, MOTOR_TEMPERATURE) is None:
        return known
    if known is not None and known.meaning.quantity == TIME:
        return replace(known, meaning=MEANINGS["temperature"])
    symbol = _SYMBOL.match(name)
    if known is None and symbol is not None:
        return KnownName(MEANINGS["temperature"], int(symbol["joint"]), "t")
    return known


def _first_known(texts: Sequence[str]) -> KnownName | None:
    """Return what the first known one of several spellings of a name stands for."""
    for text in texts:
        meaning = MEANINGS.get(key_of(text))
        if meaning is not None:
            return KnownName(meaning, None, key_of(text))
        for pattern in (_JOINT_FIRST, _JOINT_LAST):
            parts = pattern.match(text)
            meaning = MEANINGS.get(key_of(parts["name"])) if parts else None
            if parts and meaning and meaning.quantity not in (TIME, TOOL):
                return KnownName(meaning, int(parts["joint"]), key_of(parts["name"]))
    return None


def _spellings(name: str) -> list[str]:
    """Return a name, and of a path that commands nothing its last parts.

    Of ROS topics such as ``/joints/joint_2/position`` these alone, of ``arm.joint_2.position`` as
    well. Then the same without words that only say that a value was measured.
    """
    name = _OF_MESSAGE.sub(r"\g<axis>", name)
    texts, path = [name], _PARTS.split(name)
    if COMMAND.search(name):
        return texts
    if name.startswith("/"):
        path = name.split("/")
        texts = ["_".join(path[-2:]), path[-1]]
    elif len(path) > 2 and _JOINT_ALONE.match(path[-2]):
        texts.append("_".join(path[-2:]))
    spaced = [MEASURED.sub("", WORD_ENDS.sub(" ", text)) for text in texts]
    plain = [" ".join(text.replace("_", " ").split()) for text in spaced]
    return [*texts, *(text for text in plain if text)]


def key_of(name: str) -> str:
    """Return a name as a key of :data:`MEANINGS`."""
    lower = name.lower().replace("ä", "ae").replace("ö", "oe").replace("ü", "ue")
    return _NO_KEY.sub("", lower.replace("ß", "ss"))


def key_with_joint(name: str) -> tuple[str, int | None]:
    """Return a name without its joint number as a key, and the number; None where it has none.

    Examples
    --------
    >>> key_with_joint("Axis 2 Torque Reference"), key_with_joint("torque_ref")
    (('torquereference', 2), ('torqueref', None))
    """
    for pattern in (_JOINT_FIRST, _JOINT_LAST):
        if parts := pattern.match(name):
            return key_of(parts["name"]), int(parts["joint"])
    return key_of(name), None
