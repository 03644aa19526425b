"""ASAM MDF measurements, their channel groups merged, read with asammdf (extra ``mdf``)."""

import json
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import IO, Any

import pyarrow as pa

from frictioncli.logs.formats.compression import refuse_compressed
from frictioncli.logs.formats.containers import (
    ContainerLog,
    Rows,
    first_names,
    refuse_without_package,
)
from frictioncli.logs.log_source import CsvHints, Refusal, UnreadableLog

_MAGICS = (b"MDF     ", b"UnFinMF ")
_WHAT = "an MDF measurement"
_PROCESS = "frictioncli.logs.formats.mdf_process"
_TIMEOUT = 10.0
"""Time that the process is given to end by itself. [s]"""

_Signal = tuple[str, int, int]
"""Name with unit, channel group, and index of the channel in the group."""


def read_mdf(path: Path, head: bytes, hints: CsvHints) -> ContainerLog | Refusal | None:
    """Open an ASAM MDF measurement; None when it is another format.

    Rows are the samples of the group that holds the torque. The values of other groups are added
    by zero-order hold: the last value before each row.

    Raises
    ------
    UnreadableLog
        If the file is damaged.
    """
    if not head.startswith(_MAGICS):
        return None
    compressed = refuse_compressed(path, _WHAT)
    if compressed is not None:
        return compressed
    if find_spec("asammdf") is None:
        return refuse_without_package(_WHAT, "mdf")
    with _answer({"path": str(path)}) as (found, _):
        base, signals = found["base"], [_signal(*signal) for signal in found["signals"]]
    if base is None:
        return Refusal("not_a_log", f"{_WHAT} without samples in time")
    of_base = [signal for signal in signals if signal[1] == base]
    base_names = {name for name, *_ in of_base}
    columns = (*of_base, *(s for s in signals if s[1] != base and s[0] not in base_names))
    form = f"{_WHAT} {found['version']}, samples of group {base + 1}"
    others = [str(group + 1) for group in sorted({group for _, group, _ in signals} - {base})]
    if others:
        form += f", last values of group{'s' if len(others) > 1 else ''} {first_names(others)}"
    names = tuple(name for name, *_ in columns)
    return ContainerLog(path, names, form, partial(_rows, path, base, columns))


def _signal(name: str, group: int, index: int) -> _Signal:
    return name, group, index


def _rows(
    path: Path, base: int, signals: Sequence[_Signal], columns: Sequence[int], rows: int
) -> Iterator[Rows]:
    """Yield the values of the given columns; see :class:`ContainerLog`."""
    wanted = [signals[column] for column in columns]
    request = {"path": str(path), "base": base, "signals": wanted, "rows": rows}
    with _answer(request) as (_, stream), pa.ipc.open_stream(stream) as batches:
        for batch in batches:
            values = (column.to_numpy() for column in batch.columns)
            yield dict(zip(columns, values, strict=True))


@contextmanager
def _answer(request: dict[str, Any]) -> Iterator[tuple[dict[str, Any], IO[bytes]]]:
    """Send a request to the process that uses asammdf.

    Yields
    ------
    dict, binary stream
        The first line of the answer, and the stream of what follows.

    Raises
    ------
    UnreadableLog
        If the process reports an error or crashes before its end.
    """
    package = str(Path(__file__).parents[3])
    # with its path, so that the same package is imported whatever the working directory is
    command = f"import sys; sys.path.insert(0, {package!r}); from {_PROCESS} import main; main()"
    process = subprocess.Popen(
        [sys.executable, "-c", command],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
    )
    with process:
        assert process.stdin is not None
        assert process.stdout is not None
        try:
            process.stdin.write(json.dumps(request).encode())
            process.stdin.close()
            first = json.loads(process.stdout.readline() or '{"error": "asammdf crashed"}')
            if "error" in first:
                raise UnreadableLog(f"cannot be read as {_WHAT} ({first['error']})")
            yield first, process.stdout
            # an Arrow stream that ends between two batches looks complete
            if process.wait() != 0:
                raise UnreadableLog(f"cannot be read to its end as {_WHAT}: asammdf crashed")
        finally:
            # the process ends by itself when its output is closed, and removes its temporary files
            process.stdout.close()
            with suppress(subprocess.TimeoutExpired):
                process.wait(_TIMEOUT)
            process.kill()
