"""Text exports of Beckhoff's TwinCAT Scope: many header rows, and times for each group of channels.

The form is that of Beckhoff's documentation of the CSV export and of public exports: lines on the
project (``Name``, ``File``, ``Starttime of export``, ``Endtime of export``), a block of rows on the
channels, in which each row begins with its key and repeats it where a group of channels with its
own time begins, and rows of numbers. Times are in ms since the first value, or in Windows
FILETIME. A last row may say EOF.
"""

from collections.abc import Sequence
from datetime import UTC, datetime, timedelta

from frictioncli.logs.formats.dialect import Dialect, split
from frictioncli.logs.log_source import CsvHints

_START = "Starttime of export"
_NAME, _SAMPLE_TIME, _UNIT = "Name", "SampleTime[ms]", "Unit"
_HEAD_LINES = 60
_DELIMITERS = ("\t", ";", ",")
_FILETIME = 1e16
"""Times above this are in units of 100 ns since 1601."""
_LAST_FILETIME = 3e18
"""Later times are beyond the calendar. [100 ns]"""
_EPOCH = datetime(1601, 1, 1, tzinfo=UTC)


def scope_dialect(lines: Sequence[str], hints: CsvHints) -> Dialect | None:
    r"""Return the form of an export by TwinCAT Scope; None where a text is none.

    Channels that are sampled at another period than the first group have no name, as their rows
    are of other times.

    Parameters
    ----------
    lines : sequence of str
        The first lines without line ends.
    hints : CsvHints
        Form given by the user.

    Examples
    --------
    >>> head = ["Name\tProject", "Starttime of export\t132000000000000000", ""]
    >>> head += ["Name\tAxis 1.ActPos\tName\tAxis 1.ActVelo", "", "0,0\t1,5\t0,0\t0,1"]
    >>> scope_dialect([*head, "2,0\t1,6\t2,0\t0,1"], CsvHints()).columns
    ('time [ms]', 'Axis 1.ActPos', '', 'Axis 1.ActVelo')
    """
    delimiter = next((d for d in _DELIMITERS if lines and lines[0].startswith(_NAME + d)), None)
    starts = [i for i, line in enumerate(lines[:_HEAD_LINES]) if line.startswith(_START)]
    if delimiter is None or not starts:
        return None
    rows = [split(line, delimiter) for line in lines[:_HEAD_LINES]]
    keyed = {row[0]: row for row in rows[starts[0] + 1 :] if row and row[0]}
    names = keyed.get(_NAME)
    width = 0 if names is None else len(names)
    first = next((i for i, row in enumerate(rows) if _is_data(row, width)), None)
    if names is None or first is None:
        return None
    decimal = hints.decimal or ("," if delimiter != "," and "," in lines[first] else ".")
    unit = "100ns" if _number(rows[first][0]) > _FILETIME else "ms"
    while _is_damaged(lines[first - 1], delimiter):
        first -= 1
    return Dialect(delimiter, decimal, _columns(keyed, unit), first + 1, {})


def scope_start(head: bytes) -> datetime | None:
    r"""Return the start in the head of an export by TwinCAT Scope; None where it has none.

    Parameters
    ----------
    head : bytes
        The lines above the first row.

    Examples
    --------
    >>> scope_start(b"Name\tProject\nStarttime of export\t132000000000000000\n").isoformat()
    '2019-04-17T18:40:00+00:00'
    """
    at = head.find(_START.encode())
    if not head.startswith(_NAME.encode()) or at < 0:
        return None
    text = head[at + len(_START) :].split(b"\n", 1)[0].strip(b"\t;, \r").split(b"\t")[0]
    if not text.isdigit() or not _FILETIME < int(text) < _LAST_FILETIME:
        return None
    return _EPOCH + timedelta(microseconds=int(text) // 10)


def _columns(keyed: dict[str, list[str]], time_unit: str) -> tuple[str, ...]:
    """Return the column names: the first time, and the channels of its period."""
    names = keyed[_NAME]
    periods, channel_units = keyed.get(_SAMPLE_TIME, []), keyed.get(_UNIT, [])
    columns = []
    for index, name in enumerate(names):
        if name == _NAME:
            columns.append(f"time [{time_unit}]" if index == 0 else "")
            continue
        period = periods[index] if index < len(periods) else ""
        if index > 1 and len(periods) > 1 and period != periods[1]:
            columns.append("")
            continue
        unit = channel_units[index] if index < len(channel_units) else ""
        known = unit not in ("", "None", "(None)")
        # of a path such as Axes.Axis 1.ActPos the last two parts
        plain = ".".join(name.strip().split(".")[-2:])
        columns.append(f"{plain} [{unit.strip('[]()')}]" if known else plain)
    return tuple(columns)


def _is_data(row: Sequence[str], width: int) -> bool:
    filled = [cell for cell in row if cell.strip()]
    numbers = [cell for cell in filled if _number(cell) == _number(cell)]
    return width > 1 and len(row) == width and len(numbers) == len(filled) > 1


def _is_damaged(line: str, delimiter: str) -> bool:
    """Return whether a line above the first whole row is a row, too: heads begin with a key."""
    cells = [cell for cell in line.split(delimiter) if cell.strip()]
    numbers = [cell for cell in cells if _number(cell) == _number(cell)]
    return bool(cells) and (not line.lstrip()[0].isalpha() or 2 * len(numbers) > len(cells))


def _number(text: str) -> float:
    try:
        return float(text.strip().replace(",", "."))
    except ValueError:
        return float("nan")
