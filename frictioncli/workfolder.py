"""The work folder: one writer at a time, no left-overs of killed ones, no silent mix of data."""

import json
import os
import shutil
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from filelock import FileLock, Timeout

from frictioncli import tables
from frictioncli.errors import FrictionError, TableError
from frictioncli.files import DRAFT, cannot_write
from frictioncli.provenance import sha256

_LOCK = ".lock"
_LEFT_OVERS = (DRAFT, ".reading.")


@contextmanager
def alone(work: Path) -> Iterator[None]:
    """Keep every other process from writing into a work folder while the block runs.

    The folder is made; whoever holds it already may enter again, as a run does for its stages. The
    operating system frees it when the process ends, however it ends. What a killed one left behind
    is removed on entering.

    Raises
    ------
    FrictionError
        If another process writes into the folder, or the system does not let this one.
    """
    try:
        made = _made(work)
        lock = FileLock(Path(os.path.realpath(work), _LOCK), timeout=0, is_singleton=True)
        lock.acquire()
    except Timeout:
        raise FrictionError(
            f"{work}: another frictioncli is writing into this folder; wait for it to end, or"
            " choose another folder with -w"
        ) from None
    except OSError as error:
        raise cannot_write(work, error) from error
    outermost = lock.lock_counter == 1
    try:
        if outermost:
            _sweep(work)
        yield
    except OSError as error:
        raise _refused(work, error) from error
    finally:
        if outermost:
            # still held: whoever opened this file before finds out that it is gone
            with suppress(OSError):
                os.unlink(lock.lock_file)
        lock.release()
        with suppress(OSError):
            for folder in made:
                folder.rmdir()


def outdated(paths: Iterable[Path]) -> list[str]:
    """Return what to say of tables that were made from others which were replaced since.

    Parameters
    ----------
    paths : iterable of Path
        Outputs in a work folder; they and all that they were made from are looked at.

    Returns
    -------
    list of str
        One sentence per replaced input; none where all belong together.
    """
    said: dict[str, None] = {}
    waiting, seen = list(paths), set()
    while waiting:
        output = waiting.pop(0)
        if output in seen or not output.is_file():
            continue
        seen.add(output)
        stage, inputs = _origin(output)
        if stage == "ingest":  # its inputs are logs, which lie elsewhere
            continue
        for name, digest in inputs.items():
            path = output.with_name(name)
            if path.exists() and _replaced(path, output, digest):
                text = f"{output.name} was made from another {name} than the one here"
                said[f"{text}; run 'frictioncli {stage}' again"] = None
            waiting.append(path)
    return list(said)


def _made(work: Path) -> list[Path]:
    """Make the folder; return what had to be made, innermost first."""
    missing = [path for path in (work, *work.parents) if not path.exists()]
    work.mkdir(parents=True, exist_ok=True)
    return missing


def _refused(work: Path, error: OSError) -> FrictionError:
    """Return the message for what the system did not let a stage do."""
    if error.filename is None or work in Path(os.fsdecode(error.filename)).parents:
        return cannot_write(work, error)
    return FrictionError(f"{error.filename}: cannot be used ({error.strerror or error})")


def _sweep(work: Path) -> None:
    for path in work.iterdir():
        if path.name.startswith(_LEFT_OVERS) and path.is_dir():
            shutil.rmtree(path, ignore_errors=True)


def _origin(output: Path) -> tuple[str, dict[str, str]]:
    """Return the stage that made an output and its inputs; none where a file does not say."""
    try:
        if output.suffix == ".parquet":
            provenance = tables.document(output)
        elif output.suffix == ".json":
            provenance = json.loads(output.read_text(encoding="utf-8"))["provenance"]
        else:
            return "", {}
        stage, inputs = str(provenance["stage"]), dict(provenance["inputs"])
    except (TableError, ValueError, KeyError, TypeError):  # the file of someone else
        return "", {}
    return stage, {name: digest for name, digest in inputs.items() if Path(name).name == name}


def _replaced(source: Path, output: Path, digest: str) -> bool:
    """Tell whether a source is no longer the one of which ``digest`` is the SHA-256."""
    if source.is_dir():
        return sha256(source) != digest
    status = source.stat()
    # what was not touched since the output was made need not be read again
    touched = max(status.st_mtime_ns, status.st_ctime_ns)
    return touched >= output.stat().st_mtime_ns and sha256(source) != digest
