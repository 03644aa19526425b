"""Processing of one joint of a fleet: the whole chain in a work folder of its own."""

import hashlib
import json
import time
import traceback
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from frictioncli import __version__
from frictioncli.errors import FrictionError, LogError
from frictioncli.files import write_text
from frictioncli.fleet.joint_logs import JointLogs
from frictioncli.fleet.joint_record import (
    FAILURE,
    JointRecord,
    output_digests,
    read_record,
    reset_folder,
    write_record,
)
from frictioncli.fleet.table_row import table_row, unused_runs
from frictioncli.provenance import sha256
from frictioncli.stages.run import analyse, run
from frictioncli.stages.settings import RunSettings
from frictioncli.stages.stage import StageResult
from frictioncli.workfolder import locked

DONE, UNCHANGED, FAILED = "done", "unchanged", "failed"


@dataclass(frozen=True, slots=True, kw_only=True)
class JointTask:
    """A joint to process; it is sent to the worker.

    Attributes
    ----------
    logs : JointLogs
        The joint and its logs.
    work : Path
        Work folder of the joint.
    settings : RunSettings
        Settings of the stages for all joints; ``logs`` adds those of the joint.
    report : bool
        Whether the report is written.
    redo : bool
        Whether an unchanged joint is processed again.
    version : str
        Version of the program that has sent the task.
    """

    logs: JointLogs
    work: Path
    settings: RunSettings
    report: bool = True
    redo: bool = False
    version: str = __version__


@dataclass(frozen=True, slots=True, kw_only=True)
class JointOutcome:
    """Outcome of a joint.

    Attributes
    ----------
    robot, joint : str, int
        The joint.
    status : {"done", "unchanged", "failed"}
        ``unchanged``: done by an earlier call.
    message : str
        Reason of the failure, or what was left out.
    verdict : str or None
        Verdict of the diagnosis.
    seconds : float
        Processing time. [s]
    """

    robot: str
    joint: int
    status: str
    message: str
    verdict: str | None = None
    seconds: float = 0.0


def run_joint(task: JointTask) -> JointOutcome:
    """Process a joint; a fault goes to its row and its folder and is not raised.

    Parameters
    ----------
    task : JointTask
        The joint.
    """
    start = time.perf_counter()
    outcome = _run_joint(task)
    return replace(outcome, seconds=time.perf_counter() - start)


def _run_joint(task: JointTask) -> JointOutcome:
    try:
        runs = task.logs.runs()
        settings = _joint_settings(task)
        files = _log_files(runs, settings)
        states = _states(files)
        inputs = _hashes(files)
        key = _key(inputs, settings_document(settings, report=task.report))
        with locked(task.work):
            record = read_record(task.work)
            if not task.redo and record is not None and _is_whole(task.work, record, key):
                return _outcome(task, UNCHANGED, record.row)
            reset_folder(task.work, _status_columns(task, FAILED, "not finished"))
            left_out = _run_stages(task, runs, settings)
            _check_unchanged(files, states)
            row = _status_columns(task, DONE, left_out) | {"runs": len(runs)} | table_row(task.work)
            row["inputs_sha256"] = _digest(inputs)
            outputs = output_digests(task.work)
            write_record(task.work, JointRecord(key=key, row=row, outputs=outputs))
        return _outcome(task, DONE, row)
    except (FrictionError, OSError) as fault:
        return record_failure(task, str(fault), str(fault))
    except Exception as bug:
        text = f"a bug: {type(bug).__name__}: {bug}"
        return record_failure(task, text, "".join(traceback.format_exception(bug)))


def _is_whole(work: Path, record: JointRecord, key: str) -> bool:
    """Return whether outputs are of these inputs and as they were made.

    What is damaged, or was made by a version that kept no digests, is made again.
    """
    has_outputs = record.key == key and bool(record.outputs)
    return has_outputs and record.outputs == output_digests(work)


def record_unworked(task: JointTask, message: str) -> JointOutcome:
    """Record that nobody works on a joint any more; what is done stays done.

    Parameters
    ----------
    task : JointTask
        The joint.
    message : str
        Why nobody works on it.
    """
    try:
        with locked(task.work):
            record = read_record(task.work)
            if record is not None and record.key is not None:
                settings = _joint_settings(task)
                inputs = _hashes(_log_files(task.logs.runs(), settings))
                key = _key(inputs, settings_document(settings, report=task.report))
                if _is_whole(task.work, record, key):
                    return _outcome(task, DONE, record.row)
            return record_failure(task, message, message)
    except (FrictionError, OSError) as fault:
        # a worker that is cut off may still write there: the row in its folder says so
        return _outcome(task, FAILED, {"message": f"{message} ({fault})"})


def record_failure(task: JointTask, message: str, details: str) -> JointOutcome:
    """Record that a joint has failed; its folder then holds only the record and the details.

    Parameters
    ----------
    task : JointTask
        The joint.
    message : str
        Message in the row.
    details : str
        Text of the file ``failure.txt``.
    """
    row = _status_columns(task, FAILED, message)
    reset_folder(task.work, row)
    write_text(task.work / FAILURE, f"{details.rstrip()}\n")
    return _outcome(task, FAILED, row)


def settings_document(settings: RunSettings, *, report: bool) -> dict[str, Any]:
    """Return the settings as plain values, for the provenance and for the key of a joint.

    Parameters
    ----------
    settings : RunSettings
        Settings of the stages.
    report : bool
        Whether the report is written.
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


def _run_stages(task: JointTask, runs: Mapping[str, Path], settings: RunSettings) -> str:
    """Run the chain; return which stages and runs were left out."""
    left_out = []

    def collect(stage: str, result: StageResult) -> None:
        if not result.path.exists():
            left_out.append(f"{stage} {result}")

    if task.report:
        run(runs, task.work, settings, collect)
    else:
        analyse(runs, task.work, settings, collect)
    unused = unused_runs(task.work, runs)
    if unused:
        left_out.append(f"no pairs from run {', '.join(unused)}")
    return "; ".join(left_out)


def _joint_settings(task: JointTask) -> RunSettings:
    """Return the settings with the joint, mapping file and gear ratio of its logs."""
    logs, shared = task.logs, task.settings.ingest
    ingest = replace(
        shared,
        joints=(logs.joint,),
        map_file=logs.map_file or shared.map_file,
        gear_ratio=shared.gear_ratio if logs.gear_ratio is None else logs.gear_ratio,
    )
    return replace(task.settings, ingest=ingest)


def _log_files(runs: Mapping[str, Path], settings: RunSettings) -> dict[str, Path]:
    """Return all files of all runs and the mapping file, by name."""
    found: dict[str, Path] = {}
    for name, path in runs.items():
        if not path.exists():
            raise LogError(f"{path}: no such file or folder; expected the logs of run {name}")
        files = sorted(p for p in path.rglob("*") if p.is_file()) if path.is_dir() else [path]
        base = path if path.is_dir() else path.parent
        found |= {f"{name}/{file.relative_to(base).as_posix()}": file for file in files}
    map_file = settings.ingest.map_file
    if map_file is not None:
        if not map_file.is_file():
            raise LogError(f"{map_file}: no such file; expected a mapping file")
        found[map_file.name] = map_file
    return found


def _hashes(files: Mapping[str, Path]) -> dict[str, str]:
    return {name: sha256(file) for name, file in files.items()}


def _states(files: Mapping[str, Path]) -> dict[str, tuple[int, int, int]]:
    """Return what changes with a file: the file itself, its size, and when it was written."""
    found = {name: file.stat() for name, file in files.items()}
    return {name: (one.st_ino, one.st_size, one.st_mtime_ns) for name, one in found.items()}


def _check_unchanged(files: Mapping[str, Path], states: Mapping[str, tuple[int, int, int]]) -> None:
    """Raise if a file is not what it was: the outputs would be of other logs than the record."""
    now = _states(files)
    changed = [str(files[name]) for name in files if now[name] != states[name]]
    if changed:
        raise LogError(
            f"{changed[0]} was written while it was read ({len(changed)} of {len(files)} files);"
            " call again when the logs are complete"
        )


def _key(inputs: Mapping[str, str], settings: Mapping[str, Any]) -> str:
    return _digest({"version": __version__, "inputs": inputs, "settings": settings})


def _digest(document: Mapping[str, Any]) -> str:
    return hashlib.sha256(json.dumps(document, sort_keys=True).encode()).hexdigest()


def _status_columns(task: JointTask, status: str, message: str) -> dict[str, Any]:
    return {
        "robot": task.logs.robot,
        "joint": task.logs.joint,
        "status": status,
        "message": message,
    }


def _outcome(task: JointTask, status: str, row: Mapping[str, Any]) -> JointOutcome:
    return JointOutcome(
        robot=task.logs.robot,
        joint=task.logs.joint,
        status=status,
        message=row["message"],
        verdict=row.get("verdict"),
    )
