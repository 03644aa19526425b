"""ASAM MDF measurements, merged over their channel groups, read with asammdf (extra ``mdf``)."""

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
_PATIENCE = 10.0  # [s]

_Signal = tuple[str, int, int]
"""Name with unit, channel group and place in there, as the process names it."""


def read_mdf(path: Path, head: bytes, hints: CsvHints) -> ContainerLog | Refusal | None:
    """Open an ASAM MDF measurement; None when it is another format.

    Rows are the samples of the group that holds the torque. Values of other groups are merged by
    their last value before each of them.

    Raises
    ------
    UnreadableLog
        If it is damaged.
    """
    if not head.startswith(_MAGICS):
        return None
    packed = refuse_compressed(path, _WHAT)
    if packed is not None:
        return packed
    if find_spec("asammdf") is None:
        return refuse_without_package(_WHAT, "mdf")
    with _answer({"path": str(path)}) as (found, _):
        base, signals = found["base"], [_signal(*signal) for signal in found["signals"]]
    if base is None:
        return Refusal("not_a_log", f"{_WHAT} without samples in time")
    own = [signal for signal in signals if signal[1] == base]
    taken = {name for name, *_ in own}
    columns = (*own, *(s for s in signals if s[1] != base and s[0] not in taken))
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
    """Yield the values of the asked columns; see :class:`ContainerLog`."""
    asked = [signals[column] for column in columns]
    request = {"path": str(path), "base": base, "asked": asked, "rows": rows}
    with _answer(request) as (_, stream), pa.ipc.open_stream(stream) as batches:
        for batch in batches:
            values = (column.to_numpy() for column in batch.columns)
            yield dict(zip(columns, values, strict=True))


@contextmanager
def _answer(request: dict[str, Any]) -> Iterator[tuple[dict[str, Any], IO[bytes]]]:
    """Ask the process that uses asammdf; give its answer's first line, and what follows that.

    Raises
    ------
    UnreadableLog
        If it fails, or breaks down before the end.
    """
    package = str(Path(__file__).parents[3])
    # not as a module by name alone: the same package is to be found whatever the folder
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
            first = json.loads(process.stdout.readline() or '{"error": "asammdf broke down"}')
            if "error" in first:
                raise UnreadableLog(f"cannot be read as {_WHAT} ({first['error']})")
            yield first, process.stdout
            # an Arrow stream that breaks off between two batches looks whole
            if process.wait() != 0:
                raise UnreadableLog(f"cannot be read to its end as {_WHAT}: asammdf broke down")
        finally:
            # a process that is asked no more ends by itself, and takes its temporary files along
            process.stdout.close()
            with suppress(subprocess.TimeoutExpired):
                process.wait(_PATIENCE)
            process.kill()
