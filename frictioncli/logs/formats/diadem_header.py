"""Text header of a DIAdem recording: the description of its channels."""

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from pathlib import Path

from frictioncli.errors import LogError
from frictioncli.logs.formats.compression import STREAM_ERRORS, open_bytes
from frictioncli.logs.log_source import UnreadableLog

MAGIC = b"DIAEXTENDED"
_LEADING = b"\xef\xbb\xbf \t\r\n"
"""Bytes that may stand before the header: a byte order mark and blanks."""
_MAX_LENGTH = 1 << 22
"""A header of ten thousand channels is shorter. [byte]"""

_DATE, _CLOCK, _NANOSECONDS = 104, 105, 106
_KEY = re.compile(r"^\s*(\d{1,3}),(.*)$")
_DAY = re.compile(r"^(\d\d)[.\-/](\d\d)[.\-/](\d{4})$")
_HOURS = re.compile(r"^(\d\d):(\d\d):(\d\d)$")
_MAX_SHOWN = 60
"""Longest text of a key in a message. [characters]"""
_ROUNDED_FACTORS = (180.0 / math.pi,)
"""Factors that headers write with seven digits and that are meant exactly."""


class DamagedHeader(LogError):
    """A header that contradicts itself; the text says where."""


@dataclass(frozen=True, slots=True)
class HeaderSection:
    """One section of a header.

    Attributes
    ----------
    where : str
        Name of the section in messages.
    entries : dict of int to str
        Text by key number.
    """

    where: str
    entries: dict[int, str] = field(default_factory=dict)

    def text(self, key: int, default: str = "") -> str:
        """Return a key's text; the default where the key is missing or empty."""
        return self.entries.get(key) or default

    def damaged(self, key: int, expected: str) -> DamagedHeader:
        """Return the error of a key whose text is not as expected."""
        found = self.text(key)[:_MAX_SHOWN]
        return DamagedHeader(f"key {key} of {self.where} is {found!r}; expected {expected}")

    def number(self, key: int, default: float) -> float:
        """Return a key's number.

        Raises
        ------
        DamagedHeader
            If the text is not a finite number.
        """
        text = self.text(key)
        try:
            value = float(text) if text else default
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise self.damaged(key, "a number")
        return value

    def count(self, key: int, default: int = 0) -> int:
        """Return a key's whole number.

        Raises
        ------
        DamagedHeader
            If the text is not a whole number from 0.
        """
        value = self.number(key, default)
        if value < 0 or value != int(value):
            raise self.damaged(key, "a whole number from 0")
        return int(value)

    def factor(self, key: int) -> float:
        """Return a key's factor, 1 where it is missing.

        Factors are written with seven digits. A factor with the seven digits of 180/π is taken as
        exactly 180/π.

        Raises
        ------
        DamagedHeader
            If the text is not a finite number, or is 0.
        """
        value = self.number(key, 1.0)
        if value == 0:
            raise self.damaged(key, "a factor other than 0")
        exact = (f for f in _ROUNDED_FACTORS if f"{f:.6e}" == f"{value:.6e}")
        return next(exact, value)


@dataclass(frozen=True, slots=True)
class Header:
    """The sections of a header, not checked yet.

    Attributes
    ----------
    path : Path
        The file.
    general : HeaderSection
        The global section.
    channels : tuple of HeaderSection
        One section per channel.
    """

    path: Path
    general: HeaderSection
    channels: tuple[HeaderSection, ...]

    @property
    def started_at(self) -> datetime | None:
        """Start of the recording; None where the header has no valid date.

        The header has no time zone; the time is taken as UTC, as in a manifest.
        """
        day = _DAY.match(self.general.text(_DATE))
        clock = _HOURS.match(self.general.text(_CLOCK))
        if day is None or clock is None:
            return None
        nanoseconds = self.general.text(_NANOSECONDS, "0")
        try:
            hour, minute, second = map(int, clock.groups())
            start = datetime(
                int(day[3]), int(day[2]), int(day[1]), hour, minute, second, tzinfo=UTC
            )
            return start + timedelta(microseconds=int(nanoseconds[:9]) // 1000)
        except (ValueError, OverflowError):
            return None


def is_header(head: bytes) -> bool:
    """Return whether the beginning of a file is that of a DIAdem header."""
    return head.lstrip(_LEADING).startswith(MAGIC)


def read_header(path: Path) -> Header | None:
    """Read a header; None where the file is no DIAdem header.

    Raises
    ------
    UnreadableLog
        If the file cannot be read, or is too long for a header.
    """
    try:
        with open_bytes(path) as stream:
            content = stream.read(len(MAGIC) + 64)
            if not is_header(content):
                return None
            content += stream.read(_MAX_LENGTH)
    except STREAM_ERRORS as error:
        raise UnreadableLog(f"cannot be read ({error}); expected a DIAdem header") from error
    if len(content) > _MAX_LENGTH:
        raise UnreadableLog(f"longer than {_MAX_LENGTH >> 20} MiB; expected a DIAdem header")
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = content.decode("cp1252", "replace")
    general = HeaderSection("the global header")
    channels: list[HeaderSection] = []
    for channel, key, value in _entries(text):
        if not channel:
            general.entries.setdefault(key, value)
            continue
        if channel > len(channels):
            channels.append(HeaderSection(f"channel {channel}"))
        channels[-1].entries.setdefault(key, value)
    return Header(path, general, tuple(channels))


def _entries(text: str) -> Iterator[tuple[int, int, str]]:
    """Yield (number of the channel's section or 0 for the global one, key, value)."""
    channel = 0
    for line in text.splitlines():
        if line.strip().upper() == "#BEGINCHANNELHEADER":
            channel += 1
        elif entry := _KEY.match(line):
            yield channel, int(entry[1]), entry[2].strip()
