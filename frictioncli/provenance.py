"""Provenance of results: program version, stage, settings and hashes of the inputs."""

import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

from frictioncli import __version__

_BLOCK_BYTES = 1 << 20
"""Bytes that are read at once; most logs are shorter. [bytes]"""


@dataclass(frozen=True, slots=True)
class Provenance:
    """Origin of an output.

    Attributes
    ----------
    program, version : str
        Name and version of the program.
    stage : str
        The command that made it.
    settings : mapping
        Settings of the command.
    inputs : mapping of str to str
        SHA-256 of each input, by name.
    """

    program: str = field(default="frictioncli", kw_only=True)
    version: str = field(default=__version__, kw_only=True)
    stage: str
    settings: Mapping[str, Any] = field(default_factory=dict)
    inputs: Mapping[str, str] = field(default_factory=dict)

    def as_dict(self) -> dict[str, Any]:
        """Return the fields as plain values for JSON."""
        return {one.name: getattr(self, one.name) for one in fields(self)}


def sha256(path: Path) -> str:
    """Return the SHA-256 of a file, or of the digests of a folder's files in name order."""
    if path.is_dir():
        digest = hashlib.sha256()
        for part in sorted(p for p in path.rglob("*") if p.is_file()):
            digest.update(sha256(part).encode())
        return digest.hexdigest()
    digest = hashlib.sha256()
    with path.open("rb", buffering=0) as stream:
        while block := stream.read(_BLOCK_BYTES):
            digest.update(block)
    return digest.hexdigest()


def input_hashes(paths: Iterable[Path]) -> dict[str, str]:
    """Return the SHA-256 of files of a work folder, by name."""
    return {path.name: sha256(path) for path in paths}
