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
from frictioncli.stages.stage import Done
from frictioncli.workfiles import DIAGNOSIS, EVALUATION, EXTENDED, SCHEDULE
from frictioncli.workfolder import locked

Tell = Callable[[str, Done], None]
"""Is told each stage's name and what it made."""


def run(
    logs: Logs,
    work: Path,
    settings: RunSettings | None = None,
    tell: Tell = lambda stage, done: None,
) -> Path:
    """Run the whole chain and return the report's path.

    Parameters
    ----------
    logs : Logs
        Log files or folders, each folder one run; or the runs by name.
    work : Path
        Work folder; its tables are replaced.
    settings : RunSettings, optional
        Settings of every stage.
    tell : callable, optional
        Called with each stage's name and what it made.

    Notes
    -----
    A log without a thermal cycle has no corrections to simulate; those two stages are then left
    out, and said so, and the tables of a former run are removed. So is the diagnosis where the data
    are too few for one. A former one is removed at the start in any case: it is of other data.
    """
    with locked(work):
        analyse(logs, work, settings, tell)
        done = report(work)
    tell("report", done)
    return done.path


def analyse(
    logs: Logs,
    work: Path,
    settings: RunSettings | None = None,
    tell: Tell = lambda stage, done: None,
) -> None:
    """Run the chain but for the report; see :func:`run`."""
    chosen = settings or RunSettings()
    with locked(work):
        _analyse(logs, work, chosen, tell)


def _analyse(logs: Logs, work: Path, chosen: RunSettings, tell: Tell) -> None:
    for name in (DIAGNOSIS, EXTENDED):
        (work / name).unlink(missing_ok=True)
    tell("ingest", ingest(logs, work, chosen.ingest))
    tell("pair", pair(work, chosen.pairing))
    tell("separate", separate(work, chosen.separation))
    tell("fit", fit(work, chosen.fit))
    optional: dict[str, tuple[str, Callable[[], Done]]] = {}
    if chosen.diagnosis is not None:
        optional["diagnose"] = (DIAGNOSIS, lambda: diagnose(work, chosen.diagnosis))
    optional |= {
        "simulate": (
            SCHEDULE,
            lambda: simulate(work, chosen.schedule, chosen.correction),
        ),
        "evaluate": (
            EVALUATION,
            lambda: evaluate(work, chosen.grid, chosen.correction),
        ),
    }
    for stage, (name, make) in optional.items():
        try:
            tell(stage, make())
        except NotEnoughData as fault:
            (work / name).unlink(missing_ok=True)
            tell(stage, Done(work / name, f"left out: {fault}"))
