"""Start times that stand not in a log but in the file recorded with it."""

import re
from datetime import UTC, datetime, timedelta
from pathlib import Path

_HEADER_BYTES = 4096
_MAGIC = b"DIAEXTENDED"
_DATE = re.compile(r"^\s*104,\s*(\d\d)\.(\d\d)\.(\d{4})\s*$", re.M)
_CLOCK = re.compile(r"^\s*105,\s*(\d\d):(\d\d):(\d\d)\s*$", re.M)
_NANOSECONDS = re.compile(r"^\s*106,\s*(\d+)\s*$", re.M)


def started_at(log: Path) -> datetime | None:
    """Return the start that the DIAdem header (``.dat``) beside a KUKA trace CSV tells.

    The header names no time zone; the time is taken as UTC, as in a manifest. None where there is
    no such file or it tells no valid date.
    """
    header = log.with_suffix(".dat")
    if header == log or not header.is_file():
        return None
    with header.open("rb") as stream:
        content = stream.read(_HEADER_BYTES)
    if not content.lstrip().startswith(_MAGIC):
        return None
    text = content.decode("cp1252", "replace").replace("\r\n", "\n")
    date, clock, part = _DATE.search(text), _CLOCK.search(text), _NANOSECONDS.search(text)
    if date is None or clock is None:
        return None
    day, month, year = (int(number) for number in date.groups())
    hour, minute, second = (int(number) for number in clock.groups())
    try:
        start = datetime(year, month, day, hour, minute, second, tzinfo=UTC)
    except ValueError:
        return None
    return start + timedelta(microseconds=int(part[1]) // 1000 if part else 0)
