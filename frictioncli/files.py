"""Output files and folders that appear whole or not at all."""

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from frictioncli.errors import FrictionError


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
        box = Path(tempfile.mkdtemp(prefix=f".{target.name}.", dir=target.parent))
    except OSError as error:
        raise _cannot_write(target, error) from error
    try:
        draft = box / target.name
        yield draft
        if target.is_dir():
            os.replace(target, box / "replaced")
        os.replace(draft, target)
    except OSError as error:
        raise _cannot_write(target, error) from error
    finally:
        shutil.rmtree(box, ignore_errors=True)


def write_text(target: Path, text: str) -> None:
    """Write a UTF-8 text file with plain line feeds, whole or not at all."""
    with whole(target) as draft:
        draft.write_text(text, encoding="utf-8", newline="\n")


def _cannot_write(target: Path, error: OSError) -> FrictionError:
    reason = error.strerror or str(error)
    return FrictionError(f"{target}: cannot be written ({reason}); choose another folder with -w")
