"""File formats that can be read. A new one is a module beside these and a line in ``READERS``."""

from collections.abc import Iterable
from pathlib import Path
from typing import Protocol

from frictioncli.logs.formats.arrow_tables import read_arrow
from frictioncli.logs.formats.delimited import DelimitedText, read_delimited
from frictioncli.logs.formats.diadem import read_diadem
from frictioncli.logs.formats.encoding import head_of
from frictioncli.logs.formats.hdf5 import read_hdf5
from frictioncli.logs.formats.mdf import read_mdf
from frictioncli.logs.formats.ros import read_ros
from frictioncli.logs.formats.rtde import read_rtde
from frictioncli.logs.formats.split_time import with_joined_time
from frictioncli.logs.formats.struct_cells import read_struct_cells
from frictioncli.logs.formats.unsupported import read_foreign
from frictioncli.logs.log_source import CsvHints, LogSource, Refusal, UnreadableLog


class Reader(Protocol):
    """The function that opens files of one format."""

    def __call__(self, path: Path, head: bytes, hints: CsvHints) -> LogSource | Refusal | None:
        """Return the opened log, why it cannot be read, or None when it is another format."""
        ...


READERS: tuple[Reader, ...] = (
    read_diadem,
    read_arrow,
    read_hdf5,
    read_mdf,
    read_ros,
    read_rtde,
    read_foreign,
    read_struct_cells,
    read_delimited,
)
"""Asked in this order; the first that knows the file's beginning decides."""


def open_logs(paths: Iterable[Path], hints: CsvHints) -> list[LogSource | Refusal]:
    """Open files by their content; logs of a folder mostly look like the one before."""
    found: list[LogSource | Refusal] = []
    for path in paths:
        found.append(open_log(path, hints, found[-1] if found else None))
    return found


def open_log(
    path: Path, hints: CsvHints, like: LogSource | Refusal | None = None
) -> LogSource | Refusal:
    """Open a file by its content, whatever its name ends in.

    Parameters
    ----------
    path : Path
        The file.
    hints : CsvHints
        What the user says of a text's form.
    like : LogSource or Refusal, optional
        What another file was found to be; a text of just that form needs no search.
    """
    try:
        head = head_of(path)
        alike = like.like(path, head) if isinstance(like, DelimitedText) else None
        if alike is not None:
            return alike
        for reader in READERS:
            found = reader(path, head.content, hints)
            if found is not None:
                return found if isinstance(found, Refusal) else with_joined_time(found)
    except UnreadableLog as error:
        return Refusal("unreadable_file", str(error))
    return Refusal("not_a_log", "no known format")
