"""Inputs that something was found with, kept as files: each is tried again by every later call."""

import json
import os
import tempfile
import zipfile
from pathlib import Path

from tests.studies.fuzz_call import call

ROOT = Path(__file__).parents[2]
FOUND = ROOT / "build" / "fuzz-corpus"
"""Where inputs of new findings go."""

KEPT = ROOT / "tests" / "robustness" / "corpus"
"""Inputs of former findings."""

_WORDS = "words.json"


def keep(form: str, number: int, folder: Path, words: list[str]) -> None:
    """Keep an input: its folder, and the words of the call in it."""
    FOUND.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(FOUND / f"{form}-{number}.zip", "w", zipfile.ZIP_DEFLATED) as packed:
        packed.writestr(_WORDS, json.dumps(words))
        for path in sorted(folder.rglob("*")):
            if path.is_file():
                packed.write(path, path.relative_to(folder))


def tried_again(packed: Path) -> str:
    """Return what is wrong with the call on an input that was kept; empty where nothing is."""
    here = os.getcwd()
    with tempfile.TemporaryDirectory() as name:
        with zipfile.ZipFile(packed) as stored:
            stored.extractall(name)
        words = json.loads(Path(name, _WORDS).read_text(encoding="utf-8"))
        os.chdir(name)
        try:
            status, said = call(words)
        finally:
            os.chdir(here)
    return "" if status in (0, 2, 3) else f"{packed.name}: {status}\n{said}"


def corpus() -> list[Path]:
    """Return all inputs that are kept."""
    return [*sorted(KEPT.glob("*.zip")), *sorted(FOUND.glob("*.zip"))]
