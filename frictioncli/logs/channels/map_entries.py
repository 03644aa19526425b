"""Entries of a mapping file: read and checked one by one."""

import codecs
import difflib
import tomllib
from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Any

from frictioncli.errors import MappingError
from frictioncli.logs.channels.channel_names import MAX_JOINT
from frictioncli.logs.log_source import CsvHints
from frictioncli.plain_text import printable

CSV_KEYS = ("delimiter", "decimal", "encoding", "period")
MAX_COLUMN = 1 << 31
_MAX_BYTES = 1 << 20  # [byte]
_DELIMITERS = {";": ";", ",": ",", "\t": "\t", " ": " ", "tab": "\t", "space": " ", "blank": " "}
_NO_TEXT = frozenset({"idna", "punycode", "undefined", "unicode_escape", "raw_unicode_escape"})
"""Encodings that name something else than the characters of a text."""
_LARGEST = 1e30
"""Factors beyond this, or smaller than its inverse, are of no log, and products are infinite."""
_USUAL = "not 0 nor beyond 1e±30"
_SAMPLE = "t;1,5\t-2.5e3\r\n"


def toml_document(path: Path, sections: Collection[str]) -> dict[str, Any]:
    """Return the content of a mapping file.

    Parameters
    ----------
    path : Path
        The file.
    sections : collection of str
        Names of its sections, for the message.

    Raises
    ------
    MappingError
        If it is not TOML, or has more than 1 MiB.
    """
    try:
        with path.open("rb") as stream:
            content = stream.read(_MAX_BYTES + 1)
        if len(content) > _MAX_BYTES:
            raise ValueError("more than 1 MiB")
        return tomllib.loads(content.decode("utf-8-sig"))
    # ValueError also: numbers of thousands of digits; RecursionError: brackets in brackets
    except (OSError, ValueError, RecursionError) as error:
        raise MappingError(
            f"{path}: cannot be read as a mapping file ({error}); expected TOML with"
            f" {listed(sections)}"
        ) from error


def shown(value: Any) -> str:
    """Return a value of a mapping file for a message, shortened."""
    try:
        return printable(repr(value))
    except (ValueError, RecursionError):  # a number of thousands of digits
        return f"a {type(value).__name__}"


def csv_hints(path: Path, section: dict[str, Any]) -> CsvHints:
    """Return the form of the text that the section ``[csv]`` gives.

    Parameters
    ----------
    path : Path
        The mapping file.
    section : dict
        The section.

    Raises
    ------
    MappingError
        If a value is not known.
    """
    delimiter, decimal, encoding, period = (section.get(key) for key in CSV_KEYS)
    if delimiter is not None and not (isinstance(delimiter, str) and delimiter in _DELIMITERS):
        raise MappingError(
            f"{path}: [csv] delimiter = {shown(delimiter)}; expected one of {listed(_DELIMITERS)}"
        )
    if decimal not in (None, ".", ","):
        raise MappingError(f"{path}: [csv] decimal = {shown(decimal)}; expected '.' or ','")
    if encoding is not None:
        name = _text_encoding(encoding)
        if name is None:
            raise MappingError(
                f"{path}: [csv] encoding = {shown(encoding)}; expected for example utf-8, cp1252,"
                " utf-16"
            )
        encoding = name
    seconds = _factor(period)
    if period is not None and not (seconds is not None and seconds > 0):
        raise MappingError(
            f"{path}: [csv] period = {shown(period)}; expected the time from row to row in s,"
            " for example 0.005"
        )
    sign = None if delimiter is None else _DELIMITERS[delimiter]
    return CsvHints(sign, decimal, encoding, seconds)


def _text_encoding(name: Any) -> str | None:
    """Return the name by which Python knows an encoding of text; None for anything else."""
    try:
        codec = codecs.lookup(name)
        read = codec.incrementaldecoder is not None and codec.name.replace("-", "_") not in _NO_TEXT
        return codec.name if read and _SAMPLE.encode(name).decode(name) == _SAMPLE else None
    # each codec has errors of its own, and those that make bytes of bytes raise others again
    except Exception:
        return None


def joint_number(path: Path, number: Any) -> int | None:
    """Return the number of a joint, None where none is given.

    Parameters
    ----------
    path : Path
        The mapping file.
    number : object
        The number as it was read.

    Raises
    ------
    MappingError
        If it is no number from 1 to 32767.
    """
    is_number = isinstance(number, int) and number is not True
    if number is None or (is_number and 1 <= number <= MAX_JOINT):
        return number
    raise MappingError(
        f"{path}: [joint] number = {shown(number)}; expected a joint number from 1 to {MAX_JOINT}"
    )


def ratio(path: Path, key: str, value: Any) -> float | None:
    """Return a gear ratio, rated torque or torque constant, None where none is given.

    Parameters
    ----------
    path : Path
        The mapping file.
    key : str
        ``gear_ratio``, ``rated_torque`` or ``torque_constant``.
    value : object
        The value as it was read.

    Raises
    ------
    MappingError
        If it is no number, 0, infinite, or of a size that no log has.
    """
    number = _factor(value)
    if value is None or number is not None:
        return number
    meaning = {
        "gear_ratio": f"motor turns per joint turn, {_USUAL}",
        "rated_torque": f"N·m at 100 %, {_USUAL}",
        "torque_constant": f"'auto', or N·m/A, {_USUAL}",
    }[key]
    raise MappingError(f"{path}: [joint] {key} = {shown(value)}; expected {meaning}")


def scale(path: Path, name: str, value: Any) -> float:
    """Return the factor of a quantity, from the numbers in a log to its unit.

    Parameters
    ----------
    path : Path
        The mapping file.
    name : str
        The quantity.
    value : object
        The value as it was read.

    Raises
    ------
    MappingError
        If it is no number, 0, infinite, or of a size that no log has.
    """
    number = _factor(value)
    if number is None:
        raise MappingError(
            f"{path}: [scale] {name} = {shown(value)}; expected the number by which the column is"
            f" multiplied, {_USUAL}"
        )
    return number


def _factor(value: Any) -> float | None:
    """Return a number that is neither 0 nor of a size beyond all use, None for anything else."""
    if not isinstance(value, int | float) or isinstance(value, bool):
        return None
    try:
        number = float(value)
    except OverflowError:
        return None
    return number if 1 / _LARGEST <= abs(number) <= _LARGEST else None


def torque_constant(path: Path, value: Any) -> float | str | None:
    """Return the torque constant, ``auto`` where it is to be found.

    Parameters
    ----------
    path : Path
        The mapping file.
    value : object
        The value as it was read.

    Raises
    ------
    MappingError
        If it is neither.
    """
    return "auto" if value == "auto" else ratio(path, "torque_constant", value)


def check_keys(path: Path, what: str, given: Collection[str], allowed: Sequence[str]) -> None:
    """Check that all keys are known.

    Parameters
    ----------
    path : Path
        The mapping file.
    what : str
        The keys in words.
    given, allowed : collection of str
        The keys.

    Raises
    ------
    MappingError
        If one is not, with the nearest known one.
    """
    for key in given:
        if key not in allowed:
            close = difflib.get_close_matches(key[:100], allowed, n=1)
            hint = f"; did you mean {close[0]}?" if close else ""
            raise MappingError(
                f"{path}: unknown {what}: {printable(key)}; expected {listed(allowed)}{hint}"
            )


def listed(names: Collection[str]) -> str:
    """Return names one after the other; those of blanks in quotes."""
    return ", ".join(repr(name) if not name.strip() else name for name in names)
