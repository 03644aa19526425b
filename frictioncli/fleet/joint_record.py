"""What a joint's work folder says of itself: its row of the fleet's table, and what it is of."""

import json
import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from frictioncli.documents import to_json
from frictioncli.errors import FrictionError, TableError
from frictioncli.files import write_text

NOTE = "fleet.json"
"""Stands in each joint's work folder, from the beginning of the work on it."""

FAILURE = "failure.txt"
"""Stands beside it where the joint has failed, with all that is known about it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Note:
    """The state of a joint.

    Attributes
    ----------
    key : str or None
        Digest of inputs, settings and program version; none while the joint is not done.
    row : mapping
        Its row of the table :data:`frictioncli.schemas.FLEET`.
    """

    key: str | None
    row: Mapping[str, Any]


def read_note(work: Path) -> Note | None:
    """Return the note of a work folder; none where there is none, or a damaged one."""
    try:
        document = json.loads((work / NOTE).read_text(encoding="utf-8"))
        return Note(key=document["key"], row=document["row"])
    except (OSError, ValueError, KeyError, TypeError):
        return None


def write_note(work: Path, note: Note) -> None:
    """Write a joint's note."""
    write_text(work / NOTE, to_json({"key": note.key, "row": dict(note.row)}))


def read_row(work: Path) -> Mapping[str, Any]:
    """Return a joint's row.

    Raises
    ------
    TableError
        If the joint has none.
    """
    note = read_note(work)
    if note is None:
        raise TableError(f"{work / NOTE} is missing or damaged; run 'frictioncli fleet' again")
    return note.row


def check_own(work: Path) -> None:
    """Refuse a work folder that something else has filled: it would be emptied.

    Raises
    ------
    FrictionError
        If it holds anything, but no note.
    """
    if work.exists() and not work.is_dir():
        raise FrictionError(f"{work} is a file; choose another folder with -w")
    if not work.is_dir() or (work / NOTE).exists():
        return
    if any(not path.name.startswith(".") for path in work.iterdir()):
        raise FrictionError(
            f"{work}: holds files that no fleet has made, and would be emptied; choose another"
            " folder with -w"
        )


def emptied(work: Path, row: Mapping[str, Any]) -> None:
    """Take a work folder for a joint: note that it is not done, and remove what is there."""
    write_note(work, Note(key=None, row=row))
    for path in work.iterdir():
        if path.name == NOTE or path.name.startswith("."):
            continue
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)
        else:
            path.unlink()
