"""Output files and folders that appear whole or not at all, whenever the process is killed."""

import ctypes
import os
import shutil
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from frictioncli.errors import FrictionError

DRAFT = ".writing."
"""Beginning of the names of the folders in which outputs are prepared."""

# system -> its call that exchanges two names, and its number for "relative to this folder"
_EXCHANGE = {"linux": ("renameat2", -100), "darwin": ("renameatx_np", -2)}
_SWAP = 2


@contextmanager
def whole(target: Path) -> Iterator[Path]:
    """Yield a path beside ``target`` to write to; it takes ``target``'s place at the end.

    When the body fails, what it wrote is removed and the old ``target`` stays. The body may write
    a file or make a folder there.

    Raises
    ------
    FrictionError
        If the folder cannot be made or written to, or the disk is full.
    """
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        box = Path(tempfile.mkdtemp(prefix=DRAFT, dir=target.parent))
    except OSError as error:
        raise cannot_write(target, error) from error
    try:
        draft = box / target.name
        yield draft
        _on_disk(draft)
        _placed(draft, target)
    except OSError as error:
        raise cannot_write(target, error) from error
    finally:
        shutil.rmtree(box, ignore_errors=True)


def write_text(target: Path, text: str) -> None:
    """Write a UTF-8 text file with plain line feeds, whole or not at all."""
    with whole(target) as draft:
        draft.write_text(text, encoding="utf-8", newline="\n")


def cannot_write(target: Path, error: OSError) -> FrictionError:
    """Return the message for a file or folder that the system does not let us write."""
    reason = error.strerror or str(error)
    return FrictionError(f"{target}: cannot be written ({reason}); choose another folder with -w")


def _on_disk(draft: Path) -> None:
    """Wait until the contents are on the disk: a name must not get there before them."""
    parts = [*draft.rglob("*"), draft] if draft.is_dir() else [draft]
    for part in parts:
        if part.is_file():
            with part.open("rb+") as stream:
                os.fsync(stream.fileno())


def _placed(draft: Path, target: Path) -> None:
    """Give the draft the target's name; what had it is left under the draft's."""
    if not target.is_dir():
        os.replace(draft, target)
    elif not _exchanged(draft, target):
        # the one way where the system cannot exchange two names: for a moment there is neither
        os.replace(target, draft.with_name("replaced"))
        os.replace(draft, target)


def _exchanged(first: Path, second: Path) -> bool:
    """Exchange the names of two files or folders in one step; False where the system cannot."""
    if sys.platform not in _EXCHANGE:
        return False
    name, here = _EXCHANGE[sys.platform]
    exchange = getattr(ctypes.CDLL(None), name, None)
    if exchange is None:
        return False
    done = exchange(here, os.fsencode(first), here, os.fsencode(second), ctypes.c_uint(_SWAP))
    return bool(done == 0)
