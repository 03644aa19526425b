"""Logs of the joints of a fleet: folders ``robot=R/joint=J/run=D``, or a table of contents."""

import csv
import io
import math
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

from frictioncli.errors import LogError, MappingError
from frictioncli.logs.channels.channel_names import MAX_JOINT
from frictioncli.logs.runs.discovery import natural_key
from frictioncli.plain_text import printable, whole_number

REQUIRED_COLUMNS = ("robot", "joint", "run", "path")
"""Columns that a table of contents must have."""

OPTIONAL_COLUMNS = ("map", "gear_ratio")
"""Columns that a table of contents may have."""

_PARQUET = b"PAR1"


@dataclass(frozen=True, slots=True, kw_only=True)
class JointLogs:
    """A joint of a fleet and the paths of its logs.

    Attributes
    ----------
    robot : str
        Name of the robot.
    joint : int
        Number of the joint, from 1.
    folder : Path or None
        Folder of the joint with one folder per run.
    run_paths : tuple of (str, Path)
        Name and path of each run, if there is no folder.
    map_file : Path or None
        Mapping file of the logs.
    gear_ratio : float or None
        Motor turns per joint turn. [-]
    """

    robot: str
    joint: int
    folder: Path | None = None
    run_paths: tuple[tuple[str, Path], ...] = ()
    map_file: Path | None = None
    gear_ratio: float | None = None

    @property
    def subfolder(self) -> Path:
        """Path of the joint below the folder of a fleet."""
        return Path(f"robot={self.robot}", f"joint={self.joint}")

    def runs(self) -> dict[str, Path]:
        """Return the folder or file of each run, by name in natural order.

        Folders are searched only here, by the worker that processes the joint.

        Raises
        ------
        LogError
            If there is no run.
        """
        paths = dict(self.run_paths) if self.folder is None else _subfolders(self.folder, "run")
        if not paths:
            raise LogError(f"{self.folder}: no folders of runs; expected run=D, with logs inside")
        return dict(sorted(paths.items(), key=lambda item: natural_key(item[0])))


def find_joints(fleet: Path) -> list[JointLogs]:
    """Return the joints of a fleet, in natural order of robot and joint.

    Parameters
    ----------
    fleet : Path
        A folder of ``robot=R/joint=J/run=D`` folders, or a table of contents, CSV or Parquet, with
        the columns of :data:`REQUIRED_COLUMNS`.

    Raises
    ------
    LogError
        If the path does not exist or has no joints.
    MappingError
        If the name of a folder or a row of the table is wrong.
    """
    if fleet.is_dir():
        joints = _joints_of_folders(fleet)
    elif fleet.is_file():
        joints = _joints_of_table(fleet)
    else:
        raise LogError(
            f"{fleet}: no such file or folder; expected a folder with robot=R/joint=J/run=D, or a"
            f" table of runs with the columns {', '.join(REQUIRED_COLUMNS)}"
        )
    if not joints:
        raise LogError(f"{fleet}: no joints found; expected robot=R/joint=J/run=D, or rows")
    ordered = sorted(joints, key=lambda joint: (natural_key(joint.robot), joint.robot, joint.joint))
    for one, other in pairwise(ordered):
        if one.subfolder == other.subfolder:
            raise MappingError(
                f"{fleet}: robot {one.robot}, joint {one.joint} is there twice: {one.folder},"
                f" {other.folder}; expected one folder per joint"
            )
    return ordered


def _subfolders(folder: Path, key: str) -> dict[str, Path]:
    """Return the paths of the subfolders ``key=value`` by their value."""
    if not folder.is_dir():
        raise LogError(f"{folder}: no such folder")
    start = f"{key}="
    return {
        path.name.removeprefix(start): path
        for path in folder.iterdir()
        if path.name.startswith(start) and path.is_dir()
    }


def _joints_of_folders(fleet: Path) -> list[JointLogs]:
    """Return the joints of folders ``robot=R/joint=J``."""
    return [
        JointLogs(
            robot=_robot_name(robot, f"{path}"),
            joint=_joint_number(joint, f"{folder}"),
            folder=folder,
        )
        for robot, path in _subfolders(fleet, "robot").items()
        for joint, folder in _subfolders(path, "joint").items()
    ]


def _joints_of_table(path: Path) -> list[JointLogs]:
    """Return the joints of a table of contents."""
    rows = _rows(path)
    entries: dict[tuple[str, int], _TableEntry] = {}
    for where, row in rows:
        key = (_robot_name(row["robot"], where), _joint_number(row["joint"], where))
        entry = entries.setdefault(
            key, _TableEntry({}, row.get("map", ""), row.get("gear_ratio", ""))
        )
        if (row.get("map", ""), row.get("gear_ratio", "")) != (entry.map, entry.gear_ratio):
            raise MappingError(
                f"{where}: map or gear_ratio differs from an earlier row of robot {key[0]}, joint"
                f" {key[1]}; expected the same in all rows of a joint"
            )
        run_path = _absolute_path(path.parent, row["path"], where)
        for what, known in ((row["run"], entry.runs), (run_path, entry.runs.values())):
            if what in known:
                raise MappingError(
                    f"{where}: robot {key[0]}, joint {key[1]} has {what} in an earlier row already;"
                    " expected each run and each path of a joint once"
                )
        entry.runs[row["run"]] = run_path
    return [
        JointLogs(
            robot=robot,
            joint=joint,
            run_paths=tuple(entry.runs.items()),
            map_file=_absolute_path(path.parent, entry.map, f"{path}") if entry.map else None,
            gear_ratio=_gear_ratio(entry.gear_ratio, f"{path}: robot {robot}, joint {joint}"),
        )
        for (robot, joint), entry in entries.items()
    ]


@dataclass(slots=True)
class _TableEntry:
    """Rows of one joint in a table of contents, as text."""

    runs: dict[str, Path]
    map: str
    gear_ratio: str


def _rows(path: Path) -> Iterable[tuple[str, dict[str, str]]]:
    """Yield the place of each row in the file and its cells as text."""
    with path.open("rb") as stream:
        parquet = stream.read(len(_PARQUET)) == _PARQUET
    names, rows = _parquet_rows(path) if parquet else _csv_rows(path)
    missing = [name for name in REQUIRED_COLUMNS if name not in names]
    if missing:
        raise MappingError(
            f"{path}: columns {', '.join(missing)} are missing; found {', '.join(names)}; expected"
            f" {', '.join(REQUIRED_COLUMNS)} and, if wanted, {', '.join(OPTIONAL_COLUMNS)}"
        )
    for number, row in rows:
        where = f"{path} row {number}"
        known = (name for name in (*REQUIRED_COLUMNS, *OPTIONAL_COLUMNS) if name in row)
        texts = {name: _cell_text(row[name]) for name in known}
        empty = [name for name in REQUIRED_COLUMNS if not texts.get(name)]
        if empty:
            raise MappingError(f"{where}: {', '.join(empty)} is empty; expected a value")
        yield where, texts


def _parquet_rows(path: Path) -> tuple[list[str], Iterable[tuple[int, Mapping[str, Any]]]]:
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        names = pq.read_schema(path).names
        known = [name for name in (*REQUIRED_COLUMNS, *OPTIONAL_COLUMNS) if name in names]
        rows = pq.read_table(path, columns=known, partitioning=None).to_pylist()
    # ValueError also: text that is not UTF-8, dates that Python has not
    except (OSError, ValueError, OverflowError, pa.ArrowException) as error:
        why = (str(error).splitlines() or [type(error).__name__])[0]
        raise MappingError(f"{path}: cannot be read as Parquet ({why})") from error
    return names, enumerate(rows, start=1)


def _csv_rows(path: Path) -> tuple[list[str], Iterable[tuple[int, Mapping[str, Any]]]]:
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise MappingError(f"{path}: cannot be read as UTF-8 text ({error})") from error
    delimiter = ";" if ";" in text.partition("\n")[0] else ","
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter)
    try:
        lines = [(reader.line_num, cells) for cells in reader if cells]
    except csv.Error as error:
        raise MappingError(f"{path} row {reader.line_num}: {error}") from error
    names = [name.strip() for name in lines[0][1]] if lines else []
    for number, cells in lines[1:]:
        if len(cells) != len(names):
            raise MappingError(
                f"{path} row {number}: {len(cells)} cells, expected {len(names)} as in the header"
            )
    return names, [(number, dict(zip(names, cells, strict=True))) for number, cells in lines[1:]]


def _cell_text(value: Any) -> str:
    if value is None or value != value:  # an empty cell of a Parquet file may be NaN
        return ""
    if isinstance(value, float) and value.is_integer():
        return str(int(value))
    return str(value).strip()


def _robot_name(name: str, where: str) -> str:
    if not name or len(name.encode()) > 200 or any(c in "/\\" or not c.isprintable() for c in name):
        raise MappingError(
            f"{where}: robot {printable(name)!r} cannot be part of a folder's name; expected"
            " printable characters without / and \\, 200 at most"
        )
    return name


def _joint_number(text: str, where: str) -> int:
    number = whole_number(text)
    if number is None or not 1 <= number <= MAX_JOINT:
        raise MappingError(
            f"{where}: joint {printable(text)!r}; expected a joint number from 1 to {MAX_JOINT}"
        )
    return number


def _gear_ratio(text: str, where: str) -> float | None:
    if not text:
        return None
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if math.isfinite(value) and value:
        return value
    raise MappingError(
        f"{where}: gear_ratio {printable(text)!r}; expected motor turns per joint turn, not 0"
    )


def _absolute_path(base: Path, text: str, where: str) -> Path:
    """Return the absolute path for a path in a table; a relative one must stay in its folder."""
    if "\0" in text:
        raise MappingError(f"{where}: path {text!r} holds a NUL character")
    if not os.path.isabs(text) and os.path.normpath(text).split(os.sep)[0] == os.pardir:
        raise MappingError(
            f"{where}: path {text} leads outside the folder of the table; expected one inside"
            " it, or"
            " an absolute path"
        )
    return Path(os.path.normpath(base / text))
