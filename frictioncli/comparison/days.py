"""The runs of one joint from several work folders, in the order of time."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime

import numpy as np
import pandas as pd

from frictioncli.arrays import Array
from frictioncli.errors import NotEnoughData, OptionError
from frictioncli.logs.runs.discovery import natural_key
from frictioncli.model.document import FrictionModel
from frictioncli.model.zero_load import temperature_of

_DAY = 86400.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Folder:
    """What a work folder says of one joint.

    Attributes
    ----------
    name : str
        What to call it.
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of the joint.
    model : FrictionModel
        Its model.
    begun : mapping of str to datetime
        Start of each run, where the logs tell.
    ambient : mapping of str to float
        Temperature of the surroundings of each run, where the manifest tells. [°C]
    """

    name: str
    torques: pd.DataFrame
    model: FrictionModel
    begun: Mapping[str, datetime]
    ambient: Mapping[str, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Day:
    """One run.

    Attributes
    ----------
    folder, run : str, str
        Where it is from.
    label : str
        What it is called in texts and figures.
    begun : datetime or None
        When it began, where all logs tell.
    surroundings : float
        Temperature around the joint; NaN where nothing tells. [°C]
    """

    folder: str
    run: str
    label: str
    begun: datetime | None
    surroundings: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Days:
    """All runs of a joint.

    Attributes
    ----------
    torques : DataFrame
        Rows of all runs, each run named by its number.
    days : tuple of Day
        The runs in the order of time.
    models : tuple of FrictionModel
        Of the folders, in the order in which they begin.
    folders : tuple of str
        Their names.
    dated : bool
        Whether the times between runs are known; else only their order is.
    surroundings_from : str
        What tells the surroundings' temperature.
    """

    torques: pd.DataFrame
    days: tuple[Day, ...]
    models: tuple[FrictionModel, ...]
    folders: tuple[str, ...]
    dated: bool
    surroundings_from: str

    @property
    def time(self) -> Array:
        """Time of each run since the first one. [days], or its number where dates are unknown."""
        begun = [day.begun for day in self.days]
        if not self.dated:
            return np.arange(len(begun), dtype=float)
        first = begun[0]
        return np.array([(one - first).total_seconds() / _DAY for one in begun])  # type: ignore[operator]

    @property
    def surroundings(self) -> Array:
        """Temperature around the joint in each run; NaN where nothing tells. [°C]."""
        return np.array([day.surroundings for day in self.days])


def in_order(folders: Sequence[Folder]) -> Days:
    """Return the runs of all folders in the order of time.

    They are ordered by date where all logs tell when they began; else as the folders are given, and
    within a folder by name.

    Raises
    ------
    OptionError
        If the folders are not of the same joint, or a run is there twice.
    NotEnoughData
        If there is one run only.
    """
    _check_same(folders)
    found = [
        (folder, str(run))
        for folder in folders
        for run in sorted(folder.torques["run"].unique(), key=natural_key)
    ]
    if len(found) < 2:
        raise NotEnoughData(
            f"{folders[0].name}: one run only, expected two or more to compare; name the work"
            " folders of further days"
        )
    _check_once(found)
    begun = [folder.begun.get(run) for folder, run in found]
    dates = [one for one in begun if one is not None]
    dated = len(dates) == len(found) and len(set(dates)) == len(dates)
    if dated:
        order = sorted(range(len(found)), key=lambda number: dates[number])
        found, begun = [found[number] for number in order], [begun[number] for number in order]
    tables = [folder.torques[folder.torques["run"] == run] for folder, run in found]
    source, surroundings = _surroundings(found, tables)
    days = tuple(
        Day(
            folder=folder.name,
            run=run,
            label=run if len(folders) == 1 else _label(folder, run),
            begun=start if dated else None,
            surroundings=float(warmth),
        )
        for (folder, run), start, warmth in zip(found, begun, surroundings, strict=True)
    )
    first = list(dict.fromkeys(folder.name for folder, _ in found))
    models = {folder.name: folder.model for folder in folders}
    digits = len(str(len(tables) - 1))
    return Days(
        torques=pd.concat(
            [table.assign(run=f"{number:0{digits}d}") for number, table in enumerate(tables)],
            ignore_index=True,
        ),
        days=days,
        models=tuple(models[name] for name in first),
        folders=tuple(first),
        dated=dated,
        surroundings_from=source,
    )


def _label(folder: Folder, run: str) -> str:
    return folder.name if len(folder.torques["run"].unique()) == 1 else f"{folder.name}/{run}"


def _check_same(folders: Sequence[Folder]) -> None:
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


def _check_once(found: Sequence[tuple[Folder, str]]) -> None:
    """Raise OptionError if two runs hold the same measurements."""
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


def _surroundings(
    found: Sequence[tuple[Folder, str]], tables: Sequence[pd.DataFrame]
) -> tuple[str, list[float]]:
    """Return what tells the surroundings' temperature, and that of each run. [°C]."""
    told = [folder.ambient.get(run, np.nan) for folder, run in found]
    if np.isfinite(told).all():
        return "manifest", told
    for kind in ("housing", "motor"):
        coldest = [float(temperature_of(table, kind).min()) for table in tables]
        if np.isfinite(coldest).all():
            return f"lowest {kind} temperature", coldest
    return "nothing", [float("nan")] * len(tables)


def distinct_names(paths: Sequence[str]) -> list[str]:
    """Return the shortest ends of paths that tell them apart.

    Parameters
    ----------
    paths : sequence of str
        Paths with forward slashes.

    Raises
    ------
    OptionError
        If a path is there twice.
    """
    parts = [path.split("/") for path in paths]
    for depth in range(1, max(len(one) for one in parts) + 1):
        names = ["/".join(one[-depth:]) for one in parts]
        if max(Counter(names).values()) == 1:
            return names
    twice = Counter(paths).most_common(1)[0][0]
    raise OptionError(f"{twice}: named twice; name each work folder once")
