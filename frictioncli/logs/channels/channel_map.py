"""The mapping file: columns, units and text form given by the user where detection fails."""

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from frictioncli.errors import MappingError
from frictioncli.logs.channels import units
from frictioncli.logs.channels.channel_names import (
    CHANNELS,
    JOINT_SIDE,
    MOTOR_SIDE,
    POSITION,
    TORQUE,
    VELOCITY,
)
from frictioncli.logs.channels.map_entries import (
    CSV_KEYS,
    MAX_COLUMN,
    check_keys,
    csv_hints,
    joint_number,
    listed,
    ratio,
    scale,
    shown,
    toml_document,
    torque_constant,
)
from frictioncli.logs.log_source import CsvHints
from frictioncli.plain_text import whole_number

_SECTIONS = ("channels", "units", "scale", "side", "csv", "joint")
_SIDED = (POSITION, VELOCITY, TORQUE)
_JOINT_KEYS = ("number", "gear_ratio", "rated_torque", "torque_constant")
_INLINE = re.compile(rf"\s*({'|'.join((*CHANNELS, 'joint'))})\s*=")


@dataclass(frozen=True, slots=True, kw_only=True)
class ChannelMap:
    """The content of a mapping file.

    Attributes
    ----------
    channels : dict of str to str
        Column name by quantity.
    units : dict of str to str
        Unit by quantity, a key of :data:`frictioncli.logs.channels.units.FACTORS`.
    scales : dict of str to float
        Factor by quantity from the numbers in the log to its unit, for counts of a converter.
    sides : dict of str to str
        Side of the gear, ``joint`` or ``motor``, of position, velocity and torque.
    hints : CsvHints
        Form of the text.
    joint : int or None
        Number of the joint, from 1.
    gear_ratio : float or None
        Motor turns per joint turn, negative where they turn in opposite directions. [-]
    rated_torque : float or None
        Torque that 100 % stands for, where torque is in percent. [N·m]
    torque_constant : float or str or None
        Torque at the joint per motor current, or ``auto``. [N·m/A]
    """

    channels: dict[str, str] = field(default_factory=dict)
    units: dict[str, str] = field(default_factory=dict)
    scales: dict[str, float] = field(default_factory=dict)
    sides: dict[str, str] = field(default_factory=dict)
    hints: CsvHints = field(default_factory=CsvHints)
    joint: int | None = None
    gear_ratio: float | None = None
    rated_torque: float | None = None
    torque_constant: float | str | None = None


def read_map(path: Path) -> ChannelMap:
    r"""Read a mapping file, or a map in one line such as ``time=1,position=2:rad,torque=5:A``.

    Raises
    ------
    MappingError
        If it is not TOML, or has an unknown section, key, unit or value.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     file = Path(folder, "channels.toml")
    ...     _ = file.write_text('[channels]\ntorque = "M2"\n[units]\ntorque = "mNm"\n')
    ...     channel_map = read_map(file)
    >>> channel_map.channels, channel_map.units
    ({'torque': 'M2'}, {'torque': 'mN·m'})
    """
    if is_inline(path):
        return _inline_map(str(path))
    document = toml_document(path, _SECTIONS)
    check_keys(path, "section", document, _SECTIONS)
    sections = {name: document.get(name, {}) for name in _SECTIONS}
    for name, section in sections.items():
        if not isinstance(section, dict):
            raise MappingError(f"{path}: {name} = {shown(section)}; expected a section [{name}]")
    channels, channel_units = sections["channels"], sections["units"]
    check_keys(path, "name in [channels]", channels, CHANNELS)
    check_keys(path, "name in [units]", channel_units, CHANNELS)
    check_keys(path, "name in [scale]", sections["scale"], CHANNELS)
    check_keys(path, "name in [side]", sections["side"], _SIDED)
    check_keys(path, "key in [csv]", sections["csv"], CSV_KEYS)
    check_keys(path, "key in [joint]", sections["joint"], _JOINT_KEYS)
    for name, column in channels.items():
        is_number = isinstance(column, int) and column is not True and 1 <= column <= MAX_COLUMN
        if not is_number and not (isinstance(column, str) and column.strip()):
            raise MappingError(
                f"{path}: [channels] {name} = {shown(column)}; expected a column name, or its"
                " number from 1"
            )
    for name, side in sections["side"].items():
        if side not in (JOINT_SIDE, MOTOR_SIDE):
            raise MappingError(f"{path}: [side] {name} = {shown(side)}; expected joint or motor")
    scales = {name: scale(path, name, value) for name, value in sections["scale"].items()}
    # what is scaled has the unit that is given, not the one in its header
    own_units = {name: next(iter(units.FACTORS[name])) for name in scales}
    return ChannelMap(
        channels={name: str(column) for name, column in channels.items()},
        scales=scales,
        sides=dict(sections["side"]),
        units=own_units | {name: _unit(path, name, text) for name, text in channel_units.items()},
        hints=csv_hints(path, sections["csv"]),
        joint=joint_number(path, sections["joint"].get("number")),
        gear_ratio=ratio(path, "gear_ratio", sections["joint"].get("gear_ratio")),
        rated_torque=ratio(path, "rated_torque", sections["joint"].get("rated_torque")),
        torque_constant=torque_constant(path, sections["joint"].get("torque_constant")),
    )


def is_inline(path: Path) -> bool:
    """Return whether the text given in place of a mapping file is a map in one line.

    Examples
    --------
    >>> is_inline(Path("time=1,position=2:rad")), is_inline(Path("channels.toml"))
    (True, False)
    """
    return _INLINE.match(str(path)) is not None and not path.exists()


def _inline_map(text: str) -> ChannelMap:
    """Return the map of a line of ``name=column`` or ``name=column:unit``, between commas."""
    where = Path("--map")
    channels: dict[str, str] = {}
    channel_units: dict[str, str] = {}
    joint: int | None = None
    for entry in text.split(","):
        name, equals, value = entry.partition("=")
        name, value = name.strip(), value.strip()
        if not equals or not value:
            raise MappingError(f"--map: {entry!r}; expected name=column or name=column:unit")
        if name == "joint":
            joint = joint_number(where, whole_number(value) or value)
            continue
        check_keys(where, "name", [name], (*CHANNELS, "joint"))
        column, colon, unit = value.rpartition(":")
        channels[name] = column.strip() if colon else value
        if colon:
            channel_units[name] = _unit(where, name, unit)
    return ChannelMap(channels=channels, units=channel_units, joint=joint)


def _unit(path: Path, name: str, text: Any) -> str:
    unit = units.canonical(text, name) if isinstance(text, str) else None
    if unit is None or unit not in units.FACTORS[name]:
        raise MappingError(
            f"{path}: [units] {name} = {shown(text)}; expected one of"
            f" {listed(units.FACTORS[name])}; for anything else give its size with [scale] {name}"
        )
    return unit
