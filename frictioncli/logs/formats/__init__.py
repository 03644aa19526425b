"""Readers of log file formats.

A new format is a module in this folder and an entry in :data:`READERS`.
"""

from collections.abc import Iterable
from pathlib import Path
from typing import Protocol

from frictioncli.logs.formats.array_files import read_array_file
from frictioncli.logs.formats.arrow_tables import read_arrow
from frictioncli.logs.formats.delimited import DelimitedText, read_delimited
from frictioncli.logs.formats.diadem import read_diadem
from frictioncli.logs.formats.encoding import read_head
from frictioncli.logs.formats.hdf5 import read_hdf5
from frictioncli.logs.formats.json_lines import read_json_lines
from frictioncli.logs.formats.list_cells import read_list_cells
from frictioncli.logs.formats.mdf import read_mdf
from frictioncli.logs.formats.ros import read_ros
from frictioncli.logs.formats.row_clock import RowClock
from frictioncli.logs.formats.rtde import read_rtde
from frictioncli.logs.formats.split_time import with_joined_time
from frictioncli.logs.formats.struct_cells import read_struct_cells
from frictioncli.logs.formats.unsupported import refuse_unsupported
from frictioncli.logs.log_source import CsvHints, LogSource, Refusal, UnreadableLog


class Reader(Protocol):
    """The function that opens files of one format."""

    def __call__(self, path: Path, head: bytes, hints: CsvHints) -> LogSource | Refusal | None:
        """Return the opened log, why it cannot be read, or None when it is another format."""
        ...


READERS: tuple[Reader, ...] = (
    read_diadem,
    read_arrow,
    read_array_file,
    read_hdf5,
    read_mdf,
    read_ros,
    read_rtde,
    read_json_lines,
    refuse_unsupported,
    read_struct_cells,
    read_list_cells,
    read_delimited,
)
"""Tried in this order; the first that recognises the beginning of a file decides."""


def open_logs(paths: Iterable[Path], hints: CsvHints) -> list[LogSource | Refusal]:
    """Open files by their content.

    Each is first compared with the one before it, as the logs of a folder usually share a layout.

    Parameters
    ----------
    paths : iterable of Path
        The files.
    hints : CsvHints
        Form of text files, given by the user.

    Returns
    -------
    list of LogSource or Refusal
        The opened log of each file, or why it cannot be read.
    """
    found: list[LogSource | Refusal] = []
    for path in paths:
        found.append(open_log(path, hints, found[-1] if found else None))
    return found


def open_log(
    path: Path, hints: CsvHints, like: LogSource | Refusal | None = None
) -> LogSource | Refusal:
    r"""Open a file by its content, whatever the suffix of its name.

    Parameters
    ----------
    path : Path
        The file.
    hints : CsvHints
        Form of a text file, given by the user.
    like : LogSource or Refusal, optional
        Another opened file; a text file with the same layout needs no detection.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     file = Path(folder, "log.csv")
    ...     _ = file.write_text("time;position\n0,0;1,5\n0,1;2,5\n")
    ...     log = open_log(file, CsvHints())
    ...     batch = next(log.batches([0, 1], 1000))
    >>> log.columns, log.form
    (('time', 'position'), "text, ';', decimal comma, UTF-8")
    >>> batch.values[1]
    array([1.5, 2.5])
    """
    try:
        head = read_head(path)
        if isinstance(like, DelimitedText):
            same_layout = like.with_same_layout(path, head) if hints.period is None else None
            if same_layout is not None:
                return same_layout
        for reader in READERS:
            found = reader(path, head.content, hints)
            if found is not None:
                return found if isinstance(found, Refusal) else _with_time(found, hints)
    except UnreadableLog as error:
        return Refusal("unreadable_file", str(error))
    return Refusal("not_a_log", "no known format")


def _with_time(source: LogSource, hints: CsvHints) -> LogSource:
    """Return a source with its time in one column, made from the rows if the user says so."""
    joined = with_joined_time(source)
    return joined if hints.period is None else RowClock(joined, hints.period)
