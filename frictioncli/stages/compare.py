"""The same joint on different days: ``compare``."""

import json
from collections.abc import Sequence
from dataclasses import asdict
from datetime import datetime
from pathlib import Path

import pandas as pd

from frictioncli import schemas, tables
from frictioncli.comparison.compare import compare_runs
from frictioncli.comparison.document import comparison_document
from frictioncli.comparison.run_history import ComparedFolder, distinct_names, run_history_of
from frictioncli.comparison.settings import ComparisonSettings
from frictioncli.comparison.text import comparison_text
from frictioncli.documents import to_json
from frictioncli.errors import OptionError
from frictioncli.files import atomic_write, write_text
from frictioncli.model.document import FrictionModel, read_models
from frictioncli.provenance import Provenance, sha256
from frictioncli.report.trend_figure import trend_files
from frictioncli.stages.stage import Done, stage
from frictioncli.workfiles import COMPARISON, MODEL, RECORDINGS, TORQUES
from frictioncli.workfolder import outdated

TREND = "trend"


@stage
def compare(runs: Sequence[Path], work: Path, settings: ComparisonSettings | None = None) -> Done:
    """Say what changed between the runs of one joint: ``comparison.json``, ``trend.svg``.

    Parameters
    ----------
    runs : sequence of Path
        Work folders with ``torques.parquet`` and ``model.json``.
    work : Path
        Folder that the results go to.
    settings : ComparisonSettings, optional
        How the runs are compared.

    Raises
    ------
    OptionError
        If the folders do not have one joint in common, or a run is named twice.
    NotEnoughData
        If there are too few runs or pairs, or the runs share too few conditions.
    TableError
        If a file is missing or damaged.
    """
    settings = settings or ComparisonSettings()
    names = distinct_names([path.resolve().as_posix() for path in runs])
    sources = dict(zip(names, runs, strict=True))
    models = {
        name: {one.joint: one for one in read_models(path / MODEL)}
        for name, path in sources.items()
    }
    joint = _joint(settings.joint, models)
    folders = [_folder(path, name, models[name][joint]) for name, path in sources.items()]
    comparison = compare_runs(run_history_of(folders), settings)
    inputs = {
        f"{name}/{file}": sha256(path / file)
        for name, path in sources.items()
        for file in (TORQUES, MODEL)
    }
    provenance = Provenance("compare", asdict(settings), inputs)
    document = comparison_document(comparison) | {"provenance": provenance.as_dict()}
    svg, png = trend_files(document)
    write_text(work / f"{TREND}.svg", svg)
    with atomic_write(work / f"{TREND}.png") as draft:
        draft.write_bytes(png)
    write_text(work / COMPARISON, to_json(document))
    warnings = [
        f"warning: {name}: {text}"
        for name, path in sources.items()
        for text in outdated([path / MODEL])
    ]
    return Done(work / COMPARISON, "\n".join([*warnings, comparison_text(comparison)]))


def above_threshold(work: Path) -> bool:
    """Return whether ``comparison.json`` holds a change above the threshold that it was made with.

    Parameters
    ----------
    work : Path
        Folder of a comparison.
    """
    document = json.loads((work / COMPARISON).read_text(encoding="utf-8"))
    threshold = document["threshold"]
    return threshold is not None and bool(threshold["exceeded"])


def _joint(asked: int | None, models: dict[str, dict[int, FrictionModel]]) -> int:
    """Return the joint that is asked for, or the only one that all work folders have."""
    common = set.intersection(*(set(own) for own in models.values()))
    if asked is None and len(common) == 1:
        return next(iter(common))
    if asked is not None and asked in common:
        return asked
    known = "; ".join(f"{name}: {', '.join(map(str, sorted(own)))}" for name, own in models.items())
    said = "not given" if asked is None else str(asked)
    advice = "choose one" if common else "compare folders of one joint"
    raise OptionError(f"--joint {said}: the work folders have joints {known}; {advice}")


def _folder(path: Path, name: str, model: FrictionModel) -> ComparedFolder:
    torques = tables.read(path / TORQUES, schemas.TORQUES)
    started_at, ambient = {}, {}
    if (path / RECORDINGS).exists():
        recordings = tables.read(path / RECORDINGS, schemas.RECORDINGS)
        for run, own in recordings[recordings["joint"] == model.joint].groupby("run"):
            started_at[str(run)] = _first(own["started_at"])
            ambient[str(run)] = float(own["ambient"].mean())
    return ComparedFolder(
        name=name,
        torques=torques[torques["joint"] == model.joint],
        model=model,
        started_at={run: start for run, start in started_at.items() if start is not None},
        ambient=ambient,
    )


def _first(started: pd.Series) -> datetime | None:
    """Return the earliest of some ISO times, none if one is missing; those of no zone are UTC."""
    if started.isna().any() or started.empty:
        return None
    return min(pd.Timestamp(pd.to_datetime(text, utc=True)).to_pydatetime() for text in started)
