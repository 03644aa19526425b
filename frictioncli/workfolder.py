"""Work folder: lock, removal of temporary files of killed runs, and check for outdated tables."""

import os
import shutil
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from filelock import FileLock, Timeout

from frictioncli import documents, tables
from frictioncli.errors import FrictionError, TableError
from frictioncli.files import DRAFT_PREFIX, cannot_write, check_name, is_there
from frictioncli.provenance import sha256

_LOCK = ".lock"
_TEMPORARY_PREFIXES = (DRAFT_PREFIX, ".reading.")


@contextmanager
def locked(work: Path) -> Iterator[None]:
    """Lock a work folder, so that no other process writes into it while the block runs.

    A missing folder is made. A process that holds the lock may take it again, as a run does for
    its stages. The operating system releases it when the process ends, however it ends. Temporary
    folders of killed processes are removed.

    Parameters
    ----------
    work : Path
        The work folder.

    Raises
    ------
    FrictionError
        If another process writes into the folder, or the system does not allow it.
    """
    check_name(work)
    try:
        made = _make_folder(work)
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
            _remove_temporary_folders(work)
        yield
    except OSError as error:
        raise _system_error(work, error) from error
    finally:
        if outermost:
            # still locked: a process that opened this file before finds that it is gone
            with suppress(OSError):
                os.unlink(lock.lock_file)
        lock.release()
        with suppress(OSError):
            for folder in made:
                folder.rmdir()


def outdated(paths: Iterable[Path]) -> list[str]:
    """Return warnings about outputs that were made from inputs which were replaced since.

    Parameters
    ----------
    paths : iterable of Path
        Outputs in a work folder; their inputs are checked too, and so on.

    Returns
    -------
    list of str
        One sentence per replaced input; empty where all outputs are up to date.
    """
    warnings: dict[str, None] = {}
    waiting, seen = list(paths), set()
    while waiting:
        output = waiting.pop(0)
        if output in seen or not output.is_file():
            continue
        seen.add(output)
        origin = origin_of(output)
        for name in origin.replaced:
            text = f"{output.name} was made from a different {name}"
            warnings[f"{text}; run 'frictioncli {origin.stage}' again"] = None
        waiting += [output.with_name(name) for name in origin.inputs]
    return list(warnings)


@dataclass(frozen=True, slots=True, kw_only=True)
class Origin:
    """Stage that made a file of a work folder, and the files there that it was made from.

    Attributes
    ----------
    stage : str
        The stage; empty where that is unknown.
    inputs : tuple of str
        Names of the inputs that lie in a work folder; logs do not.
    replaced : tuple of str
        Names of the inputs that are there, but with other content than then.
    """

    stage: str = ""
    inputs: tuple[str, ...] = ()
    replaced: tuple[str, ...] = ()


def origin_of(output: Path) -> Origin:
    """Return the stage and the inputs of a file of a work folder.

    Parameters
    ----------
    output : Path
        The file; one that does not exist has no origin.
    """
    if not output.is_file():
        return Origin()
    stage, inputs = _origin(output)
    if stage == "ingest":  # its inputs are logs, which lie elsewhere
        return Origin(stage=stage)
    return Origin(
        stage=stage,
        inputs=tuple(inputs),
        replaced=tuple(
            name
            for name, digest in inputs.items()
            if is_there(path := output.with_name(name)) and _is_replaced(path, output, digest)
        ),
    )


def _make_folder(work: Path) -> list[Path]:
    """Make the folder; return the folders that had to be made, innermost first."""
    missing = [path for path in (work, *work.parents) if not path.exists()]
    work.mkdir(parents=True, exist_ok=True)
    return missing


def _system_error(work: Path, error: OSError) -> FrictionError:
    """Return the error for an operation that the system did not allow."""
    if error.filename is None or work in Path(os.fsdecode(error.filename)).parents:
        return cannot_write(work, error)
    return FrictionError(f"{error.filename}: cannot be used ({error.strerror or error})")


def _remove_temporary_folders(work: Path) -> None:
    for path in work.iterdir():
        if path.name.startswith(_TEMPORARY_PREFIXES) and path.is_dir():
            shutil.rmtree(path, ignore_errors=True)


def _origin(output: Path) -> tuple[str, dict[str, str]]:
    """Return the stage that made an output and its inputs; both empty where that is unknown."""
    try:
        if output.suffix == ".json":
            provenance = documents.read_provenance(output)
            stage, inputs = (provenance.stage, provenance.inputs) if provenance else ("", {})
        elif output.suffix == ".parquet":
            metadata = tables.metadata(output)
            stage, inputs = str(metadata["stage"]), dict(metadata["inputs"])
        else:
            return "", {}
    except (TableError, ValueError, KeyError, TypeError):  # not written by this program
        return "", {}
    return stage, {name: digest for name, digest in inputs.items() if Path(name).name == name}


def _is_replaced(source: Path, output: Path, digest: str) -> bool:
    """Return whether ``digest`` is no longer the SHA-256 of a source."""
    if source.is_dir():
        return sha256(source) != digest
    status = source.stat()
    # a file that was not changed since the output was made need not be read again
    changed = max(status.st_mtime_ns, status.st_ctime_ns)
    return changed >= output.stat().st_mtime_ns and sha256(source) != digest
