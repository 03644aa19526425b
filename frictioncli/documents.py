"""JSON documents: typed records, written and read in one way.

Every JSON file of this program is one record, or one record per joint. A record is a frozen
:class:`msgspec.Struct` or dataclass whose fields are the keys of the document, in their order. When
a document is read, missing keys and wrong types are refused, and unknown keys are accepted, so that
documents can grow.
"""

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

import msgspec

from frictioncli.errors import TableError
from frictioncli.files import is_there, write_text
from frictioncli.provenance import Provenance

Record = TypeVar("Record")


class _Parts(msgspec.Struct):
    """The part of a document that says whether it holds several joints."""

    joints: dict[str, msgspec.Raw] | None = None


class _Origin(msgspec.Struct):
    """The part of a document that says what made it."""

    provenance: Provenance | None = None


def to_json(document: Any) -> str:
    """Return a document as JSON text: indented, in the order of its fields, NaN refused.

    Parameters
    ----------
    document : record, mapping, sequence or plain value
        Records may stand anywhere in it.

    Returns
    -------
    str
        The text, ending in a line feed.

    Examples
    --------
    >>> print(to_json({"speeds": (1.5, 3.0)}), end="")
    {
      "speeds": [
        1.5,
        3.0
      ]
    }
    """
    plain = _builtins(document)
    return json.dumps(plain, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def write(path: Path, document: Any, provenance: Provenance) -> None:
    """Write a document to a file, with its provenance as the last key.

    Parameters
    ----------
    path : Path
        The file.
    document : record
        The document.
    provenance : Provenance
        What made it.
    """
    write_text(path, to_json(_builtins(document) | {"provenance": provenance}))


def write_joints(
    path: Path, documents: Mapping[int, Any], main_joint: int, provenance: Provenance
) -> None:
    """Write one document per joint to a file.

    The keys of the main joint stand at the top level. If there are several joints, all of them
    stand under ``joints``, by number.

    Parameters
    ----------
    path : Path
        The file.
    documents : mapping of int to record
        Joint -> its document.
    main_joint : int
        The joint whose document stands at the top level.
    provenance : Provenance
        What made them.
    """
    whole = _builtins(documents[main_joint])
    if len(documents) > 1:
        whole["joints"] = {str(joint): documents[joint] for joint in sorted(documents)}
    write_text(path, to_json(whole | {"provenance": provenance}))


def read(path: Path, kind: type[Record], command: str) -> Record:
    """Return the document of a file.

    Parameters
    ----------
    path : Path
        The file.
    kind : type
        Type of the record.
    command : str
        The command that makes the file, such as ``compare``.

    Raises
    ------
    TableError
        If the file is missing, is not JSON or has not the fields of the record.
    """
    content = _content(path, command)
    with locate_faults(path, command):
        return decode(content, kind)


def read_joints(path: Path, kind: type[Record], command: str) -> list[Record]:
    """Return the documents of a file, one per joint.

    Parameters
    ----------
    path : Path
        The file, in the form of :func:`write_joints`.
    kind : type
        Type of the record of a joint.
    command : str
        The command that makes the file, such as ``fit``.

    Raises
    ------
    TableError
        If the file is missing, is not JSON or has not the fields of the record.
    """
    content = _content(path, command)
    with locate_faults(path, command):
        parts = decode(content, _Parts).joints
        if parts is None:
            return [decode(content, kind)]
        return [decode(part, kind, f"$.joints.{name}") for name, part in parts.items()]


def read_provenance(path: Path) -> Provenance | None:
    """Return what made a document; none where it does not say, or is of another program."""
    try:
        return decode(path.read_bytes(), _Origin).provenance
    except (OSError, TableError):
        return None


def decode(content: bytes | msgspec.Raw, kind: type[Record], place: str = "$") -> Record:
    """Return JSON text as a record.

    Parameters
    ----------
    content : bytes
        The text, in UTF-8.
    kind : type
        Type of the record.
    place : str
        Place of the text in its document, for messages.

    Raises
    ------
    TableError
        If it is not JSON or has not the fields of the record. The message says the place, what
        was expected and what was found.

    Examples
    --------
    >>> decode(b'{"size": [1.0, "large"]}', dict[str, list[float]])
    Traceback (most recent call last):
    frictioncli.errors.TableError: $[...][1]: expected float, got str
    """
    try:
        return msgspec.json.decode(content, type=kind)
    except msgspec.ValidationError as error:
        fault, _, inner = str(error).replace("`", "").partition(" - at $")
        raise TableError(f"{place}{inner}: {fault[0].lower()}{fault[1:]}") from error
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        raise TableError(f"is not JSON ({error})") from error


@contextmanager
def locate_faults(path: Path, command: str) -> Iterator[None]:
    """Name the file and the command that makes it in each ``TableError`` of the block."""
    try:
        yield
    except TableError as error:
        raise TableError(f"{path}: {error}; run 'frictioncli {command}' again") from error


def _content(path: Path, command: str) -> bytes:
    if not is_there(path):
        raise TableError(f"{path} is missing; run 'frictioncli {command}' first")
    try:
        return path.read_bytes()
    except OSError as error:
        raise TableError(f"{path}: cannot be read ({error.strerror or error})") from error


def _builtins(document: Any) -> Any:
    return msgspec.to_builtins(document, enc_hook=_plain)


def _plain(value: Any) -> Any:
    """Return an instance of a subclass, such as a NumPy float, as the plain value."""
    for kind in (float, str):
        if isinstance(value, kind):
            return kind(value)
    raise TypeError(f"{type(value).__name__} cannot be written as JSON")
