"""The part of the MDF reader that uses asammdf, run as a process of its own.

On a damaged file asammdf may bring its process down or never end; here that costs one log. The
request is a JSON object on stdin, the answer a line of JSON on stdout, then an Arrow stream:

``{"path": ...}``
    is answered by ``{"version": ..., "base": ..., "signals": [[name, group, index], ...]}``, where
    ``base`` is the group whose samples become rows, or by ``{"error": ...}``;
``{"path": ..., "base": ..., "asked": [[name, group, index], ...], "rows": ...}``
    by ``{}`` and the values of the signals asked for, in parts of at most as many rows.
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
from frictioncli.logs.channels.aliases import TORQUE
from frictioncli.logs.formats.containers import Rows, recognised_quantities, with_unit

_BROKEN_OFF = b"UnFinMF "
_FRAGMENT_BYTES = 1 << 20
_NUMBERS = "iufb"
_ROUNDED = 1.001
"""A wait is as long as another up to this factor."""
_MEMORY = 4 << 30
"""What a damaged file can make this process take at most. [bytes]"""


@dataclass(frozen=True, slots=True)
class Signal:
    """A channel of numbers: its name with unit, its group and its place in there."""

    name: str
    group: int
    index: int


@dataclass(frozen=True, slots=True)
class _Fragment:
    """Consecutive samples of one group: times [s], and per column the values, shape (n,)."""

    times: Array
    values: Rows


def main() -> None:
    """Answer the request on stdin."""
    # asammdf prints: only the answer shall reach the pipe
    with os.fdopen(os.dup(sys.stdout.fileno()), "wb") as answer:
        os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
        _limit_memory()
        request = json.load(sys.stdin)
        try:
            with opened(Path(request["path"])) as file:
                if "asked" in request:
                    _send_rows(answer, file, request)
                else:
                    _send(answer, _described(file))
        except Exception as error:  # asammdf raises anything, from KeyError to struct.error
            _send(answer, {"error": str(error) or type(error).__name__})
            raise


def _limit_memory() -> None:
    with suppress(ImportError, ValueError):  # there is no such limit on Windows
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, _MEMORY))


def _send(answer: BinaryIO, document: dict[str, Any]) -> None:
    answer.write(json.dumps(document).encode() + b"\n")


def _described(file: Any) -> dict[str, Any]:
    signals = signals_of(file)
    return {
        "version": file.version,
        "base": base_of(file, signals),
        "signals": [[signal.name, signal.group, signal.index] for signal in signals],
    }


def _send_rows(answer: BinaryIO, file: Any, request: dict[str, Any]) -> None:
    asked = [Signal(*signal) for signal in request["asked"]]
    schema = pa.schema([(str(column), pa.float64()) for column in range(len(asked))])
    _send(answer, {})
    stream = pa.ipc.new_stream(answer, schema)
    for values in rows_at(file, asked, request["base"], request["rows"]):
        columns = [values[column] for column in range(len(asked))]
        stream.write_batch(pa.record_batch(columns, schema=schema))
    stream.close()


@contextmanager
def opened(path: Path) -> Iterator[Any]:
    """Open a measurement to be read in small parts."""
    from asammdf import MDF

    with path.open("rb") as stream:
        # of a path, asammdf would map the whole file into memory; one that was broken off it has
        # to mend first, in a copy
        broken_off = stream.read(len(_BROKEN_OFF)) == _BROKEN_OFF
        stream.seek(0)
        with MDF(path if broken_off else stream) as file:
            file.configure(read_fragment_size=_FRAGMENT_BYTES)
            yield file


def signals_of(file: Any) -> list[Signal]:
    """Return the channels of numbers that have a time; a group's time stands first."""
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
            if first.samples.dtype.kind in _NUMBERS:
                found.append(Signal(with_unit(channel.name, first.unit), group, index))
    return found


def base_of(file: Any, signals: Sequence[Signal]) -> int | None:
    """Return the group that holds the torque, of several the longest; else just the longest."""
    groups = {signal.group for signal in signals}
    torque = {
        g
        for g in groups
        if TORQUE in recognised_quantities([s.name for s in signals if s.group == g])
    }
    return max(
        sorted(torque or groups),
        key=lambda group: int(file.groups[group].channel_group.cycles_nr),
        default=None,
    )


def rows_at(file: Any, asked: Sequence[Signal], base: int, rows: int) -> Iterator[Rows]:
    """Yield the values of some signals at the times of the base group's samples."""
    wanted: dict[int, dict[int, Signal]] = {base: {}}
    for column, signal in enumerate(asked):
        wanted.setdefault(signal.group, {})[column] = signal
    own = _fragments(file, base, wanted.pop(base))
    others = [_Held(_fragments(file, group, signals)) for group, signals in wanted.items()]
    for fragment in own:
        for begin in range(0, len(fragment.times), rows):
            part = slice(begin, begin + rows)
            values = {column: found[part] for column, found in fragment.values.items()}
            for other in others:
                values |= other.at(fragment.times[part])
            yield values


def _fragments(file: Any, group: int, wanted: dict[int, Signal]) -> Iterator[_Fragment]:
    """Yield some channels of one group in step with each other."""
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


def _aligned(times: Array, own: Array, samples: NDArray[np.generic]) -> Array:
    """Return a value per time, NaN where the measurement marks a sample as invalid."""
    if len(samples) == len(times):
        return np.asarray(samples, np.float64)
    values = np.full(len(times), np.nan)
    values[np.searchsorted(times, own)] = samples
    return values


class _Held:
    """The last values of a group at the times of another; asked in ascending order."""

    def __init__(self, fragments: Iterator[_Fragment]) -> None:
        self._fragments = fragments
        self._known = next(fragments)
        self._longest_wait = float(np.max(np.diff(self._known.times), initial=0.0))
        self._ended = False

    def at(self, times: Array) -> Rows:
        """Return the values at some times [s]; NaN before the first sample and after the last.

        The last stands for as long as the longest wait between two samples.
        """
        while not self._ended and self._known.times[-1] <= times[-1]:
            following = next(self._fragments, None)
            if following is None:
                self._ended = True
            else:
                self._known = _joined(self._known, following)
                waits = np.diff(self._known.times)
                self._longest_wait = max(self._longest_wait, float(waits.max()))
        place = np.searchsorted(self._known.times, times, side="right") - 1
        outside = place < 0
        if self._ended:
            outside |= times > self._known.times[-1] + _ROUNDED * self._longest_wait
        held = {
            column: np.where(outside, np.nan, values[np.maximum(place, 0)])
            for column, values in self._known.values.items()
        }
        self._known = _after(self._known, max(int(place[-1]) - 1, 0))
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
