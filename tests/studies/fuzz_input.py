"""An input of the fuzzer, and the names of what is in its folder."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

WORK, LOGS = "work", "logs"
RICH, RICH_LOGS = "rich", "rich-logs"
"""A work folder with every output, and the logs that it was made from."""


@dataclass(frozen=True, slots=True)
class Input:
    """A folder that was prepared, and what to do in it.

    Attributes
    ----------
    damage : str
        What was done to it.
    words : list of str
        Arguments of the program; paths are relative to the folder.
    rows : int or None
        Rows of the log, where it is known: each is kept or rejected.
    check : callable, optional
        From the work folder and what the call said to what is wrong with its tables.
    """

    damage: str
    words: list[str]
    rows: int | None = None
    check: Callable[[Path, str], str] | None = None
