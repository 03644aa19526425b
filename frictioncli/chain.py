"""The stages on a work folder: each reads the tables of the one before and writes its own.

Every function here is a command of the same name; what it returns prints as that command's output.
All of them one after the other: :mod:`frictioncli.pipeline`.
"""

import functools
import inspect
import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, ParamSpec

import pandas as pd

from frictioncli import schemas, tables
from frictioncli.correction import stage as correction
from frictioncli.correction.settings import CorrectionSettings, EvaluationGrid, ScheduleSettings
from frictioncli.diagnosis.applied import with_effects, without_effects
from frictioncli.diagnosis.diagnose import diagnose_joint
from frictioncli.diagnosis.document import diagnosis_document, extended_document, verdict_text
from frictioncli.diagnosis.extended import EXTENDED, read_extended
from frictioncli.diagnosis.ramps import ramp_logs
from frictioncli.diagnosis.recall import DIAGNOSIS
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.errors import NotEnoughData
from frictioncli.files import write_text
from frictioncli.model.document import FrictionModel, by_joint, read_models, write_models
from frictioncli.model.fitting import fit_joint
from frictioncli.model.settings import FitSettings
from frictioncli.motion.given import given
from frictioncli.motion.pages import Pages
from frictioncli.motion.pairing import pair_spans
from frictioncli.motion.results import pair_rows, ramp_rows
from frictioncli.motion.separation import separate as separate_pairs
from frictioncli.motion.separation import sign_conventions
from frictioncli.motion.settings import PairingSettings
from frictioncli.motion.spans import Joint, find_spans
from frictioncli.motion.summary import PairTally, TorqueRanges, pairing_text, separation_text
from frictioncli.provenance import Provenance, hashes, to_json
from frictioncli.reading.discovery import Logs
from frictioncli.reading.ingest import ingest as ingest_logs
from frictioncli.reading.settings import IngestSettings
from frictioncli.workfolder import alone, outdated

SAMPLES = "samples.parquet"
RECORDINGS = "recordings.parquet"
PAIRS = "pairs.parquet"
RAMPS = "ramps.parquet"
TORQUES = "torques.parquet"
MODEL = "model.json"
SCHEDULE = "schedule.parquet"
EVALUATION = "evaluation.parquet"


@dataclass(frozen=True, slots=True)
class Done:
    """What a stage made, and what it has to say about it."""

    path: Path
    text: str

    def __str__(self) -> str:
        return self.text


_Arguments = ParamSpec("_Arguments")


def _stage(work_on: Callable[_Arguments, Done]) -> Callable[_Arguments, Done]:
    """Let a stage have its work folder to itself, and say which of its inputs are out of date."""
    signature = inspect.signature(work_on)

    @functools.wraps(work_on)
    def stage(*args: _Arguments.args, **kwargs: _Arguments.kwargs) -> Done:
        work: Path = signature.bind(*args, **kwargs).arguments["work"]
        with alone(work):
            done = work_on(*args, **kwargs)
            # a page shows all tables of its folder
            used = [done.path] if done.path.parent == work else sorted(work.iterdir())
            warnings = [f"warning: {text}" for text in outdated(used)]
        return Done(done.path, "\n".join([*warnings, done.text]))

    return stage


@_stage
def ingest(logs: Logs, work: Path, settings: IngestSettings | None = None) -> Done:
    """Read logs into ``samples.parquet``; what cannot be used goes to ``rejected.parquet``."""
    summary = ingest_logs(logs, work, settings or IngestSettings())
    return Done(work / SAMPLES, str(summary))


@_stage
def pair(work: Path, settings: PairingSettings | None = None) -> Done:
    """Match counter-directed constant velocity: ``pairs.parquet``; the rest: ``ramps.parquet``."""
    settings = settings or PairingSettings()
    source = work / SAMPLES
    facts = tables.facts(source)
    provenance = Provenance("pair", asdict(settings), hashes(_present(source, work / RECORDINGS)))
    said = given(work / RECORDINGS)
    tally = PairTally()
    with (
        Pages[Joint](work) as moving,
        Pages[Joint](work) as paired,
        tables.TableWriter(work / RAMPS, schemas.RAMPS, provenance) as ramps,
        tables.TableWriter(work / PAIRS, schemas.PAIRS, provenance) as pairs,
    ):
        samples = tables.ahead(tables.batches(source, schemas.SAMPLES))
        found = find_spans(samples, settings.steady, settings.bin_width, moving)
        pairing = pair_spans(found, settings, paired, said["payload"])
        facts |= {
            "samples": found.samples,
            "dropped": pairing.dropped,
            "bin_width": found.bin_width,
        }
        ramps.facts = pairs.facts = facts
        for rows in ramp_rows(found, said["payload"]):
            ramps.write(rows)
        for rows in tally.counted(pair_rows(found, pairing, said["phase"])):
            pairs.write(rows)
    return Done(work / PAIRS, pairing_text(tally, facts, settings.bin_width))


@_stage
def separate(work: Path, sign: int | None = None) -> Done:
    """Separate friction torque from load torque by equation (8): ``torques.parquet``."""
    source = work / PAIRS
    facts = tables.facts(source)
    signs = sign_conventions(tables.batches(source, schemas.PAIRS), sign)
    facts["sign"] = {str(joint): value for joint, value in signs.items()}
    provenance = Provenance("separate", {"sign": sign}, hashes([source]))
    ranges = TorqueRanges()
    with tables.TableWriter(work / TORQUES, schemas.TORQUES, provenance) as torques:
        pairs = tables.ahead(tables.batches(source, schemas.PAIRS))
        for rows in ranges.seen(separate_pairs(batch, signs) for batch in pairs):
            torques.write(rows)
        facts |= {"load_unit": "N·m"} if ranges.own_load else {}
        torques.facts = facts
    return Done(work / TORQUES, separation_text(ranges, signs, facts, told=sign is not None))


@_stage
def fit(work: Path, settings: FitSettings | None = None) -> Done:
    """Identify equation (16) for every joint: ``model.json``."""
    settings = settings or FitSettings()
    source = work / TORQUES
    facts = tables.facts(source)
    torques = tables.read(source, schemas.TORQUES)
    models, faults = [], []
    for _, group in torques.groupby("joint"):
        try:
            models.append(fit_joint(group, facts, settings))
        except NotEnoughData as fault:
            faults.append(str(fault))
    if not models:
        raise NotEnoughData("; ".join(faults))
    write_models(work / MODEL, models, Provenance("fit", asdict(settings), hashes([source])))
    return Done(work / MODEL, "\n".join([*(model.table() for model in models), *faults]))


@_stage
def diagnose(work: Path, settings: DiagnosisSettings | None = None) -> Done:
    """Find what the simulated torque gets wrong: ``diagnosis.json``, ``extended-model.json``."""
    settings = settings or DiagnosisSettings()
    torques = tables.read(work / TORQUES, schemas.TORQUES)
    facts = tables.facts(work / TORQUES)
    unit = facts.get("torque_unit", "N·m")
    ramps = ramp_logs(work / RAMPS, facts.get("sign", {}))
    inputs = _present(work / TORQUES, work / MODEL, work / RAMPS)
    found, faults = [], []
    for model in read_models(work / MODEL):
        rows = torques[torques["joint"] == model.joint]
        own = ramps.get(model.joint)
        try:
            diagnosis = diagnose_joint(rows, model.temperature, unit, settings, ramps=own)
            found.append((model, diagnosis))
        except NotEnoughData as fault:
            faults.append(str(fault))
    if not found:
        raise NotEnoughData("; ".join(faults))
    provenance = Provenance("diagnose", asdict(settings), hashes(inputs))
    chief = max(found, key=lambda pair: pair[0].n_pairs)[0].joint
    for name, documents in (
        (DIAGNOSIS, {m.joint: diagnosis_document(d, settings) for m, d in found}),
        (EXTENDED, {m.joint: extended_document(d, m) for m, d in found}),
    ):
        write_text(work / name, to_json(by_joint(documents, chief, provenance)))
    return Done(work / DIAGNOSIS, "\n".join([*(verdict_text(d) for _, d in found), *faults]))


def has_finding(work: Path, *, named_only: bool) -> bool:
    """Return whether ``diagnosis.json`` holds a cause, or one that has a single name."""
    whole = json.loads((work / DIAGNOSIS).read_text(encoding="utf-8"))
    causes = [
        cause for part in whole.get("joints", {"": whole}).values() for cause in part["causes"]
    ]
    return any(len(cause["effects"]) == 1 or not named_only for cause in causes)


@_stage
def simulate(
    work: Path,
    schedule: ScheduleSettings | None = None,
    settings: CorrectionSettings | None = None,
    *,
    extended: bool = False,
) -> Done:
    """Simulate Algorithm 3 with one criterion, on the base or the extended model."""
    schedule = schedule or ScheduleSettings()
    settings = settings or CorrectionSettings()

    def simulated(torques: pd.DataFrame, model: FrictionModel) -> pd.DataFrame:
        return correction.simulate(torques, model, settings, schedule)

    rows, faults, unit = _corrected(
        work, schemas.SCHEDULE, "simulate", asdict(schedule) | asdict(settings), simulated, extended
    )
    lines = [
        f"{run}, joint {joint}, {phase}: {int(group['corrected'].sum())} corrections"
        f" ({int(group['failed'].sum())} failed), epsilon"
        f" {correction.epsilon(group, 'friction_smoothed'):.3g} {unit}"
        f" ({correction.epsilon(group, 'friction_torque'):.3g} unsmoothed)"
        for (run, joint, phase), group in rows.groupby(["run", "joint", "phase"], sort=False)
    ]
    return Done(work / SCHEDULE, "\n".join([schedule.told(unit), *lines, *faults]))


@_stage
def evaluate(
    work: Path,
    grid: EvaluationGrid | None = None,
    settings: CorrectionSettings | None = None,
    *,
    extended: bool = False,
) -> Done:
    """Evaluate all criteria over a grid of settings, on the base or the extended model."""
    grid = grid or EvaluationGrid()
    settings = settings or CorrectionSettings()
    notes: list[str] = []

    def evaluated(torques: pd.DataFrame, model: FrictionModel) -> pd.DataFrame:
        found = correction.evaluate(torques, model, settings, grid)
        notes.extend(found.notes)
        return found.rows

    rows, faults, unit = _corrected(
        work, schemas.EVALUATION, "evaluate", asdict(grid) | asdict(settings), evaluated, extended
    )
    text = correction.evaluation_text(rows, unit)
    return Done(work / EVALUATION, "\n".join([text, *notes, *faults]))


@_stage
def report(work: Path) -> Done:
    """Draw the figures and write the page: ``report/index.html``."""
    from frictioncli.report.page import write_report

    page = write_report(work)
    return Done(page, str(page))


def _write(
    path: Path,
    rows: pd.DataFrame,
    table: schemas.Table,
    stage: str,
    settings: Any,
    inputs: list[Path],
    facts: Mapping[str, Any],
) -> None:
    values = settings if isinstance(settings, dict) else asdict(settings)
    tables.write(path, rows, table, Provenance(stage, values, hashes(inputs)), facts)


def _present(*paths: Path) -> list[Path]:
    """Return the inputs that a work folder has; those of older versions lack some."""
    return [path for path in paths if path.exists()]


def _corrected(
    work: Path,
    table: schemas.Table,
    stage: str,
    settings: dict[str, Any],
    work_on: Callable[[pd.DataFrame, FrictionModel], pd.DataFrame],
    extended: bool,
) -> tuple[pd.DataFrame, list[str], str]:
    """Write what a correction stage gives for each joint; return it, what fails, and the unit."""
    torques = tables.read(work / TORQUES, schemas.TORQUES)
    source = work / (EXTENDED if extended else MODEL)
    extensions = read_extended(source) if extended else {}
    rows, faults = [], []
    for model in read_models(source):
        own = torques[torques["joint"] == model.joint]
        try:
            if extended:
                bare, base, added = without_effects(own, model, extensions[model.joint])
                rows.append(with_effects(work_on(bare, base), added))
            else:
                rows.append(work_on(own, model))
        except NotEnoughData as fault:
            faults.append(str(fault))
    if not rows:
        raise NotEnoughData("; ".join(faults) or f"{source} has no model of these joints")
    whole = pd.concat(rows, ignore_index=True)
    facts = tables.facts(work / TORQUES)
    _write(
        work / f"{table.name}.parquet",
        whole,
        table,
        stage,
        settings | {"extended": extended},
        [work / TORQUES, source],
        facts,
    )
    return whole, faults, facts.get("torque_unit", "N·m")
