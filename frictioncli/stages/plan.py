"""Plan of the next experiment: ``plan``."""

from dataclasses import asdict, replace
from pathlib import Path

from frictioncli import schemas, tables
from frictioncli.design.document import PlanDocument, ProgrammeRecord
from frictioncli.design.from_plan import (
    block_record,
    limits_record,
    plan_document,
    stated_half_widths,
)
from frictioncli.design.paper_protocol import algorithms, new_limits, usual_seconds
from frictioncli.design.plan import plan_joint
from frictioncli.design.programs import FORMS
from frictioncli.design.programs.robot_program import SAFETY_NOTE, RobotProgram
from frictioncli.design.settings import PlanSettings
from frictioncli.design.text import plan_text
from frictioncli.diagnosis.documents.extended_document import ExtendedDocument
from frictioncli.diagnosis.documents.reload import is_current, read_documents
from frictioncli.documents import read_joints
from frictioncli.documents import write as write_document
from frictioncli.errors import NotEnoughData, OptionError, TableError
from frictioncli.files import write_text
from frictioncli.model.document import read_models
from frictioncli.provenance import Provenance, input_hashes
from frictioncli.stages.stage import StageResult, stage
from frictioncli.workfiles import DIAGNOSIS, EXTENDED, MODEL, PLAN, TORQUES


@stage
def plan(work: Path, settings: PlanSettings | None = None) -> StageResult:
    """Plan the next experiment of one joint: ``plan.json`` and a robot program.

    Parameters
    ----------
    work : Path
        Work folder with the outputs of ``diagnose``.
    settings : PlanSettings, optional
        Time, limits and form of the program.

    Raises
    ------
    OptionError
        If the joint is not known, or the limits leave nothing to plan.
    NotEnoughData
        If the data do not allow a plan.
    TableError
        If a file is missing, damaged or out of date.
    """
    settings = settings or PlanSettings()
    documents = read_documents(work)
    if not documents:
        raise TableError(f"{work / DIAGNOSIS} is missing; run 'frictioncli diagnose' first")
    models = {model.joint: model for model in read_models(work / MODEL)}
    known = sorted(documents.keys() & models.keys())
    joint = settings.joint or max(known, key=lambda one: (models[one].n_pairs, -one), default=0)
    if joint not in known:
        raise OptionError(
            f"--joint {joint}: {work / DIAGNOSIS} has joint {', '.join(map(str, known)) or 'none'}"
        )
    torques = tables.read(work / TORQUES, schemas.TORQUES)
    torques = torques[torques["joint"] == joint]
    document, extended = documents[joint]
    if torques.empty or not is_current(document, torques):
        raise TableError(
            f"{work / DIAGNOSIS} was made from other runs than {TORQUES};"
            " run 'frictioncli diagnose' again"
        )
    if document.verdict == "unnamed" and torques["motor_temperature"].isna().all():
        raise NotEnoughData(
            f"joint {joint}: structure without a name, and no motor temperature in the log to plan"
            " with; log the temperature first"
        )
    facts = tables.facts(work / TORQUES)
    experiment = plan_joint(
        torques,
        str(facts.get("torque_unit", "N·m")),
        document,
        extended,
        settings,
        angle_logged=facts.get("position") != "integrated",
    )
    program = RobotProgram(
        name=f"friction_a{joint}",
        axis=joint,
        blocks=experiment.blocks,
        limits=experiment.limits,
        seconds=experiment.timings[-1].end,
    )
    files = _write_program(work, program, settings.to)
    checks = []
    if experiment.check:
        check = replace(
            program,
            name=f"{program.name}_check",
            blocks=experiment.check,
            seconds=experiment.check_timings[-1].end,
        )
        checks = _write_program(work, check, settings.to)
    units = {one: entry.unit for one, entry in models[joint].parameters.items()}
    extensions = read_joints(work / EXTENDED, ExtendedDocument, "diagnose")
    model = next(one for one in extensions if one.joint == joint)
    stated = stated_half_widths(model, document.causes)
    inputs = input_hashes([work / TORQUES, work / MODEL, work / DIAGNOSIS, work / EXTENDED])
    planned = plan_document(experiment, units, stated, files, checks, settings.minutes)
    write_document(work / PLAN, planned, Provenance("plan", asdict(settings), inputs))
    return StageResult(work / PLAN, plan_text(experiment, units, stated, [*files, *checks]))


@stage
def plan_new(work: Path, settings: PlanSettings) -> StageResult:
    """Write the paper's Algorithms 1 and 2 as a program, for a joint without data.

    Parameters
    ----------
    work : Path
        Folder that ``plan.json`` and the program are written to.
    settings : PlanSettings
        Joint, limits and form of the program.

    Raises
    ------
    OptionError
        If the joint or a limit is missing.
    """
    limits = new_limits(settings)
    assert settings.joint is not None  # new_limits has checked it
    blocks, seconds = algorithms(limits), usual_seconds(limits)
    program = RobotProgram(
        name=f"friction_a{settings.joint}_new",
        axis=settings.joint,
        blocks=blocks,
        limits=limits,
        seconds=seconds,
    )
    files = _write_program(work, program, settings.to)
    document = PlanDocument(
        joint=settings.joint,
        verdict=None,
        limits=limits_record(limits),
        programme=ProgrammeRecord(
            files=tuple(files),
            duration_s=seconds,
            blocks=tuple(block_record(block) for block in blocks),
        ),
        budget_min=settings.minutes,
    )
    write_document(work / PLAN, document, Provenance("plan", asdict(settings), {}))
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
    return StageResult(work / PLAN, text)


def _speeds(series: object) -> str:
    return ", ".join(f"{speed:.4g}" for speed in getattr(series, "speeds", ()))


def _write_program(work: Path, program: RobotProgram, form: str) -> list[str]:
    """Write a robot program; return the names of its files."""
    files = FORMS[form](program)
    for file, text in files.items():
        write_text(work / file, text)
    return sorted(files)
