"""One joint of a fleet: the whole chain into its own work folder, whatever happens."""

import hashlib
import json
import time
import traceback
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_limits

from frictioncli import __version__
from frictioncli.errors import FrictionError, LogError
from frictioncli.files import write_text
from frictioncli.fleet.joint_record import FAILURE, Note, emptied, read_note, write_note
from frictioncli.fleet.layout import JointLogs
from frictioncli.fleet.table_row import row_of, unused_runs
from frictioncli.provenance import sha256
from frictioncli.stages import run as pipeline
from frictioncli.stages.settings import RunSettings
from frictioncli.stages.stage import StageResult
from frictioncli.workfolder import locked

DONE, UNCHANGED, FAILED = "done", "unchanged", "failed"


@dataclass(frozen=True, slots=True, kw_only=True)
class JointTask:
    """A joint to work on; it travels to the process that does it.

    Attributes
    ----------
    logs : JointLogs
        The joint.
    work : Path
        Its work folder.
    settings : RunSettings
        Of the stages; those of reading without what ``logs`` says.
    report : bool
        Whether it gets a report.
    redo : bool
        Whether it is done again if it is done already.
    version : str
        Version of the program that asks.
    """

    logs: JointLogs
    work: Path
    settings: RunSettings
    report: bool = True
    redo: bool = False
    version: str = __version__


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """How it went with a joint.

    Attributes
    ----------
    robot, joint : str, int
        Which one.
    status : {"done", "unchanged", "failed"}
        ``unchanged`` was done by an earlier call.
    message : str
        Why it failed, or what was left out.
    verdict : str or None
        The diagnosis.
    seconds : float
        How long it took. [s]
    """

    robot: str
    joint: int
    status: str
    message: str
    verdict: str | None = None
    seconds: float = 0.0


def run_joint(task: JointTask) -> Outcome:
    """Work on a joint; every fault ends in its row and its folder, none outside.

    Linear algebra keeps to one thread: many joints share the processors, and more threads would
    change the last digits.
    """
    begun = time.perf_counter()
    with threadpool_limits(1):
        outcome = _run_joint(task)
    return replace(outcome, seconds=time.perf_counter() - begun)


def _run_joint(task: JointTask) -> Outcome:
    try:
        runs = task.logs.runs()
        settings = _own_settings(task)
        inputs = _input_hashes(runs, settings)
        key = _key(inputs, settings_document(settings, report=task.report))
        with locked(task.work):
            kept = read_note(task.work)
            if not task.redo and kept is not None and kept.key == key:
                return _outcome(task, UNCHANGED, kept.row)
            emptied(task.work, _head(task, FAILED, "not finished"))
            left_out = _worked(task, runs, settings)
            row = _head(task, DONE, left_out) | {"runs": len(runs)} | row_of(task.work)
            row["inputs_sha256"] = _digest(inputs)
            write_note(task.work, Note(key=key, row=row))
        return _outcome(task, DONE, row)
    except (FrictionError, OSError) as fault:
        return failed(task, str(fault), str(fault))
    except Exception as bug:
        text = f"a bug: {type(bug).__name__}: {bug}"
        return failed(task, text, "".join(traceback.format_exception(bug)))


def failed(task: JointTask, message: str, details: str) -> Outcome:
    """Note that a joint has failed; its folder then holds the note and the details only.

    Parameters
    ----------
    task : JointTask
        The joint.
    message : str
        What its row says.
    details : str
        What the file ``failure.txt`` says.
    """
    row = _head(task, FAILED, message)
    emptied(task.work, row)
    write_text(task.work / FAILURE, f"{details.rstrip()}\n")
    return _outcome(task, FAILED, row)


def settings_document(settings: RunSettings, *, report: bool) -> dict[str, Any]:
    """Return settings as plain values: what beside its logs makes a joint's results.

    Parameters
    ----------
    settings : RunSettings
        Of the stages.
    report : bool
        Whether there is a report.
    """
    stages = {
        name: None if part is None else asdict(part)
        for name, part in (
            ("pairing", settings.pairing),
            ("fit", settings.fit),
            ("diagnosis", settings.diagnosis),
            ("schedule", settings.schedule),
            ("grid", settings.grid),
            ("correction", settings.correction),
        )
    }
    return {
        "ingest": settings.ingest.as_dict(),
        "sign": settings.separation.sign,
        **stages,
        "report": report,
    }


def _worked(task: JointTask, runs: Mapping[str, Path], settings: RunSettings) -> str:
    """Run the chain; return what was left out."""
    left_out = []

    def note(stage: str, done: StageResult) -> None:
        if not done.path.exists():
            left_out.append(f"{stage} {done}")

    if task.report:
        pipeline.run(runs, task.work, settings, note)
    else:
        pipeline.analyse(runs, task.work, settings, note)
    unused = unused_runs(task.work, runs)
    if unused:
        left_out.append(f"no pairs from run {', '.join(unused)}")
    return "; ".join(left_out)


def _own_settings(task: JointTask) -> RunSettings:
    logs, shared = task.logs, task.settings.ingest
    own = replace(
        shared,
        joints=(logs.joint,),
        map_file=logs.map_file or shared.map_file,
        gear_ratio=shared.gear_ratio if logs.gear_ratio is None else logs.gear_ratio,
    )
    return replace(task.settings, ingest=own)


def _input_hashes(runs: Mapping[str, Path], settings: RunSettings) -> dict[str, str]:
    """Return the SHA-256 of all files of all runs, and of the mapping file."""
    found: dict[str, str] = {}
    for name, path in runs.items():
        if not path.exists():
            raise LogError(f"{path}: no such file or folder; expected the logs of run {name}")
        files = sorted(p for p in path.rglob("*") if p.is_file()) if path.is_dir() else [path]
        base = path if path.is_dir() else path.parent
        found |= {f"{name}/{file.relative_to(base).as_posix()}": sha256(file) for file in files}
    chart = settings.ingest.map_file
    if chart is not None:
        if not chart.is_file():
            raise LogError(f"{chart}: no such file; expected a mapping file")
        found[chart.name] = sha256(chart)
    return found


def _key(inputs: Mapping[str, str], settings: Mapping[str, Any]) -> str:
    return _digest({"version": __version__, "inputs": inputs, "settings": settings})


def _digest(document: Mapping[str, Any]) -> str:
    return hashlib.sha256(json.dumps(document, sort_keys=True).encode()).hexdigest()


def _head(task: JointTask, status: str, message: str) -> dict[str, Any]:
    return {
        "robot": task.logs.robot,
        "joint": task.logs.joint,
        "status": status,
        "message": message,
    }


def _outcome(task: JointTask, status: str, row: Mapping[str, Any]) -> Outcome:
    return Outcome(
        robot=task.logs.robot,
        joint=task.logs.joint,
        status=status,
        message=row["message"],
        verdict=row.get("verdict"),
    )
