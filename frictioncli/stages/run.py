"""The whole chain in one call, from logs to the report: ``run``."""

from collections.abc import Callable
from pathlib import Path

from frictioncli.errors import NotEnoughData
from frictioncli.logs.runs.discovery import Logs
from frictioncli.stages.diagnose import diagnose
from frictioncli.stages.evaluate import evaluate
from frictioncli.stages.fit import fit
from frictioncli.stages.ingest import ingest
from frictioncli.stages.pair import pair
from frictioncli.stages.report import report
from frictioncli.stages.separate import separate
from frictioncli.stages.settings import RunSettings
from frictioncli.stages.simulate import simulate
from frictioncli.stages.stage import StageResult
from frictioncli.workfiles import DIAGNOSIS, EVALUATION, EXTENDED, PAIRS, RAMPS, SCHEDULE, STARTS
from frictioncli.workfolder import locked

Progress = Callable[[str, StageResult], None]
"""Called after each stage, with its name and its result."""


def _no_progress(stage: str, result: StageResult) -> None:
    pass


def run(
    logs: Logs,
    work: Path,
    settings: RunSettings | None = None,
    progress: Progress = _no_progress,
) -> Path:
    """Run the whole chain and return the path of the report.

    Parameters
    ----------
    logs : Logs
        Log files or folders, each folder one run; or the runs by name.
    work : Path
        Work folder; its tables are replaced.
    settings : RunSettings, optional
        Settings of all stages.
    progress : callable, optional
        Called after each stage with its name and its result.

    Returns
    -------
    Path
        The report, ``report/index.html``.

    Raises
    ------
    FrictionError
        If a stage up to the identification fails.

    Notes
    -----
    A log without a thermal cycle has no corrections to simulate, and few data allow no diagnosis.
    These stages are then left out: their result says so, and their tables of an earlier run are
    removed. An earlier diagnosis is removed when the logs are read: it belongs to other data.
    """
    with locked(work):
        analyse(logs, work, settings, progress)
        result = report(work)
    progress("report", result)
    return result.path


def analyse(
    logs: Logs,
    work: Path,
    settings: RunSettings | None = None,
    progress: Progress = _no_progress,
) -> None:
    """Run the whole chain without the report; see :func:`run`.

    Parameters
    ----------
    logs, work, settings, progress
        As in :func:`run`.
    """
    settings = settings or RunSettings()
    with locked(work):
        progress("ingest", ingest(logs, work, settings.ingest))
        for name in (DIAGNOSIS, EXTENDED):
            (work / name).unlink(missing_ok=True)
        pair_and_separate(work, settings, progress)
        progress("fit", fit(work, settings.fit))
        for stage, output, call in _optional_stages(work, settings):
            try:
                result = call()
            except NotEnoughData as fault:
                (work / output).unlink(missing_ok=True)
                result = StageResult(work / output, f"left out: {fault}")
            progress(stage, result)


def pair_and_separate(work: Path, settings: RunSettings, progress: Progress = _no_progress) -> None:
    """Pair moves and separate friction; without pairs by regression of all motion.

    Parameters
    ----------
    work : Path
        Work folder with ``samples.parquet``.
    settings : RunSettings
        Settings of all stages.
    progress : callable, optional
        Called after each stage with its name and its result.

    Raises
    ------
    NotEnoughData
        If the motion suffices neither for pairs nor for a regression.
    """
    separation, width = settings.separation, settings.pairing.bin_width
    try:
        progress("pair", pair(work, settings.pairing))
    except NotEnoughData as fault:
        if separation.by == "pairs":
            raise
        for name in (PAIRS, RAMPS, STARTS):
            (work / name).unlink(missing_ok=True)
        try:
            result = separate(work, separation, bin_width=width)
        except NotEnoughData as other:
            raise NotEnoughData(f"{fault}; by regression neither: {other}") from None
        # said once: a refusal holds it already
        progress("pair", StageResult(work / PAIRS, f"left out: {fault}"))
    else:
        result = separate(work, separation, bin_width=width)
    progress("separate", result)


def _optional_stages(
    work: Path, settings: RunSettings
) -> list[tuple[str, str, Callable[[], StageResult]]]:
    """Return name, output and call of the stages that need more data than the identification."""
    schedule, grid, correction = settings.schedule, settings.grid, settings.correction
    stages: list[tuple[str, str, Callable[[], StageResult]]] = [
        ("simulate", SCHEDULE, lambda: simulate(work, schedule, correction)),
        ("evaluate", EVALUATION, lambda: evaluate(work, grid, correction)),
    ]
    if settings.diagnosis is not None:
        stages.insert(0, ("diagnose", DIAGNOSIS, lambda: diagnose(work, settings.diagnosis)))
    return stages
