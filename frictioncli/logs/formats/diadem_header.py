"""The text half of a DIAdem recording: what its header says of the channels."""

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
_MARKS = b"\xef\xbb\xbf \t\r\n"
_LONGEST = 1 << 22
"""A header of ten thousand channels is shorter. [byte]"""

_DATE, _CLOCK, _NANOSECONDS = 104, 105, 106
_KEY = re.compile(r"^\s*(\d{1,3}),(.*)$")
_DAY = re.compile(r"^(\d\d)[.\-/](\d\d)[.\-/](\d{4})$")
_HOURS = re.compile(r"^(\d\d):(\d\d):(\d\d)$")
_SHOWN = 60
_FACTORS_OF_SEVEN_DIGITS = (180.0 / math.pi,)


class DamagedHeader(LogError):
    """A header that contradicts itself; the text says where."""


@dataclass(frozen=True, slots=True)
class HeaderSection:
    """One block of a header: key numbers to texts.

    ``where`` names the block in messages.
    """

    where: str
    entries: dict[int, str] = field(default_factory=dict)

    def text(self, key: int, otherwise: str = "") -> str:
        """Return a key's text, ``otherwise`` where the key is missing or empty."""
        return self.entries.get(key) or otherwise

    def damaged(self, key: int, expected: str) -> DamagedHeader:
        """Return the error of a key that holds something else than expected."""
        found = self.text(key)[:_SHOWN]
        return DamagedHeader(f"key {key} of {self.where} is {found!r}; expected {expected}")

    def number(self, key: int, otherwise: float) -> float:
        """Return a key's number.

        Raises
        ------
        DamagedHeader
            If the text is no finite number.
        """
        text = self.text(key)
        try:
            value = float(text) if text else otherwise
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise self.damaged(key, "a number")
        return value

    def count(self, key: int, otherwise: int = 0) -> int:
        """Return a key's whole number.

        Raises
        ------
        DamagedHeader
            If the text is no whole number from 0.
        """
        value = self.number(key, otherwise)
        if value < 0 or value != int(value):
            raise self.damaged(key, "a whole number from 0")
        return int(value)

    def factor(self, key: int) -> float:
        """Return a key's factor, 1 where it is missing.

        Factors are written with seven digits: one that is 180/π in all of them is meant to be that.

        Raises
        ------
        DamagedHeader
            If the text is no finite number, or 0.
        """
        value = self.number(key, 1.0)
        if value == 0:
            raise self.damaged(key, "a factor other than 0")
        exact = (f for f in _FACTORS_OF_SEVEN_DIGITS if f"{f:.6e}" == f"{value:.6e}")
        return next(exact, value)


@dataclass(frozen=True, slots=True)
class Header:
    """A header as it stands in the file, nothing judged yet."""

    path: Path
    general: HeaderSection
    channels: tuple[HeaderSection, ...]

    @property
    def started_at(self) -> datetime | None:
        """When the recording began; None where no valid date stands there.

        The header names no time zone; the time is taken as UTC, as in a manifest.
        """
        day = _DAY.match(self.general.text(_DATE))
        clock = _HOURS.match(self.general.text(_CLOCK))
        if day is None or clock is None:
            return None
        part = self.general.text(_NANOSECONDS, "0")
        try:
            hour, minute, second = map(int, clock.groups())
            start = datetime(
                int(day[3]), int(day[2]), int(day[1]), hour, minute, second, tzinfo=UTC
            )
            return start + timedelta(microseconds=int(part[:9]) // 1000)
        except (ValueError, OverflowError):
            return None


def is_header(head: bytes) -> bool:
    """Return whether a file begins as a DIAdem header does."""
    return head.lstrip(_MARKS).startswith(MAGIC)


def read_header(path: Path) -> Header | None:
    """Return the header that a file holds, None where it is no DIAdem header.

    Raises
    ------
    UnreadableLog
        If the file cannot be read, or is far too long for a header.
    """
    try:
        with open_bytes(path) as stream:
            content = stream.read(len(MAGIC) + 64)
            if not is_header(content):
                return None
            content += stream.read(_LONGEST)
    except STREAM_ERRORS as error:
        raise UnreadableLog(f"cannot be read ({error}); expected a DIAdem header") from error
    if len(content) > _LONGEST:
        raise UnreadableLog(f"longer than {_LONGEST >> 20} MiB; expected a DIAdem header")
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = content.decode("cp1252", "replace")
    general = HeaderSection("the global header")
    channels: list[HeaderSection] = []
    for inside, key, value in _entries(text):
        if not inside:
            general.entries.setdefault(key, value)
            continue
        if inside > len(channels):
            channels.append(HeaderSection(f"channel {inside}"))
        channels[-1].entries.setdefault(key, value)
    return Header(path, general, tuple(channels))


def _entries(text: str) -> Iterator[tuple[int, int, str]]:
    """Yield (number of the channel's block, 0 for the global header, key, value)."""
    channel = 0
    for line in text.splitlines():
        if line.strip().upper() == "#BEGINCHANNELHEADER":
            channel += 1
        elif entry := _KEY.match(line):
            yield channel, int(entry[1]), entry[2].strip()
