"""DIAdem recordings: a text header (``.dat``) and binary samples in the same folder (``.r64``)."""

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from frictioncli.arrays import Array, Numbers
from frictioncli.logs.formats.diadem_header import (
    DamagedHeader,
    Header,
    HeaderSection,
    is_header,
    read_header,
)
from frictioncli.logs.formats.diadem_layout import SampleLocation, is_file, sample_locations
from frictioncli.logs.log_source import (
    MAX_ROW_TEXT,
    CsvHints,
    RawBatch,
    ReadTask,
    Refusal,
    UnreadableLog,
)

_NAME, _UNIT, _KIND, _LENGTH, _OFFSET, _FACTOR = 200, 202, 210, 220, 240, 241
_NO_VALUE = 111

_NO_VALUE_TOLERANCE = 1e-6
"""Relative; the header writes the value with fewer digits than the samples have."""


@dataclass(frozen=True, slots=True)
class StoredChannel:
    """A channel whose values are ``number * factor + offset``.

    Attributes
    ----------
    name : str
        Name with unit.
    location : SampleLocation or None
        Where its numbers are stored; None for an implicit channel, whose numbers are 0, 1, 2, ...
    factor, offset : float
        Scale of the numbers.
    """

    name: str
    location: SampleLocation | None
    factor: float
    offset: float


def read_diadem(path: Path, head: bytes, hints: CsvHints) -> "DiademRecording | Refusal | None":
    """Open a DIAdem recording by its header; None when the file is another format."""
    if not is_header(head):
        return None
    try:
        recording = open_recording(path)
    except UnreadableLog as error:
        return Refusal("unreadable_file", str(error))
    except DamagedHeader as error:
        return Refusal("format_not_read", f"DIAdem header: {error}")
    if recording is None:
        return None
    return recording.refusal() or recording


def open_recording(path: Path) -> "DiademRecording | None":
    """Return the recording that a header describes; None where the file is no DIAdem header.

    Whether all samples are present is checked by :meth:`DiademRecording.refusal`.

    Raises
    ------
    UnreadableLog
        If the header cannot be read.
    DamagedHeader
        If it contradicts itself, or has contents that are not supported.
    """
    header = read_header(path)
    if header is None:
        return None
    explicit, implicit = _by_kind(header)
    if not explicit:
        raise DamagedHeader(
            "it names no explicit channel; of KUKA traces the header and its .r64, or the CSV,"
            " are read"
        )
    lengths = {c.count(_LENGTH): c.where for c in implicit if c.text(_LENGTH)}
    lengths |= {c.count(_LENGTH): c.where for c in explicit}
    if len(lengths) > 1:
        found = " and ".join(f"{n} in {where}" for n, where in list(lengths.items())[:2])
        raise DamagedHeader(f"key 220 is {found}; expected as many samples in all channels")
    stored = sample_locations(header, explicit)
    columns = []
    for section in header.channels:
        unit = section.text(_UNIT)
        columns.append(
            StoredChannel(
                section.text(_NAME) + (f"[{unit}]" if unit else ""),
                stored.get(section.where),
                section.factor(_FACTOR),
                section.number(_OFFSET, 0.0),
            )
        )
    no_value = header.general.number(_NO_VALUE, 9.9e34)
    return DiademRecording(path, tuple(columns), next(iter(lengths)), no_value)


def _by_kind(header: Header) -> tuple[list[HeaderSection], list[HeaderSection]]:
    """Return the explicit channels, which are stored, and the implicit ones, which only count."""
    kinds: dict[str, list[HeaderSection]] = {"EXPLI": [], "IMPLI": []}
    for section in header.channels:
        kind = section.text(_KIND).upper()[:5]
        if kind not in kinds:
            raise section.damaged(_KIND, "EXPLIZIT or IMPLIZIT")
        kinds[kind].append(section)
    return kinds["EXPLI"], kinds["IMPLI"]


@dataclass(frozen=True, slots=True)
class DiademRecording:
    """A recording with a valid header.

    Attributes
    ----------
    path : Path
        The header.
    channels : tuple of StoredChannel
        The channels; values are in the units of the header.
    n : int
        Samples per channel.
    no_value : float
        The number that stands for a missing value.
    """

    path: Path
    channels: tuple[StoredChannel, ...]
    n: int
    no_value: float

    @property
    def files(self) -> tuple[Path, ...]:
        """The header and the files of samples."""
        stored = (c.location.file for c in self.channels if c.location is not None)
        return (self.path, *dict.fromkeys(stored))

    @property
    def columns(self) -> tuple[str, ...]:
        """Names with units, as in a CSV export of the recording."""
        return tuple(channel.name for channel in self.channels)

    @property
    def form(self) -> str:
        """The file's form in words."""
        kinds = {c.location.dtype.name: None for c in self.channels if c.location is not None}
        return f"DIAdem header and binary samples, {', '.join(kinds)}"

    def refusal(self) -> Refusal | None:
        """Return which samples are missing, None where all are present."""
        if self.n < 1:
            return Refusal("too_few_rows", "the DIAdem header declares no samples (key 220 is 0)")
        for file in self.files[1:]:
            if not is_file(file):
                return Refusal(
                    "samples_missing",
                    f"DIAdem header without its samples: {file.name} is not beside it; copy both",
                )
            stored = [c.location for c in self.channels if c.location and c.location.file == file]
            size, needed = file.stat().st_size, max(location.end(self.n) for location in stored)
            if stored[0].in_rows:
                needed = max(location.step for location in stored) * self.n
            if size < needed or (stored[0].in_rows and size > needed):
                return Refusal(
                    "samples_incomplete",
                    f"{file.name} holds {size} bytes; the header states {self.n} samples in"
                    f" {len(stored)} channels, {needed} bytes: copy both files again",
                )
        return None

    def raw(self, column: int, start: int, stop: int) -> Array:
        """Return the stored numbers of a channel, fewer where the file ends before.

        Parameters
        ----------
        column : int
            Index of the channel.
        start, stop : int
            First sample, from 0, and the one after the last.

        Returns
        -------
        ndarray, shape (stop - start,) or less
            Numbers without factor and offset. [raw]
        """
        location = self.channels[column].location
        if location is None:
            return np.arange(start, stop, dtype=np.float64)
        begin = location.first + start * location.step
        with location.file.open("rb") as stream:
            stream.seek(begin)
            content = stream.read((stop - start - 1) * location.step + location.dtype.itemsize)
        count = max((len(content) - location.dtype.itemsize) // location.step + 1, 0)
        stored = np.ndarray((count,), location.dtype, content, strides=(location.step,))
        return stored.astype(np.float64)

    def batches(self, columns: Collection[int], size: int) -> Iterator[RawBatch]:
        """Yield the samples in order, in batches of about ``size`` bytes of the file."""
        for task in self.tasks(columns, size):
            yield task.read()

    def tasks(self, columns: Collection[int], size: int) -> Iterator[ReadTask[RawBatch]]:
        """Yield in order the tasks that read the batches, each of at most about ``size`` bytes."""
        wanted = sorted(columns)
        widths = [c.location.step for c in self.channels if c.location is not None]
        rows = max(size // max(widths), 1)
        for start in range(0, self.n, rows):
            stop = min(start + rows, self.n)
            yield ReadTask(partial(self._batch, wanted, start, stop), (stop - start) * max(widths))

    def texts(self, lines: Numbers, size: int) -> Iterator[tuple[int, str]]:
        """Yield (sample number, values) for the given sample numbers, which must be ascending."""
        for line in lines.tolist():
            batch = self._batch(range(len(self.channels)), line - 1, line)
            cells = ("" if np.isnan(v[0]) else f"{v[0]:.9g}" for v in batch.values.values())
            yield line, ";".join(cells)[:MAX_ROW_TEXT]

    def _batch(self, columns: Collection[int], start: int, stop: int) -> RawBatch:
        return RawBatch(
            np.arange(start + 1, stop + 1, dtype=np.int64),
            {column: self._values(column, start, stop) for column in columns},
            np.empty(0, np.int64),
            (),
        )

    def _values(self, column: int, start: int, stop: int) -> Array:
        channel = self.channels[column]
        try:
            numbers = self.raw(column, start, stop)
        except OSError as error:
            raise UnreadableLog(f"samples cannot be read ({error}); copy both files") from error
        if len(numbers) < stop - start:
            raise UnreadableLog(
                f"samples end before number {stop}; expected {self.n}: copy it again"
            )
        with np.errstate(over="ignore", invalid="ignore"):
            values = numbers * channel.factor + channel.offset
            if channel.location is not None:
                difference = np.abs(numbers - self.no_value)
                values[difference <= _NO_VALUE_TOLERANCE * abs(self.no_value)] = np.nan
        return values
