"""From a diagnosis to the next experiment: ``plan``."""

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from frictioncli import schemas, tables
from frictioncli.design.blocks import Block
from frictioncli.design.document import block_document, limits_document, plan_document, plan_text
from frictioncli.design.limits import Limits
from frictioncli.design.paper_protocol import algorithms, new_limits, usual_seconds
from frictioncli.design.plan import plan_joint
from frictioncli.design.programs import FORMS
from frictioncli.design.programs.robot_program import SAFETY_NOTE, RobotProgram
from frictioncli.design.settings import PlanSettings
from frictioncli.diagnosis.documents.reload import is_current, read_documents
from frictioncli.documents import to_json
from frictioncli.errors import NotEnoughData, OptionError, TableError
from frictioncli.files import write_text
from frictioncli.model.document import read_models
from frictioncli.provenance import Provenance, input_hashes
from frictioncli.stages.stage import Done, stage
from frictioncli.workfiles import DIAGNOSIS, EXTENDED, MODEL, PLAN, TORQUES


@stage
def plan(work: Path, settings: PlanSettings | None = None) -> Done:
    """Plan the next experiment of one joint: ``plan.json`` and a robot program."""
    settings = settings or PlanSettings()
    documents = read_documents(work)
    if not documents:
        raise TableError(f"{work / DIAGNOSIS} is missing; run 'frictioncli diagnose' first")
    models = {model.joint: model for model in read_models(work / MODEL)}
    known = sorted(documents.keys() & models.keys())
    joint = settings.joint or max(known, key=lambda one: (models[one].n_pairs, -one), default=0)
    if joint not in known:
        raise OptionError(
            f"--joint {joint}: {work / DIAGNOSIS} knows joint"
            f" {', '.join(map(str, known)) or 'none'}"
        )
    torques = tables.read(work / TORQUES, schemas.TORQUES)
    torques = torques[torques["joint"] == joint]
    document, extended = documents[joint]
    if torques.empty or not is_current(document, torques):
        raise TableError(
            f"{work / DIAGNOSIS} is of other runs than {TORQUES}; run 'frictioncli diagnose' again"
        )
    if document.verdict == "unnamed" and torques["motor_temperature"].isna().all():
        raise NotEnoughData(
            f"joint {joint}: structure without a name, and no motor temperature in the log to plan"
            " with; log the temperature first"
        )
    unit = str(tables.facts(work / TORQUES).get("torque_unit", "N·m"))
    found = plan_joint(torques, unit, document, extended, settings)
    name = f"friction_a{joint}"
    files = _written(work, settings, name, joint, found.blocks, found.limits, found.timings[-1].end)
    checks = []
    if found.check:
        end = found.check_timings[-1].end
        checks = _written(work, settings, f"{name}_check", joint, found.check, found.limits, end)
    units = {one: entry.unit for one, entry in models[joint].parameters.items()}
    inputs = input_hashes([work / TORQUES, work / MODEL, work / DIAGNOSIS, work / EXTENDED])
    told = plan_document(found, units, files, checks)
    _write(work, told, settings, Provenance("plan", asdict(settings), inputs))
    return Done(work / PLAN, plan_text(found, units, [*files, *checks]))


@stage
def plan_new(work: Path, settings: PlanSettings) -> Done:
    """Write the paper's Algorithms 1 and 2 for a joint of which there are no data yet."""
    limits = new_limits(settings)
    assert settings.joint is not None  # the limits say so if it is missing
    blocks, seconds = algorithms(limits), usual_seconds(limits)
    name = f"friction_a{settings.joint}_new"
    files = _written(work, settings, name, settings.joint, blocks, limits, seconds)
    document = {
        "joint": settings.joint,
        "verdict": None,
        "limits": limits_document(limits),
        "programme": {
            "files": files,
            "duration_s": seconds,
            "blocks": [block_document(block, None) for block in blocks],
        },
    }
    _write(work, document, settings, Provenance("plan", asdict(settings), {}))
    sweep, cycle = blocks[0].steps[0], blocks[1].steps[1]
    text = "\n".join(
        [
            f"joint {settings.joint}: Algorithms 1 and 2 of the paper, about"
            f" {seconds / 3600:.1f} h by the paper's times",
            f"  sweep, cold: {_speeds(sweep)} deg/s",
            f"  every degree up to {limits.hottest:.0f} °C and back to 25 °C: {_speeds(cycle)}"
            " deg/s",
            f"  program: {', '.join(files)}. {SAFETY_NOTE}",
        ]
    )
    return Done(work / PLAN, text)


def _speeds(series: object) -> str:
    return ", ".join(f"{speed:.4g}" for speed in getattr(series, "speeds", ()))


def _written(
    work: Path,
    settings: PlanSettings,
    name: str,
    joint: int,
    blocks: tuple[Block, ...],
    limits: Limits,
    seconds: float,
) -> list[str]:
    """Write the robot program of blocks; return the names of its files."""
    program = RobotProgram(name=name, axis=joint, blocks=blocks, limits=limits, seconds=seconds)
    files = FORMS[settings.to](program)
    for file, text in files.items():
        write_text(work / file, text)
    return sorted(files)


def _write(
    work: Path, document: Mapping[str, Any], settings: PlanSettings, provenance: Provenance
) -> None:
    budget = {"budget_min": settings.minutes, "provenance": provenance.as_dict()}
    write_text(work / PLAN, to_json({**document, **budget}))
