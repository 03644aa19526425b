"""Text export of a native recording with raw values, scaled by the factors of its header."""

from collections.abc import Collection, Iterator
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.logs.channels.column_name import split_unit
from frictioncli.logs.formats.diadem import DiademRecording, open_recording
from frictioncli.logs.formats.diadem_header import DamagedHeader
from frictioncli.logs.log_source import DerivedSource, LogSource, RawBatch, UnreadableLog

_COMPARED_BYTES = 1 << 14
_MIN_ROWS = 3
_NO_VALUE = 9e34
_DIGITS = 1e-5
"""Relative tolerance of the comparison: text may hold six digits only. [-]"""


@dataclass(frozen=True, slots=True)
class ScaledLog(DerivedSource):
    """A log with linearly scaled columns.

    Attributes
    ----------
    source : LogSource
        The log with raw values.
    scales : tuple of (float, float)
        Factor and offset of each column: ``raw * factor + offset``.
    note : str
        Where they are from, in words.
    """

    scales: tuple[tuple[float, float], ...]
    note: str = "raw values scaled by the .dat header"

    @property
    def form(self) -> str:
        """The file's form in words."""
        return f"{self.source.form}, {self.note}"

    def batches(self, columns: Collection[int], size: int) -> Iterator[RawBatch]:
        """Yield the rows in order, about ``size`` bytes of the file at a time."""
        for batch in self.source.batches(columns, size):
            with np.errstate(over="ignore"):  # infinite values are rejected later
                values = {
                    column: cells * self.scales[column][0] + self.scales[column][1]
                    for column, cells in batch.values.items()
                }
            yield RawBatch(batch.lines, values, batch.bad_lines, batch.bad_reasons)


def scale_raw_export(source: LogSource) -> LogSource:
    """Return a log with scaled values if it holds the raw values of a native recording.

    The first rows must equal the numbers stored in the recording of the same name.

    Parameters
    ----------
    source : LogSource
        Any log.

    Returns
    -------
    LogSource
        The scaled log, or the log itself.
    """
    header = source.path.with_suffix(".dat")
    if header == source.path or not header.is_file():
        return source
    try:
        recording = open_recording(header)
        rows = next(iter(source.batches(range(len(source.columns)), _COMPARED_BYTES)), None)
    except (UnreadableLog, DamagedHeader):
        return source
    if recording is None or rows is None:
        return source
    stored = {split_unit(name)[0]: i for i, name in enumerate(recording.columns)}
    scales = [(1.0, 0.0)] * len(source.columns)
    for column, name in enumerate(source.columns):
        index = stored.get(split_unit(name)[0])
        if index is None or recording.channels[index].location is None:
            continue
        channel = recording.channels[index]
        if not _holds_raw(rows.values[column], recording, index):
            return source
        scales[column] = (channel.factor, channel.offset)
    return ScaledLog(source, tuple(scales)) if any(s != (1.0, 0.0) for s in scales) else source


def _holds_raw(cells: Array, recording: DiademRecording, index: int) -> bool:
    """Return whether a column begins with the stored numbers of a channel."""
    try:
        numbers = recording.raw(index, 0, len(cells))
    except OSError:
        return False
    numbers[np.abs(numbers) > _NO_VALUE] = np.nan  # an empty cell in text
    n = min(len(numbers), len(cells))
    return n >= _MIN_ROWS and bool(
        np.allclose(cells[:n], numbers[:n], rtol=_DIGITS, atol=0, equal_nan=True)
    )
