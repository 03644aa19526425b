"""File formats that can be read. A new one is a module beside these and a line in ``READERS``."""

from pathlib import Path

from frictioncli.reading.formats.base import CsvHints, Reader, Refusal, Source
from frictioncli.reading.formats.delimited import read_delimited
from frictioncli.reading.formats.encoding import UnreadableLog, head_of
from frictioncli.reading.formats.foreign import read_foreign

READERS: tuple[Reader, ...] = (read_foreign, read_delimited)
"""Asked in this order; the first that knows the file's beginning decides."""


def open_log(path: Path, hints: CsvHints) -> Source | Refusal:
    """Open a file by its content, whatever its name ends in."""
    try:
        head = head_of(path)
    except UnreadableLog as error:
        return Refusal("unreadable_file", str(error))
    for reader in READERS:
        found = reader(path, head, hints)
        if found is not None:
            return found
    return Refusal("not_a_log", "no known format")
