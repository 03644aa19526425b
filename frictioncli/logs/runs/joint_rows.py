"""Logs whose rows are of one joint each: a column says of which."""

import re
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from frictioncli.logs.channels.channel_map import ChannelMap
from frictioncli.logs.channels.column_name import split_unit
from frictioncli.logs.channels.recognition import recognise_channels
from frictioncli.logs.formats.delimited import DelimitedText
from frictioncli.logs.log_source import (
    DerivedSource,
    LogSource,
    RawBatch,
    Refusal,
    UnreadableLog,
)
from frictioncli.logs.runs.discovery import LogFile
from frictioncli.logs.settings import IngestSettings
from frictioncli.wording import list_text

_MOST_JOINTS, _MOST_DIFFERENT = 100, 1000
_LARGEST = 1e9
"""Numbers of joints are below 100; larger ones are addresses on a bus, up to this one."""
_BATCH_BYTES = 1 << 22
_PART = r"(?:motor|joint|axis|achse|gelenk|servo|actuator|drive)"
_TOLD_BY = re.compile(rf"(?:{_PART}[ _.]?(?:id|no|nr|number|nummer|index|idx|name)?|id|name)", re.I)

_MAY_BE_OTHER = re.compile(r"id|name", re.I)
_MAY_MEASURE = re.compile(r"id|name|motor|servo|actuator|drive", re.I)
"""Columns that may be of other things than joints: of texts, and of numbers."""
_LEAST_ROWS, _LEAST_SHARE = 10, 0.05
"""Rows of a joint: a counter of rows has one of each number, and a damaged name has few of those of
the joint with most. [-]"""


@dataclass(frozen=True, slots=True)
class RowsOfJoint(DerivedSource):
    """The rows of one joint.

    Attributes
    ----------
    source : LogSource
        The log of all joints.
    column : int
        The column that says of which joint a row is.
    numbers : tuple of float
        What stands there, for all joints.
    place : int
        Place of this joint among them.
    joint : int
        Number of the joint, from 1.
    name : str
        What stands in the log for the joint.
    is_first : bool
        Whether the rows that are of no joint are counted here.
    notes : tuple of str
        Which joints the names or numbers are.
    """

    column: int
    numbers: tuple[float, ...]
    place: int
    joint: int
    name: str
    is_first: bool
    notes: tuple[str, ...] = ()

    @property
    def form(self) -> str:
        """The file's form in words."""
        return f"{self.source.form}, rows of {self.columns[self.column]} {self.name}"

    def batches(self, columns: Collection[int], size: int) -> Iterator[RawBatch]:
        """Yield the rows in order, in batches of about ``size`` bytes of the file."""
        for batch in self.source.batches({*columns, self.column}, size):
            told = batch.values[self.column]
            mine = told == self.numbers[self.place]
            bad, reasons = batch.bad_lines, batch.bad_reasons
            if self.is_first:
                unknown = batch.lines[~np.isin(told, self.numbers)]
                bad = np.concatenate((bad, unknown))
                reasons = (*reasons, *["missing_value"] * len(unknown))
            else:
                bad, reasons = bad[:0], ()
            values = {column: batch.values[column][mine] for column in columns}
            yield RawBatch(batch.lines[mine], values, bad, reasons)


def joint_rows(
    source: LogSource, settings: IngestSettings, channel_map: ChannelMap
) -> Sequence[LogSource] | Refusal:
    """Return the rows of each joint as a log; the log itself where no column tells joints apart.

    Joints are told by a column such as ``motor_id`` or ``joint_name``. Numbers from 0 are raised by
    one, names are numbered in the order of first appearance, addresses on a bus in ascending order.

    Parameters
    ----------
    source : LogSource
        Any log.
    settings : IngestSettings
        Joints to read.
    channel_map : ChannelMap
        Joint that the map's columns are of.

    Returns
    -------
    sequence of LogSource or Refusal
        Refused as ``no_torque_channel`` where none of the wanted joints is there.
    """
    column = _telling_column(source.columns)
    if column is None:
        return [source]
    found = _told(source, column)
    if found is None:
        return [source]
    source, numbers, names = found
    joints = _joint_numbers(numbers)
    wanted = settings.joints if channel_map.joint is None else (channel_map.joint,)
    chosen = [place for place, joint in enumerate(joints) if wanted is None or joint in wanted]
    if not chosen:
        return Refusal(
            "no_torque_channel",
            f"no joint {list_text([str(joint) for joint in wanted or ()])}; column"
            f" {source.columns[column]} has the rows of joint"
            f" {list_text([str(joint) for joint in sorted(joints)])}: choose one of them",
        )
    told = [f"{names[place]} is joint {joints[place]}" for place in chosen]
    as_they_are = all(names[place] == str(joints[place]) for place in chosen)
    notes = () if as_they_are else (f"column {source.columns[column]}: {', '.join(told)}",)
    return [
        RowsOfJoint(
            source,
            column,
            numbers,
            place,
            joints[place],
            names[place],
            is_first=place == chosen[0],
            notes=notes if place == chosen[0] else (),
        )
        for place in chosen
    ]


def parts_by_joint(
    sources: Mapping[LogFile, LogSource], settings: IngestSettings, channel_map: ChannelMap
) -> tuple[dict[LogFile, dict[LogFile, LogSource]], dict[LogFile, Refusal]]:
    """Return the logs in each file, several where each row is of one joint, and refused files.

    Parameters
    ----------
    sources : mapping of LogFile to LogSource
        The opened files.
    settings, channel_map
        As of :func:`joint_rows`.
    """
    parts: dict[LogFile, dict[LogFile, LogSource]] = {}
    refusals = {}
    for file, source in sources.items():
        found = joint_rows(source, settings, channel_map)
        if isinstance(found, Refusal):
            refusals[file] = found
        else:
            several = len(found) > 1
            parts[file] = {LogFile(file.path) if several else file: part for part in found}
    return parts, refusals


@lru_cache
def _telling_column(columns: tuple[str, ...]) -> int | None:
    """Return the column that may tell joints apart; None where the other columns number them."""
    parted = (split_unit(name) for name in columns)
    told = (not unit and _TOLD_BY.fullmatch(name.strip()) is not None for name, unit in parted)
    column = next((i for i, is_told in enumerate(told) if is_told), None)
    if column is None or any(c.joint is not None for c in recognise_channels(columns)):
        return None
    return column


def _joint_numbers(numbers: Sequence[float]) -> list[int]:
    """Return the joints that numbers stand for: themselves, from 1, or their places by size."""
    if max(numbers) < _MOST_JOINTS:
        raised = 1 if 0.0 in numbers else 0
        return [int(number) + raised for number in numbers]
    places = {number: place for place, number in enumerate(sorted(numbers), 1)}
    return [places[number] for number in numbers]


def _told(
    source: LogSource, column: int
) -> tuple[LogSource, tuple[float, ...], tuple[str, ...]] | None:
    """Return the log, what stands for its joints, and their names; None where there are not two."""
    numbers = _numbers(source, column, _MAY_MEASURE)
    text = _text_of(source)
    if numbers is None or len(numbers) or text is None:
        return (source, numbers, tuple(f"{number:.0f}" for number in numbers)) if numbers else None
    names = text.names_in(column, _MOST_DIFFERENT)
    with_names = _with_text(source, text.with_names(column, names))
    places = _numbers(with_names, column, _MAY_BE_OTHER) if names else None
    if not places:
        return None
    names = tuple(names[int(place) - 1] for place in sorted(places))
    numbers = tuple(float(place) for place in range(1, len(names) + 1))
    return _with_text(source, text.with_names(column, names)), numbers, names


def _text_of(source: LogSource) -> DelimitedText | None:
    """Return the text that a log is read from, also where its time is joined from two columns."""
    while isinstance(source, DerivedSource):
        source = source.source
    return source if isinstance(source, DelimitedText) else None


def _with_text(source: LogSource, text: DelimitedText) -> LogSource:
    """Return a log that is read from another text with the same columns."""
    if not isinstance(source, DerivedSource):
        return text
    return replace(source, source=_with_text(source.source, text))


def _numbers(
    source: LogSource, column: int, may_be_other: re.Pattern[str]
) -> tuple[float, ...] | None:
    """Return what stands for the joints of a log: nothing where there are hardly any numbers.

    None where the numbers are no joints: too many or too few, or in a column that need not be one
    of joints and whose rows do not take turns. Numbers in few rows are damaged ones.
    """
    found: Counter[float] = Counter()
    changes = rows_read = 0
    with suppress(UnreadableLog):
        for batch in source.batches([column], _BATCH_BYTES):
            rows_read += len(batch.lines) + len(batch.bad_lines)
            values = batch.values[column]
            values = values[np.isfinite(values)]
            changes += int(np.count_nonzero(np.diff(values)))
            different, rows = np.unique(values, return_counts=True)
            found.update(dict(zip(different.tolist(), rows.tolist(), strict=True)))
            if len(found) > _MOST_DIFFERENT:
                return None
    # a number among names is a damaged one
    if found.total() <= _LEAST_SHARE * rows_read:
        return ()
    least = max(_LEAST_SHARE * max(found.values()), _LEAST_ROWS)
    joints = tuple(number for number, rows in found.items() if rows >= least)
    take_turns = 2 * changes > found.total()
    is_joint = take_turns or not may_be_other.fullmatch(source.columns[column].strip())
    known = all(number.is_integer() and 0 <= number <= _LARGEST for number in joints)
    return joints if is_joint and known and 1 < len(joints) <= _MOST_JOINTS else None
