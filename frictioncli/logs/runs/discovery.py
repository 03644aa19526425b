"""Discovery of logs: runs and their files, from the files and folders named by the user."""

import os
import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from frictioncli.errors import LogError
from frictioncli.logs.formats.compression import SUFFIXES
from frictioncli.logs.runs import manifest
from frictioncli.plain_text import printable
from frictioncli.workfiles import MADE_BY_RUN

Logs = Sequence[Path] | Mapping[str, Path]
"""Log files and folders, where each folder is a run; or run name -> its file or folder."""

_DIGITS = re.compile(r"(\d+)")
_IGNORED = frozenset({manifest.NAME, "truth.json", "metadata.yaml", "thumbs.db", "desktop.ini"})


@dataclass(frozen=True, eq=False)
class LogFile:
    """A file that may be a log; instances are compared by identity."""

    path: Path

    @cached_property
    def stem(self) -> str:
        """The name without its ending; ``.csv.gz`` is one ending."""
        packed = self.path.suffix.lower() in SUFFIXES
        return Path(self.path.stem).stem if packed else self.path.stem


@dataclass(frozen=True, slots=True)
class LogRun:
    """A folder of logs, usually of one day, with one thermal history.

    Attributes
    ----------
    name : str
        Unique among the runs.
    folder : Path
        Folder of its manifest, if there is one.
    files : tuple of LogFile
        In natural name order (s2 before s10).
    """

    name: str
    folder: Path
    files: tuple[LogFile, ...]


def natural_key(name: str) -> list[tuple[int, int, str]]:
    """Return a sort key that puts s2 before s10.

    Examples
    --------
    >>> sorted(["s10", "s2"], key=natural_key)
    ['s2', 's10']
    """
    parts = _DIGITS.split(name.lower())
    return [_numeric_key(part) if part.isdecimal() else (1, 0, part) for part in parts if part]


def _numeric_key(part: str) -> tuple[int, int, str]:
    """Return a key that orders digits by their number, however many they are."""
    digits = "".join(str(int(digit)) for digit in part).lstrip("0")
    return 0, len(digits), digits


def discover(logs: Logs, excluded: Path | None = None) -> tuple[LogRun, ...]:
    """Return the runs in the named files and folders, in the order of first mention.

    Parameters
    ----------
    logs : Logs
        Files and folders, or run name -> its file, or folder with all that lies below.
    excluded : Path, optional
        A folder whose files are no logs, as the work folder, which may lie among the logs.

    Raises
    ------
    LogError
        If a path does not exist, its name is not valid UTF-8 or has several lines, or no file is
        found.
    """
    paths = list(logs.values()) if isinstance(logs, Mapping) else logs
    if excluded is not None:
        for path in paths:
            _check_place(path, excluded)
    found = {path: _files_of(path, excluded) for path in paths}
    folders: dict[Path, dict[Path, None]] = {}
    for files in found.values():
        for file in files:
            _check_name(file)
            folders.setdefault(file.parent, {})[file] = None
    if not folders:
        named = ", ".join(str(path) for path in paths) or "nothing named"
        passed = "; links to folders are not followed"
        passed += f", the work folder {excluded} is not searched" if excluded is not None else ""
        raise LogError(
            f"{named}: no log files found; expected text logs of a joint's motion{passed}"
        )
    if isinstance(logs, Mapping):
        return tuple(
            LogRun(name, path if path.is_dir() else path.parent, _in_order(found[path]))
            for name, path in logs.items()
        )
    names = _unique_names(list(folders))
    for name in names.values():  # a folder named as . has a name, too
        _check_lines(name)
    return tuple(
        LogRun(names[folder], folder, _in_order(files)) for folder, files in folders.items()
    )


def _check_place(path: Path, work: Path) -> None:
    """Raise if a log that is named has the place of an output."""
    outputs = (work / name for name in MADE_BY_RUN)
    if path.is_file() and os.path.realpath(path) in map(os.path.realpath, outputs):
        raise LogError(
            f"{path}: has the place of an output of {work}, which would replace it; name the"
            " original logs, or choose another folder with -w"
        )


def _check_name(path: Path) -> None:
    """Raise if a name is not valid UTF-8, which tables cannot hold, or has several lines."""
    try:
        str(path).encode()
    except UnicodeEncodeError:
        raise LogError(f"{path}: its name is not UTF-8; rename it") from None
    _check_lines(str(path))


def _check_lines(name: str) -> None:
    if "\n" in name or "\r" in name:
        raise LogError(f"{printable(name, 500)}: its name has several lines; rename it")


def _in_order(files: Iterable[Path]) -> tuple[LogFile, ...]:
    return tuple(LogFile(path) for path in sorted(files, key=lambda path: natural_key(path.name)))


def _files_of(path: Path, excluded: Path | None) -> list[Path]:
    if path.is_dir():
        return _files_below(path, excluded)
    if path.is_file():
        return [path]
    raise LogError(f"{path}: no such file or folder; expected a log or a folder of logs")


def _files_below(folder: Path, excluded: Path | None) -> list[Path]:
    work = None if excluded is None else excluded.resolve()
    found: list[Path] = []
    for place, folders, files in os.walk(folder):
        inside = Path(place)
        if work is not None and inside.resolve().is_relative_to(work):
            folders.clear()
            continue
        folders[:] = [name for name in folders if not name.startswith(".")]
        named = (one for one in files if not one.startswith(".") and one.lower() not in _IGNORED)
        found += [path for path in map(inside.joinpath, named) if path.is_file() or _is_lost(path)]
    keys = {
        place: [natural_key(part) for part in place.parts]
        for place in {path.parent for path in found}
    }
    return sorted(found, key=lambda path: [*keys[path.parent], natural_key(path.name)])


def _is_lost(path: Path) -> bool:
    """Return whether a path is a link to nothing: a log that is missing, as told on reading."""
    return path.is_symlink() and not path.exists()


def _unique_names(folders: list[Path]) -> dict[Path, str]:
    """Return a unique name of each folder: as many of its last parts as are needed."""
    parts = {folder: folder.resolve().parts for folder in folders}
    names = {folder: parts[folder][-1] for folder in folders}
    depth = 1
    while True:
        counts = Counter(names.values())
        clashes = [folder for folder, name in names.items() if counts[name] > 1]
        if not clashes or depth > max(len(parts_of_folder) for parts_of_folder in parts.values()):
            return names
        depth += 1
        for folder in clashes:
            names[folder] = "/".join(parts[folder][-depth:])
