"""Samples of one recording on disk, until it is known whether the recording is usable."""

from collections.abc import Iterable, Iterator

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from frictioncli.arrays import Array
from frictioncli.logs.channels import channel_names as names
from frictioncli.logs.samples.log_rows import LogRows
from frictioncli.pairs.partitioned_store import PartitionedStore

_CHANNELS = (
    names.POSITION,
    names.VELOCITY,
    names.TORQUE,
    names.MOTOR_TEMPERATURE,
    names.HOUSING_TEMPERATURE,
    names.LOAD,
    names.OTHER_SPEED,
    names.POSE,
    names.PAYLOAD,
)
_SAMPLES = "samples"
_BATCH_ROWS = 1 << 16
_SCHEMA = pa.schema(
    [
        ("run", pa.dictionary(pa.int32(), pa.string())),
        ("recording", pa.dictionary(pa.int32(), pa.string())),
        ("joint", pa.int16()),
        ("time", pa.float64()),
        *((name, pa.float64()) for name in _CHANNELS),
    ]
)

SampleStore = PartitionedStore[str]
"""Samples by name of the recording."""


def store_samples(
    store: SampleStore, recording: str, start: float, rows: LogRows, time: Array
) -> None:
    """Add samples to a store, joint by joint.

    Parameters
    ----------
    store : SampleStore
        The store.
    recording : str
        Name of the recording.
    start : float
        Start of the recording since the run's first sample. [s]
    rows : LogRows
        Samples of all joints.
    time : ndarray, shape (rows,)
        Time since the recording's first sample. [s]
    """
    missing = np.full(len(rows), np.nan)
    for joint in sorted({joint for joint, _ in rows.columns}):
        columns: dict[str, NDArray] = {
            "joint": np.full(len(rows), joint, np.int16),
            "time": time + start,
            **{name: rows.columns.get((joint, name), missing) for name in _CHANNELS},
        }
        store.add(recording, {_SAMPLES: columns})


def stored_samples(store: SampleStore, run: str) -> Iterator[pa.RecordBatch]:
    """Yield the samples of a store as rows of :data:`frictioncli.schemas.SAMPLES`."""
    for recording in store.keys:
        for (columns,) in store.read(recording, _SAMPLES):
            n = len(columns["time"])
            labels = [_repeated(run, n), _repeated(recording, n)]
            values = [pa.array(columns[name]) for name in _SCHEMA.names[2:]]
            yield pa.record_batch([*labels, *values], schema=_SCHEMA)


def combined(batches: Iterable[pa.RecordBatch]) -> Iterator[pa.RecordBatch]:
    """Yield the same rows in larger batches: many small ones are slow to process."""
    waiting: list[pa.RecordBatch] = []
    rows = 0
    for batch in batches:
        waiting.append(batch)
        rows += batch.num_rows
        if rows >= _BATCH_ROWS:
            yield from _concatenated(waiting)
            waiting, rows = [], 0
    if waiting:
        yield from _concatenated(waiting)


def _concatenated(batches: list[pa.RecordBatch]) -> list[pa.RecordBatch]:
    return pa.Table.from_batches(batches).unify_dictionaries().combine_chunks().to_batches()


def _repeated(text: str, n: int) -> pa.DictionaryArray:
    return pa.DictionaryArray.from_arrays(pa.array(np.zeros(n, np.int32)), pa.array([text]))
