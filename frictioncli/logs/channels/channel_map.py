"""The mapping file: columns, units and text form given by the user where detection fails."""

import codecs
import difflib
import math
import tomllib
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from frictioncli.errors import MappingError
from frictioncli.logs.channels import units
from frictioncli.logs.channels.channel_names import (
    CHANNELS,
    JOINT_SIDE,
    POSITION,
    TIME,
    TORQUE,
    Meaning,
)
from frictioncli.logs.channels.recognition import LogChannel, recognise_channels, split_unit
from frictioncli.logs.log_source import CsvHints, Refusal

_SECTIONS = ("channels", "units", "csv", "joint")
_CSV_KEYS = ("delimiter", "decimal", "encoding")
_JOINT_KEYS = ("number", "gear_ratio")
_DELIMITERS = {";": ";", ",": ",", "\t": "\t", " ": " ", "tab": "\t", "space": " ", "blank": " "}


@dataclass(frozen=True, slots=True, kw_only=True)
class ChannelMap:
    """The content of a mapping file.

    Attributes
    ----------
    channels : dict of str to str
        Column name by quantity.
    units : dict of str to str
        Unit by quantity, a key of :data:`frictioncli.logs.channels.units.FACTORS`.
    hints : CsvHints
        Form of the text.
    joint : int or None
        Number of the joint, from 1.
    gear_ratio : float or None
        Motor turns per joint turn, negative where they turn in opposite directions. [-]
    """

    channels: dict[str, str] = field(default_factory=dict)
    units: dict[str, str] = field(default_factory=dict)
    hints: CsvHints = field(default_factory=CsvHints)
    joint: int | None = None
    gear_ratio: float | None = None


def read_map(path: Path) -> ChannelMap:
    r"""Read a mapping file.

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
    try:
        text = path.read_text(encoding="utf-8-sig")
        document = tomllib.loads(text)
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise MappingError(
            f"{path}: cannot be read as a mapping file ({error}); expected TOML with"
            f" {_listed(_SECTIONS)}"
        ) from error
    _check_keys(path, "section", document, _SECTIONS)
    sections = {name: document.get(name, {}) for name in _SECTIONS}
    for name, section in sections.items():
        if not isinstance(section, dict):
            raise MappingError(f"{path}: {name} = {section!r}; expected a section [{name}]")
    channels, channel_units = sections["channels"], sections["units"]
    _check_keys(path, "name in [channels]", channels, CHANNELS)
    _check_keys(path, "name in [units]", channel_units, CHANNELS)
    _check_keys(path, "key in [csv]", sections["csv"], _CSV_KEYS)
    _check_keys(path, "key in [joint]", sections["joint"], _JOINT_KEYS)
    for name, column in channels.items():
        if not isinstance(column, str) or not column.strip():
            raise MappingError(f"{path}: [channels] {name} = {column!r}; expected a column name")
    return ChannelMap(
        channels=dict(channels),
        units={name: _unit(path, name, text) for name, text in channel_units.items()},
        hints=_hints(path, sections["csv"]),
        joint=_joint(path, sections["joint"].get("number")),
        gear_ratio=_gear_ratio(path, sections["joint"].get("gear_ratio")),
    )


def mapped_channels(
    channel_map: ChannelMap, columns: Sequence[str], joint: int
) -> tuple[LogChannel, ...] | Refusal:
    """Return the channels that the map names, and those recognised where it names none.

    Where the map names position or torque, only the time is still recognised by its name.

    Parameters
    ----------
    channel_map : ChannelMap
        The map.
    columns : sequence of str
        All column names of the log.
    joint : int
        The joint of the mapped columns.

    Returns
    -------
    tuple of LogChannel or Refusal
        Refused as ``mapped_column_missing`` where the log lacks a mapped column.
    """
    recognised = recognise_channels(columns)
    if TORQUE not in channel_map.channels and POSITION not in channel_map.channels:
        kept = [c for c in recognised if c.quantity not in channel_map.channels]
    else:
        kept = [c for c in recognised if c.quantity == TIME and TIME not in channel_map.channels]
    for quantity, wanted in channel_map.channels.items():
        index = _find(columns, wanted)
        if index is None:
            names = [column for column in columns if column]
            close = difflib.get_close_matches(wanted, names, n=3, cutoff=0.4)
            hint = f"; close: {', '.join(close)}" if close else ""
            return Refusal(
                "mapped_column_missing",
                f"no column {wanted!r}, which the map names as {quantity}{hint}; columns found:"
                f" {', '.join(names[:20])}",
            )
        known = next((c.meaning for c in recognised if c.column == index), None)
        if known is not None and known.quantity != quantity:
            known = None
        side = known.side if known is not None and quantity != TORQUE else JOINT_SIDE
        unit = split_unit(columns[index])[1]
        if not unit and known is not None:
            unit = known.unit
        kept.append(
            LogChannel(
                index, columns[index], Meaning(quantity, side, unit=unit), joint, unit, wanted
            )
        )
    return tuple(kept)


def _find(columns: Sequence[str], wanted: str) -> int | None:
    """Return the index of a column by its name, which may lack blanks around it or its unit."""
    for normal in (str, str.strip, lambda name: split_unit(name)[0]):
        matches = [i for i, column in enumerate(columns) if normal(column) == normal(wanted)]
        if matches:
            return matches[0]
    return None


def _unit(path: Path, name: str, text: Any) -> str:
    unit = units.canonical(text, name) if isinstance(text, str) else None
    if unit is None or unit not in units.FACTORS[name]:
        raise MappingError(
            f"{path}: [units] {name} = {text!r}; expected one of {_listed(units.FACTORS[name])}"
        )
    return unit


def _hints(path: Path, section: dict[str, Any]) -> CsvHints:
    delimiter, decimal, encoding = (section.get(key) for key in _CSV_KEYS)
    if delimiter is not None and delimiter not in _DELIMITERS:
        raise MappingError(
            f"{path}: [csv] delimiter = {delimiter!r}; expected one of {_listed(_DELIMITERS)}"
        )
    if decimal not in (None, ".", ","):
        raise MappingError(f"{path}: [csv] decimal = {decimal!r}; expected '.' or ','")
    if encoding is not None:
        try:
            encoding = codecs.lookup(encoding).name
        except (LookupError, TypeError) as error:
            raise MappingError(
                f"{path}: [csv] encoding = {encoding!r}; expected for example utf-8, cp1252, utf-16"
            ) from error
    return CsvHints(None if delimiter is None else _DELIMITERS[delimiter], decimal, encoding)


def _joint(path: Path, number: Any) -> int | None:
    if number is None or (isinstance(number, int) and number is not True and number >= 1):
        return number
    raise MappingError(f"{path}: [joint] number = {number!r}; expected a joint number from 1")


def _gear_ratio(path: Path, ratio: Any) -> float | None:
    if ratio is None:
        return None
    if isinstance(ratio, int | float) and math.isfinite(ratio) and ratio not in (0, True):
        return float(ratio)
    raise MappingError(
        f"{path}: [joint] gear_ratio = {ratio!r}; expected motor turns per joint turn, not 0"
    )


def _check_keys(path: Path, what: str, given: Collection[str], allowed: Sequence[str]) -> None:
    for key in given:
        if key not in allowed:
            close = difflib.get_close_matches(key, allowed, n=1)
            hint = f"; did you mean {close[0]}?" if close else ""
            raise MappingError(f"{path}: unknown {what}: {key}; expected {_listed(allowed)}{hint}")


def _listed(names: Collection[str]) -> str:
    return ", ".join(repr(name) if not name.strip() else name for name in names)
