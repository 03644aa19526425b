"""Record in the work folder of a joint: its row of the fleet's table, and the state of the work."""

import hashlib
import shutil
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from frictioncli import documents
from frictioncli.errors import FrictionError, TableError
from frictioncli.files import write_text
from frictioncli.provenance import sha256
from frictioncli.workfiles import MADE_BY_RUN

RECORD = "fleet.json"
"""Name of the record; it exists from the beginning of the work on a joint."""

FAILURE = "failure.txt"
"""Name of the file with the details of a failure."""


@dataclass(frozen=True, slots=True, kw_only=True)
class JointRecord:
    """State of a joint.

    Attributes
    ----------
    key : str or None
        Digest of inputs, settings and program version; None while the joint is not done.
    row : mapping
        Row of the table :data:`frictioncli.schemas.FLEET`.
    outputs : mapping of str to str
        Digest of each file of the joint by its path in the folder; empty while it is not done.
    digest : str
        Digest of the other fields: a row that is damaged is not taken over into the table.
    """

    key: str | None
    row: Mapping[str, Any]
    outputs: Mapping[str, str] = field(default_factory=dict)
    digest: str = ""

    def own_digest(self) -> str:
        """Return the digest of all fields but ``digest``, as they are written."""
        text = documents.to_json(replace(self, digest=""))
        return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()


def read_record(work: Path) -> JointRecord | None:
    """Return the record of a work folder; None if it is missing or damaged."""
    try:
        record = documents.decode((work / RECORD).read_bytes(), JointRecord)
        return record if record.digest == record.own_digest() else None
    except (OSError, ValueError, TableError):
        return None


def output_digests(work: Path) -> dict[str, str]:
    """Return the digest of each file that the chain has made in a folder.

    Parameters
    ----------
    work : Path
        Work folder of a joint.
    """
    places = (work / name for name in MADE_BY_RUN)
    files = (path for place in places for path in (place, *place.rglob("*")) if path.is_file())
    return {path.relative_to(work).as_posix(): sha256(path) for path in sorted(files)}


def write_record(work: Path, record: JointRecord) -> None:
    """Write the record of a joint into its work folder."""
    write_text(work / RECORD, documents.to_json(replace(record, digest=record.own_digest())))


def read_row(work: Path) -> Mapping[str, Any]:
    """Return the row of a joint.

    Raises
    ------
    TableError
        If the work folder has no record.
    """
    record = read_record(work)
    if record is None:
        raise TableError(f"{work / RECORD} is missing or damaged; run 'frictioncli fleet' again")
    return record.row


def check_folder(work: Path) -> None:
    """Check that a work folder is empty or was made by a fleet: outputs in it will be removed.

    Raises
    ------
    FrictionError
        If it holds files but no record.
    """
    if work.exists() and not work.is_dir():
        raise FrictionError(f"{work} is a file; choose another folder with -w")
    if not work.is_dir() or (work / RECORD).exists():
        return
    if any(not path.name.startswith(".") for path in work.iterdir()):
        raise FrictionError(
            f"{work}: holds files that 'fleet' did not write and would delete; choose another"
            " folder with -w"
        )


def reset_folder(work: Path, row: Mapping[str, Any]) -> None:
    """Write the record of a joint that is not done, and remove the outputs of a former call.

    What the chain does not make stays: exports, plans, and files of the user.

    Parameters
    ----------
    work : Path
        Work folder of the joint.
    row : mapping
        Row of the joint.
    """
    write_record(work, JointRecord(key=None, row=row))
    for name in (*MADE_BY_RUN, FAILURE):
        path = work / name
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)
        else:
            path.unlink(missing_ok=True)
