"""The part of the MDF reader that uses asammdf, run in a process of its own.

On a damaged file asammdf may crash or never end; in a process of its own that costs one log only.
The request is a JSON object on stdin; the answer on stdout is a line of JSON, then an Arrow stream.

``{"path": ...}``
    The answer is ``{"version": ..., "base": ..., "signals": [[name, group, index], ...]}``, where
    ``base`` is the group whose samples become rows, or ``{"error": ...}``.
``{"path": ..., "base": ..., "signals": [[name, group, index], ...], "rows": ...}``
    The answer is ``{}`` and the values of the given signals in batches of at most ``rows`` rows.
"""

import json
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from frictioncli.arrays import Array
from frictioncli.logs.channels.channel_names import TORQUE
from frictioncli.logs.formats.containers import Rows, recognised_quantities, with_unit

_UNFINISHED = b"UnFinMF "
_FRAGMENT_BYTES = 1 << 20
_NUMBER_KINDS = "iufb"
_TOLERANCE = 1.001
"""Factor by which the hold time may exceed the longest sampling interval: rounding errors."""
_MEMORY_LIMIT = 4 << 30
"""Memory limit of the process; a damaged file may request any amount. [byte]"""
_TIME_LIMIT, _TIME_PER_BYTE = 30, 2 / (1 << 20)
"""Limit of its processor time: blocks of a damaged file may name each other as the next, in a
circle. Packed samples take a tenth of that. [s, s/byte]"""


@dataclass(frozen=True, slots=True)
class Signal:
    """A channel of numbers: name with unit, channel group, and index in the group."""

    name: str
    group: int
    index: int


@dataclass(frozen=True, slots=True)
class _Fragment:
    """Consecutive samples of one channel group.

    Attributes
    ----------
    times : ndarray, shape (n,)
        Time. [s]
    values : dict of int to ndarray, shape (n,)
        Values by column.
    """

    times: Array
    values: Rows


def main() -> None:
    """Answer the request on stdin."""
    # asammdf prints to stdout; only the answer may reach the pipe
    with os.fdopen(os.dup(sys.stdout.fileno()), "wb") as answer:
        os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
        request = json.load(sys.stdin)
        with suppress(OSError):
            _limit(os.stat(request["path"]).st_size)
        try:
            with opened(Path(request["path"])) as file:
                if "signals" in request:
                    _send_rows(answer, file, request)
                else:
                    _send(answer, _description(file))
        except Exception as error:  # asammdf raises anything, from KeyError to struct.error
            _send(answer, {"error": str(error) or type(error).__name__})
            raise


def _limit(size: int) -> None:
    """Limit memory and processor time, for a file of that size."""
    seconds = _TIME_LIMIT + int(size * _TIME_PER_BYTE)
    with suppress(ImportError, ValueError):  # not available on Windows
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (_MEMORY_LIMIT, _MEMORY_LIMIT))
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))


def _send(answer: BinaryIO, document: dict[str, Any]) -> None:
    answer.write(json.dumps(document).encode() + b"\n")


def _description(file: Any) -> dict[str, Any]:
    signals = signals_of(file)
    return {
        "version": file.version,
        "base": base_of(file, signals),
        "signals": [[signal.name, signal.group, signal.index] for signal in signals],
    }


def _send_rows(answer: BinaryIO, file: Any, request: dict[str, Any]) -> None:
    signals = [Signal(*signal) for signal in request["signals"]]
    schema = pa.schema([(str(column), pa.float64()) for column in range(len(signals))])
    _send(answer, {})
    stream = pa.ipc.new_stream(answer, schema)
    for values in merged_rows(file, signals, request["base"], request["rows"]):
        columns = [values[column] for column in range(len(signals))]
        stream.write_batch(pa.record_batch(columns, schema=schema))
    stream.close()


@contextmanager
def opened(path: Path) -> Iterator[Any]:
    """Open a measurement for reading in small parts."""
    from asammdf import MDF

    with path.open("rb") as stream:
        # given a path, asammdf maps the whole file into memory; it needs the path of an
        # unfinished file, to complete a copy of it
        is_unfinished = stream.read(len(_UNFINISHED)) == _UNFINISHED
        stream.seek(0)
        with MDF(path if is_unfinished else stream) as file:
            file.configure(read_fragment_size=_FRAGMENT_BYTES)
            yield file


def signals_of(file: Any) -> list[Signal]:
    """Return the channels of numbers in groups with a time, which is the first of each group."""
    found: list[Signal] = []
    for group, content in enumerate(file.groups):
        master = file.masters_db.get(group)
        if master is None or not content.channel_group.cycles_nr:
            continue
        found.append(Signal("time [s]", group, master))
        for index, channel in enumerate(content.channels):
            if index == master:
                continue
            first = next(file.iter_get(group=group, index=index), None)
            if first is None or first.samples.ndim > 1:
                continue
            if first.samples.dtype.kind in _NUMBER_KINDS:
                found.append(Signal(with_unit(channel.name, first.unit), group, index))
    return found


def base_of(file: Any, signals: Sequence[Signal]) -> int | None:
    """Return the longest group that holds the torque; the longest of all where none does."""
    groups = {signal.group for signal in signals}
    with_torque = {
        g
        for g in groups
        if TORQUE in recognised_quantities([s.name for s in signals if s.group == g])
    }
    return max(
        sorted(with_torque or groups),
        key=lambda group: int(file.groups[group].channel_group.cycles_nr),
        default=None,
    )


def merged_rows(file: Any, signals: Sequence[Signal], base: int, rows: int) -> Iterator[Rows]:
    """Yield the values of signals at the sample times of the base group.

    Parameters
    ----------
    file : asammdf.MDF
        The measurement.
    signals : sequence of Signal
        The columns.
    base : int
        Group whose samples become rows; the others are held between their samples.
    rows : int
        Most rows at a time.
    """
    wanted: dict[int, dict[int, Signal]] = {base: {}}
    for column, signal in enumerate(signals):
        wanted.setdefault(signal.group, {})[column] = signal
    base_fragments = _fragments(file, base, wanted.pop(base))
    others = [_ZeroOrderHold(_fragments(file, group, part)) for group, part in wanted.items()]
    for fragment in base_fragments:
        for begin in range(0, len(fragment.times), rows):
            part = slice(begin, begin + rows)
            values = {column: found[part] for column, found in fragment.values.items()}
            for other in others:
                values |= other.at(fragment.times[part])
            yield values


def _fragments(file: Any, group: int, wanted: dict[int, Signal]) -> Iterator[_Fragment]:
    """Yield the given channels of one group, fragment by fragment."""
    master = file.masters_db[group]
    streams = [file.iter_get(group=group, index=signal.index) for signal in wanted.values()]
    for time, *parts in zip(file.iter_get(group=group, index=master), *streams, strict=True):
        times = np.asarray(time.samples, np.float64)
        yield _Fragment(
            times,
            {
                column: _aligned(times, part.timestamps, part.samples)
                for column, part in zip(wanted, parts, strict=True)
            },
        )


def _aligned(times: Array, sample_times: Array, samples: NDArray[np.generic]) -> Array:
    """Return a value at each time; invalid samples, which asammdf leaves out, become NaN."""
    if len(samples) == len(times):
        return np.asarray(samples, np.float64)
    values = np.full(len(times), np.nan)
    values[np.searchsorted(times, sample_times)] = samples
    return values


class _ZeroOrderHold:
    """Values of one group at the times of another, held from sample to sample.

    Times must be given in ascending order.
    """

    def __init__(self, fragments: Iterator[_Fragment]) -> None:
        self._fragments = fragments
        self._known = next(fragments)
        self._longest_interval = float(np.max(np.diff(self._known.times), initial=0.0))
        self._ended = False

    def at(self, times: Array) -> Rows:
        """Return the last values before each time; NaN where there is none.

        The last sample of the group is held for the longest interval between two samples.

        Parameters
        ----------
        times : ndarray, shape (n,)
            Ascending times. [s]
        """
        while not self._ended and self._known.times[-1] <= times[-1]:
            following = next(self._fragments, None)
            if following is None:
                self._ended = True
            else:
                self._known = _joined(self._known, following)
                intervals = np.diff(self._known.times)
                self._longest_interval = max(self._longest_interval, float(intervals.max()))
        index = np.searchsorted(self._known.times, times, side="right") - 1
        outside = index < 0
        if self._ended:
            outside |= times > self._known.times[-1] + _TOLERANCE * self._longest_interval
        held = {
            column: np.where(outside, np.nan, values[np.maximum(index, 0)])
            for column, values in self._known.values.items()
        }
        self._known = _after(self._known, max(int(index[-1]) - 1, 0))
        return held


def _joined(first: _Fragment, second: _Fragment) -> _Fragment:
    return _Fragment(
        np.concatenate((first.times, second.times)),
        {
            column: np.concatenate((values, second.values[column]))
            for column, values in first.values.items()
        },
    )


def _after(fragment: _Fragment, begin: int) -> _Fragment:
    return _Fragment(
        fragment.times[begin:],
        {column: values[begin:] for column, values in fragment.values.items()},
    )


if __name__ == "__main__":
    main()
