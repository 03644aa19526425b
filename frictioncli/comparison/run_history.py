"""Runs of one joint from several work folders in the order of time."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime

import numpy as np
import pandas as pd

from frictioncli.arrays import Array
from frictioncli.errors import NotEnoughData, OptionError
from frictioncli.logs.runs.run_order import runs_in_order
from frictioncli.model.document import FrictionModel
from frictioncli.model.zero_load import temperature_of

_DAY = 86400.0
"""Seconds per day. [s]"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ComparedFolder:
    """Torques and model of one joint in a work folder.

    Attributes
    ----------
    name : str
        Name of the folder in texts and figures.
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of the joint.
    model : FrictionModel
        Its model.
    started_at : mapping of str to datetime
        Start of each run, where the logs state it.
    ambient : mapping of str to float
        Ambient temperature of each run, where the manifest states it. [°C]
    """

    name: str
    torques: pd.DataFrame
    model: FrictionModel
    started_at: Mapping[str, datetime]
    ambient: Mapping[str, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class ComparedRun:
    """One run.

    Attributes
    ----------
    folder, run : str
        Names of its work folder and of the run.
    label : str
        Name of the run in texts and figures.
    started_at : datetime or None
        Start, where the logs of all runs state it.
    ambient : float
        Ambient temperature; NaN where unknown. [°C]
    """

    folder: str
    run: str
    label: str
    started_at: datetime | None
    ambient: float


@dataclass(frozen=True, slots=True, kw_only=True)
class RunHistory:
    """All runs of a joint in the order of time.

    Attributes
    ----------
    torques : DataFrame
        Rows of all runs; each run is named by its number.
    runs : tuple of ComparedRun
        The runs.
    models : tuple of FrictionModel
        Models of the folders, in the order of their first runs.
    folders : tuple of str
        Names of the folders, in the same order.
    dated : bool
        Whether the times between runs are known, or only their order.
    ambient_source : str
        Source of the ambient temperatures.
    """

    torques: pd.DataFrame
    runs: tuple[ComparedRun, ...]
    models: tuple[FrictionModel, ...]
    folders: tuple[str, ...]
    dated: bool
    ambient_source: str

    @property
    def time(self) -> Array:
        """Time of each run since the first one [days], or its number where dates are unknown."""
        starts = [run.started_at for run in self.runs]
        if not self.dated:
            return np.arange(len(starts), dtype=float)
        first = starts[0]
        return np.array([(one - first).total_seconds() / _DAY for one in starts])  # type: ignore[operator]

    @property
    def ambient(self) -> Array:
        """Ambient temperature of each run; NaN where unknown [°C]."""
        return np.array([run.ambient for run in self.runs])


def run_history_of(folders: Sequence[ComparedFolder]) -> RunHistory:
    """Return the runs of all folders in the order of time.

    They are ordered by date where the logs of all runs state it; else by the given order of the
    folders, and by name within a folder.

    Parameters
    ----------
    folders : sequence of ComparedFolder
        Folders of the same joint.

    Returns
    -------
    RunHistory
        The runs.

    Raises
    ------
    OptionError
        If the folders are not of the same joint, or a run occurs twice.
    NotEnoughData
        If there is only one run.
    """
    _check_same(folders)
    found = [(folder, run) for folder in folders for run in runs_in_order(folder.torques)]
    if len(found) < 2:
        raise NotEnoughData(
            f"{folders[0].name}: one run only, expected two or more to compare; name the work"
            " folders of further days"
        )
    _check_once(found)
    starts = [folder.started_at.get(run) for folder, run in found]
    dates = [one for one in starts if one is not None]
    dated = len(dates) == len(found) and len(set(dates)) == len(dates)
    if dated:
        order = sorted(range(len(found)), key=lambda number: dates[number])
        found = [found[number] for number in order]
        starts = [starts[number] for number in order]
    tables = [folder.torques[folder.torques["run"] == run] for folder, run in found]
    source, ambient = _ambient(found, tables)
    runs = tuple(
        ComparedRun(
            folder=folder.name,
            run=run,
            label=run if len(folders) == 1 else _label(folder, run),
            started_at=start if dated else None,
            ambient=float(temperature),
        )
        for (folder, run), start, temperature in zip(found, starts, ambient, strict=True)
    )
    names = list(dict.fromkeys(folder.name for folder, _ in found))
    models = {folder.name: folder.model for folder in folders}
    digits = len(str(len(tables) - 1))
    return RunHistory(
        torques=pd.concat(
            [table.assign(run=f"{number:0{digits}d}") for number, table in enumerate(tables)],
            ignore_index=True,
        ),
        runs=runs,
        models=tuple(models[name] for name in names),
        folders=tuple(names),
        dated=dated,
        ambient_source=source,
    )


def _label(folder: ComparedFolder, run: str) -> str:
    return folder.name if len(folder.torques["run"].unique()) == 1 else f"{folder.name}/{run}"


def _check_same(folders: Sequence[ComparedFolder]) -> None:
    """Raise OptionError if the folders differ in joint, unit, side or temperature."""
    first = folders[0]
    for other in folders[1:]:
        for what, attribute, advice in (
            ("joint", "joint", "compare runs of one joint"),
            ("torques in", "torque_unit", "compare torque with torque, or current with current"),
            ("torques on the side of the", "torque_side", "ingest both with the same --gear-ratio"),
            ("a model of temperature", "temperature", "fit both with the same --temperature"),
        ):
            one, two = getattr(first.model, attribute), getattr(other.model, attribute)
            if one != two:
                raise OptionError(
                    f"{other.name}: {what} {two}, expected {one} as in {first.name}; {advice}"
                )


def _check_once(found: Sequence[tuple[ComparedFolder, str]]) -> None:
    """Raise OptionError if two runs have the same measurements."""
    seen: dict[int, str] = {}
    for folder, run in found:
        rows = folder.torques.loc[folder.torques["run"] == run, ["time", "position"]].assign(
            friction=folder.torques["friction_torque"]
        )
        digest = hash(rows.to_numpy(float).tobytes())
        here = f"{folder.name}, run {run}"
        if digest in seen:
            raise OptionError(
                f"{here}: the same measurements as {seen[digest]}; name each run once"
            )
        seen[digest] = here


def _ambient(
    found: Sequence[tuple[ComparedFolder, str]], tables: Sequence[pd.DataFrame]
) -> tuple[str, list[float]]:
    """Return the source of the ambient temperatures and that of each run [°C]."""
    stated = [folder.ambient.get(run, np.nan) for folder, run in found]
    if np.isfinite(stated).all():
        return "manifest", stated
    for kind in ("housing", "motor"):
        coldest = [float(temperature_of(table, kind).min()) for table in tables]
        if np.isfinite(coldest).all():
            return f"lowest {kind} temperature", coldest
    return "nothing", [float("nan")] * len(tables)


def distinct_names(paths: Sequence[str]) -> list[str]:
    """Return the shortest ends of paths that are distinct.

    Parameters
    ----------
    paths : sequence of str
        Paths with forward slashes.

    Returns
    -------
    list of str
        One end per path, all of the same depth.

    Raises
    ------
    OptionError
        If a path occurs twice.

    Examples
    --------
    >>> distinct_names(["/robot1/may", "/robot2/may"])
    ['robot1/may', 'robot2/may']
    """
    parts = [path.split("/") for path in paths]
    for depth in range(1, max(len(one) for one in parts) + 1):
        names = ["/".join(one[-depth:]) for one in parts]
        if max(Counter(names).values()) == 1:
            return names
    twice = Counter(paths).most_common(1)[0][0]
    raise OptionError(f"{twice}: named twice; name each work folder once")
