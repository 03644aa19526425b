"""Comparison of the same joint on different days: ``compare``."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from datetime import datetime
from pathlib import Path
from urllib.parse import quote

import pandas as pd

from frictioncli import documents, schemas, tables
from frictioncli.comparison.common_poses import with_common_poses
from frictioncli.comparison.compare import compare_runs
from frictioncli.comparison.document import ComparisonDocument
from frictioncli.comparison.from_comparison import comparison_document
from frictioncli.comparison.run_history import ComparedFolder, distinct_names, run_history_of
from frictioncli.comparison.settings import ComparisonSettings
from frictioncli.comparison.text import comparison_text
from frictioncli.errors import OptionError
from frictioncli.files import atomic_write, write_text
from frictioncli.model.document import FrictionModel, read_models
from frictioncli.model.late_torque import without_delay
from frictioncli.provenance import Provenance, sha256
from frictioncli.report.compare_page import compare_html
from frictioncli.report.figure_files import svg_file
from frictioncli.report.trend_figure import trend_files
from frictioncli.stages.stage import StageResult, stage
from frictioncli.workfiles import COMPARISON, MODEL, RECORDINGS, TORQUES
from frictioncli.workfolder import outdated

TREND = "trend"
PAGE = "compare.html"


@stage
def compare(
    runs: Sequence[Path], work: Path, settings: ComparisonSettings | None = None
) -> StageResult:
    """Find what changed between the runs of one joint: ``comparison.json``, ``compare.html``.

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
    poses = [
        tables.facts(path / TORQUES).get("poses", {}).get(str(joint), [])
        for path in sources.values()
    ]
    common = with_common_poses([folder.torques for folder in folders], poses)
    folders = [replace(folder, torques=rows) for folder, rows in zip(folders, common, strict=True)]
    comparison = compare_runs(run_history_of(folders), settings)
    inputs = {
        f"{name}/{file}": sha256(path / file)
        for name, path in sources.items()
        for file in (TORQUES, MODEL)
    }
    provenance = Provenance("compare", asdict(settings), inputs)
    document = comparison_document(comparison)
    svg, png = trend_files(document)
    write_text(work / f"{TREND}.svg", svg_file(svg))
    with atomic_write(work / f"{TREND}.png") as draft:
        draft.write_bytes(png)
    documents.write(work / COMPARISON, document, provenance)
    write_text(work / PAGE, compare_html(document, svg, _pages(sources, work)))
    warnings = [
        f"warning: {name}: {text}"
        for name, path in sources.items()
        for text in outdated([path / MODEL])
    ]
    return StageResult(work / COMPARISON, "\n".join([*warnings, comparison_text(comparison)]))


def _pages(sources: Mapping[str, Path], work: Path) -> dict[str, str]:
    """Return the address of the report of each work folder that has one."""
    pages = {name: path / "report" / "index.html" for name, path in sources.items()}
    here = work.resolve()
    return {
        name: quote(os.fsencode(os.path.relpath(page.resolve(), here).replace(os.sep, "/")))
        for name, page in pages.items()
        if page.exists()
    }


def above_threshold(work: Path) -> bool:
    """Return whether friction has changed by more than the threshold of a comparison.

    Parameters
    ----------
    work : Path
        Folder with ``comparison.json``.
    """
    threshold = documents.read(work / COMPARISON, ComparisonDocument, "compare").threshold
    return threshold is not None and bool(threshold.exceeded)


def _joint(chosen: int | None, models: dict[str, dict[int, FrictionModel]]) -> int:
    """Return the chosen joint, or the only one that all work folders have."""
    common = set.intersection(*(set(joints) for joints in models.values()))
    if chosen is None and len(common) == 1:
        return next(iter(common))
    if chosen is not None and chosen in common:
        return chosen
    known = "; ".join(
        f"{name}: {', '.join(map(str, sorted(joints)))}" for name, joints in models.items()
    )
    value = "not given" if chosen is None else str(chosen)
    advice = "choose one" if common else "compare folders of one joint"
    raise OptionError(f"--joint {value}: the work folders have joints {known}; {advice}")


def _folder(path: Path, name: str, model: FrictionModel) -> ComparedFolder:
    """Return what a work folder holds of a joint."""
    torques = tables.read(path / TORQUES, schemas.TORQUES)
    started_at, ambient = {}, {}
    if (path / RECORDINGS).exists():
        recordings = tables.read(path / RECORDINGS, schemas.RECORDINGS)
        for run, rows in recordings[recordings["joint"] == model.joint].groupby("run"):
            started_at[str(run)] = _first(rows["started_at"])
            ambient[str(run)] = float(rows["ambient"].mean())
    return ComparedFolder(
        name=name,
        torques=without_delay(torques[torques["joint"] == model.joint], model.late_by),
        model=model,
        started_at={run: start for run, start in started_at.items() if start is not None},
        ambient=ambient,
    )


def _first(started: pd.Series) -> datetime | None:
    """Return the earliest of ISO times, None if one is missing; UTC where there is no zone."""
    if started.isna().any() or started.empty:
        return None
    return min(pd.Timestamp(pd.to_datetime(text, utc=True)).to_pydatetime() for text in started)
