"""What ``frictioncli run sample_logs/kr10`` leaves, made once for all processes of the tests."""

import subprocess
import sys
from pathlib import Path

from filelock import FileLock

ROOT = Path(__file__).parents[1]
WORDS = ("run", "sample_logs/kr10", "-w")


def command(*words: str) -> None:
    """Call the command in the project's folder, as a user would."""
    done = subprocess.run(
        [sys.executable, "-m", "frictioncli", *words],
        cwd=ROOT,
        capture_output=True,
        text=True,
        encoding="utf-8",
        check=False,
    )
    assert done.returncode == 0, f"{words}: {done.stderr}"


def made_once(shared: Path) -> Path:
    """Return the work folder below a folder that all processes share; who comes first makes it."""
    folder = shared / "sample-run"
    with FileLock(shared / "sample-run.lock"):
        if not folder.exists():
            begun = shared / "sample-run-begun"
            command(*WORDS, str(begun))
            begun.rename(folder)
    return folder
