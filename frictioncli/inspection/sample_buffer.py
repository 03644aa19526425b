"""Samples of one recording on their way to the search for constant speed."""

from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np
import pyarrow as pa

from frictioncli.arrays import Array
from frictioncli.logs.channels import aliases as names
from frictioncli.logs.samples.row_checks import LogRows

_CHANNELS = (
    names.POSITION,
    names.VELOCITY,
    names.TORQUE,
    names.MOTOR_TEMPERATURE,
    names.HOUSING_TEMPERATURE,
    names.LOAD,
)
_ENOUGH = 1 << 16
_SCHEMA = pa.schema(
    [
        ("run", pa.dictionary(pa.int32(), pa.string())),
        ("recording", pa.dictionary(pa.int32(), pa.string())),
        ("joint", pa.int16()),
        ("time", pa.float64()),
        *((name, pa.float64()) for name in _CHANNELS),
    ]
)


class SampleBuffer:
    """Takes the samples of one recording and gives them back, joint by joint of each block.

    A recording of any length needs no memory, but space on disk while it is looked at.

    Parameters
    ----------
    path : Path
        The file to use; it is overwritten.
    run, recording : str
        Names that the samples get.
    start : float
        Start of the recording since the run's first sample. [s]
    """

    def __init__(self, path: Path, run: str, recording: str, start: float) -> None:
        self._path, self._run, self._recording, self._start = path, run, recording, start
        self._sink = pa.OSFile(str(path), "wb")
        self._stream = pa.ipc.new_stream(self._sink, _SCHEMA)

    def add(self, block: LogRows, time: Array) -> None:
        """Take samples of all joints, ``time`` from the recording's first sample [s]."""
        n = len(block)
        missing = np.full(n, np.nan)
        for joint in sorted({joint for joint, _ in block.columns}):
            columns = [
                _repeated(self._run, n),
                _repeated(self._recording, n),
                pa.array(np.full(n, joint, np.int16)),
                pa.array(time + self._start),
                *(pa.array(block.columns.get((joint, name), missing)) for name in _CHANNELS),
            ]
            self._stream.write_batch(pa.record_batch(columns, schema=_SCHEMA))

    def close(self) -> None:
        """Take no more."""
        self._stream.close()
        self._sink.close()

    def samples(self) -> Iterator[pa.RecordBatch]:
        """Yield what was taken."""
        with pa.OSFile(str(self._path), "rb") as stream, pa.ipc.open_stream(stream) as batches:
            yield from batches


def gathered(batches: Iterable[pa.RecordBatch]) -> Iterator[pa.RecordBatch]:
    """Yield the same samples in batches of some size: many small ones are slow to look at."""
    held: list[pa.RecordBatch] = []
    rows = 0
    for batch in batches:
        held.append(batch)
        rows += batch.num_rows
        if rows >= _ENOUGH:
            yield from _joined(held)
            held, rows = [], 0
    if held:
        yield from _joined(held)


def _joined(batches: list[pa.RecordBatch]) -> list[pa.RecordBatch]:
    return pa.Table.from_batches(batches).unify_dictionaries().combine_chunks().to_batches()


def _repeated(text: str, n: int) -> pa.DictionaryArray:
    return pa.DictionaryArray.from_arrays(pa.array(np.zeros(n, np.int32)), pa.array([text]))
