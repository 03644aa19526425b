"""Where a result comes from: program version, stage, settings and the hashes of its inputs."""

import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from frictioncli import __version__

_BLOCK_BYTES = 1 << 20
"""Most logs are hashed at once: threads that read them would have to wait for one another."""


@dataclass(frozen=True, slots=True)
class Provenance:
    """What made an output.

    Attributes
    ----------
    program, version : str
        Name and version of the program.
    stage : str
        The command.
    settings : mapping
        Its settings.
    inputs : mapping of str to str
        Name of each input -> its SHA-256.
    """

    program: str = field(default="frictioncli", kw_only=True)
    version: str = field(default=__version__, kw_only=True)
    stage: str
    settings: Mapping[str, Any] = field(default_factory=dict)
    inputs: Mapping[str, str] = field(default_factory=dict)

    def as_dict(self) -> dict[str, Any]:
        """Return plain values."""
        return asdict(self)


def sha256(path: Path) -> str:
    """Return the SHA-256 of a file, or of a folder's files in name order."""
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


def hashes(paths: Iterable[Path]) -> dict[str, str]:
    """Return name -> SHA-256 for the files of a work folder that a stage has read."""
    return {path.name: sha256(path) for path in paths}
