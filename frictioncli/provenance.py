"""Where a result comes from: program version, stage, settings and the hashes of its inputs."""

import hashlib
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from frictioncli import __version__

_BLOCK_BYTES = 1 << 20
"""Most logs are hashed at once: threads that read them would have to wait for one another."""


@dataclass(frozen=True, slots=True)
class Provenance:
    """What made an output. ``inputs`` maps the name of each input to its SHA-256."""

    stage: str
    settings: Mapping[str, Any] = field(default_factory=dict)
    inputs: Mapping[str, str] = field(default_factory=dict)
    version: str = __version__

    def as_dict(self) -> dict[str, Any]:
        """Return plain values, ready for JSON."""
        return {
            "program": "frictioncli",
            "version": self.version,
            "stage": self.stage,
            "settings": dict(self.settings),
            "inputs": dict(self.inputs),
        }


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


def to_json(value: Any) -> str:
    """Return JSON as this program writes it: readable, stable, NaN refused."""
    return json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
