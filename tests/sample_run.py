"""What takes long to make, once for all processes of the tests; the run on the sample logs."""

import shutil
import subprocess
import sys
from collections.abc import Callable
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


def shared_folder(own: Path, worker: str) -> Path:
    """Return the temporary folder that all processes of the tests share.

    Parameters
    ----------
    own : Path
        That of this process.
    worker : str
        Its name; ``master`` where it is the only one.
    """
    return own if worker == "master" else own.parent


def made_once(shared: Path, name: str, make: Callable[[Path], object]) -> Path:
    """Return a folder below one that all processes share; who comes first makes it.

    Parameters
    ----------
    shared : Path
        As of :func:`shared_folder`.
    name : str
        Name of the folder.
    make : callable
        Fills it, given its path; it does not exist before.
    """
    folder, whole = shared / name, shared / f"{name}.whole"
    with FileLock(shared / f"{name}.lock"):
        if not whole.exists():
            shutil.rmtree(folder, ignore_errors=True)
            make(folder)
            whole.touch()
    return folder


def make_sample_run(folder: Path) -> None:
    """Make the work folder of the sample logs."""
    command(*WORDS, str(folder))
