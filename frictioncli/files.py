"""Atomic writing: an output appears completely or not at all, even if the process is killed."""

import ctypes
import os
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from frictioncli.errors import FrictionError

DRAFT_PREFIX = ".writing."
"""Prefix of the temporary folders in which outputs are prepared."""

# platform -> system call that exchanges two names, and its constant for "relative to this folder"
_EXCHANGE_CALLS = {"linux": ("renameat2", -100), "darwin": ("renameatx_np", -2)}
_EXCHANGE_FLAG = 2


@contextmanager
def atomic_write(target: Path) -> Iterator[Path]:
    """Yield a path to write to; it replaces ``target`` when the block ends without error.

    The block may write a file or make a folder there. If it fails, what it wrote is removed and the
    old ``target`` stays.

    Parameters
    ----------
    target : Path
        File or folder to write; its folder is made.

    Yields
    ------
    Path
        Path in a temporary folder beside ``target``.

    Raises
    ------
    FrictionError
        If the folder cannot be made or written to, or the disk is full.
    """
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        temporary = Path(tempfile.mkdtemp(prefix=DRAFT_PREFIX, dir=target.parent))
    except OSError as error:
        raise cannot_write(target, error) from error
    try:
        draft = temporary / target.name
        yield draft
        _synchronize(draft)
        _replace(draft, target)
    except OSError as error:
        raise cannot_write(target, error) from error
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


def check_own(folder: Path, own: Callable[[str], bool]) -> None:
    """Check that a folder, which will be replaced, holds only files that this program makes.

    Parameters
    ----------
    folder : Path
        The folder; it need not exist.
    own : callable
        Says of a file's path in the folder, with ``/`` between its parts, whether it is one of
        those.

    Raises
    ------
    FrictionError
        If it holds another file.
    """
    if not folder.is_dir():
        return
    for path in sorted(folder.rglob("*")):
        if not path.is_dir() and not own(path.relative_to(folder).as_posix()):
            raise FrictionError(
                f"{folder}: holds {path.relative_to(folder)}, which frictioncli did not write, and"
                " would be replaced; move that file, or choose another folder with -w"
            )


def check_name(target: Path) -> None:
    """Check that tables can be written below a path: other programs need names in UTF-8.

    Raises
    ------
    FrictionError
        If its name, or that of a folder that it is in, is not UTF-8.
    """
    try:
        os.path.realpath(target).encode()
    except UnicodeEncodeError:
        raise FrictionError(f"{target}: the name is not UTF-8; choose another with -w") from None


def is_there(path: Path) -> bool:
    """Return whether there is a file or folder that can be read; no pipe, which has no end.

    Parameters
    ----------
    path : Path
        A file or folder of a work folder.
    """
    return path.is_file() or path.is_dir()


def write_text(target: Path, text: str) -> None:
    """Write a UTF-8 text file with plain line feeds, completely or not at all."""
    with atomic_write(target) as draft:
        draft.write_text(text, encoding="utf-8", newline="\n")


def cannot_write(target: Path, error: OSError) -> FrictionError:
    """Return the error for a file or folder that the system does not allow to be written."""
    reason = error.strerror or str(error)
    return FrictionError(f"{target}: cannot be written ({reason}); choose another folder with -w")


def _synchronize(draft: Path) -> None:
    """Wait until the contents are on disk: they must get there before the name."""
    parts = [*draft.rglob("*"), draft] if draft.is_dir() else [draft]
    for part in parts:
        if part.is_file():
            with part.open("rb+") as stream:
                os.fsync(stream.fileno())


def _replace(draft: Path, target: Path) -> None:
    """Rename the draft to the target; a replaced folder keeps the name of the draft."""
    if not draft.is_dir():
        check_own(target, lambda name: name.endswith(target.suffix))
    if not target.is_dir():
        os.replace(draft, target)
    elif not _exchange_names(draft, target):
        # where the system cannot exchange two names there is no target for a moment
        os.replace(target, draft.with_name("replaced"))
        os.replace(draft, target)


def _exchange_names(first: Path, second: Path) -> bool:
    """Exchange the names of two files or folders in one step; False where the system cannot."""
    if sys.platform not in _EXCHANGE_CALLS:
        return False
    name, folder = _EXCHANGE_CALLS[sys.platform]
    exchange = getattr(ctypes.CDLL(None), name, None)
    if exchange is None:
        return False
    status = exchange(
        folder, os.fsencode(first), folder, os.fsencode(second), ctypes.c_uint(_EXCHANGE_FLAG)
    )
    return bool(status == 0)
