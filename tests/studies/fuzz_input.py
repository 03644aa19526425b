"""An input of the fuzzer, and the names of what is in its folder."""

from dataclasses import dataclass

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
    """

    damage: str
    words: list[str]
    rows: int | None = None
