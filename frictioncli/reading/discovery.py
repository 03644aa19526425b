"""Which files belong to which run, from the files and folders named by the user."""

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from frictioncli.errors import LogError
from frictioncli.reading import manifest

_SILENT = frozenset({manifest.NAME, "truth.json", "thumbs.db", "desktop.ini"})


@dataclass(frozen=True, slots=True)
class LogFile:
    """A file that may be a log, as it was named or found."""

    path: Path

    @property
    def stem(self) -> str:
        """The name without its ending, ``.csv.gz`` counting as one."""
        name = self.path.name
        if name.lower().endswith(".gz"):
            name = name[:-3]
        return Path(name).stem


@dataclass(frozen=True, slots=True)
class Run:
    """A folder of logs: one day, one thermal history.

    Attributes
    ----------
    name : str
        Unique among the runs.
    folder : Path
        Where its manifest would be.
    files : tuple of LogFile
        In natural name order (s2 before s10).
    """

    name: str
    folder: Path
    files: tuple[LogFile, ...]


def natural_key(name: str) -> list[tuple[int, int, str]]:
    """Return a sort key that puts s2 before s10."""
    parts = re.split(r"(\d+)", name.lower())
    return [(0, int(part), "") if part.isdecimal() else (1, 0, part) for part in parts if part]


def discover(logs: Sequence[Path], besides: Path | None = None) -> tuple[Run, ...]:
    """Return the runs in the named files and folders, in the order of first mention.

    Parameters
    ----------
    logs : sequence of Path
        Files and folders.
    besides : Path, optional
        A folder whose files are no logs: the work folder may lie among them.

    Raises
    ------
    LogError
        If a path does not exist or no file is found.
    """
    folders: dict[Path, dict[Path, None]] = {}
    for path in logs:
        if path.is_dir():
            for file in _files_below(path, besides):
                folders.setdefault(file.parent, {})[file] = None
        elif path.is_file():
            folders.setdefault(path.parent, {})[path] = None
        else:
            raise LogError(f"{path}: no such file or folder; expected a log or a folder of logs")
    if not folders:
        named = ", ".join(str(path) for path in logs) or "nothing named"
        raise LogError(f"{named}: no log files found; expected text logs of a joint's motion")
    names = _unique_names(list(folders))
    return tuple(
        Run(
            names[folder],
            folder,
            tuple(LogFile(p) for p in sorted(files, key=lambda p: natural_key(p.name))),
        )
        for folder, files in folders.items()
    )


def _files_below(folder: Path, besides: Path | None) -> list[Path]:
    work = None if besides is None else besides.resolve()
    found = [
        path
        for path in folder.rglob("*")
        if path.is_file()
        and path.name.lower() not in _SILENT
        and (work is None or work not in path.resolve().parents)
        and not any(part.startswith(".") for part in path.relative_to(folder).parts)
    ]
    return sorted(found, key=lambda path: [natural_key(part) for part in path.parts])


def _unique_names(folders: list[Path]) -> dict[Path, str]:
    """Name each folder by as many of its last parts as tell it from the others."""
    parts = {folder: folder.resolve().parts for folder in folders}
    names = {folder: parts[folder][-1] for folder in folders}
    depth = 1
    while True:
        counts = Counter(names.values())
        clashes = [folder for folder, name in names.items() if counts[name] > 1]
        if not clashes or depth > max(len(own) for own in parts.values()):
            return names
        depth += 1
        for folder in clashes:
            names[folder] = "/".join(parts[folder][-depth:])
