"""The stages on a work folder: each reads the tables of the one before and writes its own.

Every function here is a command of the same name; what it returns prints as that command's output.
All of them one after the other: :mod:`frictioncli.pipeline`.
"""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

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
from frictioncli.motion.given import given, of_recordings
from frictioncli.motion.pairing import pair_spans
from frictioncli.motion.phases import add_phases
from frictioncli.motion.separation import separate as separate_pairs
from frictioncli.motion.settings import PairingSettings
from frictioncli.motion.spans import find_spans
from frictioncli.motion.summary import pairing_text, separation_text
from frictioncli.provenance import Provenance, hashes, to_json
from frictioncli.reading.ingest import ingest as ingest_logs
from frictioncli.reading.settings import IngestSettings

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


def ingest(logs: Sequence[Path], work: Path, settings: IngestSettings | None = None) -> Done:
    """Read logs into ``samples.parquet``; what cannot be used goes to ``rejected.parquet``."""
    summary = ingest_logs(logs, work, settings or IngestSettings())
    return Done(work / SAMPLES, str(summary))


def pair(work: Path, settings: PairingSettings | None = None) -> Done:
    """Match counter-directed constant velocity: ``pairs.parquet``; the rest: ``ramps.parquet``."""
    settings = settings or PairingSettings()
    source = work / SAMPLES
    facts = tables.facts(source)
    found = find_spans(tables.batches(source, schemas.SAMPLES), settings.steady, settings.bin_width)
    said = given(work / RECORDINGS)
    paired = pair_spans(found, settings, said["payload"])
    pairs = add_phases(paired.pairs, of_recordings(paired.pairs, said["phase"]))
    facts |= {
        "samples": paired.samples,
        "dropped": paired.dropped,
        "bin_width": paired.bin_width,
    }
    ramps = found.ramps.assign(payload=of_recordings(found.ramps, said["payload"]).astype(float))
    _write(work / RAMPS, ramps, schemas.RAMPS, "pair", settings, [source], facts)
    _write(work / PAIRS, pairs, schemas.PAIRS, "pair", settings, [source], facts)
    return Done(work / PAIRS, pairing_text(pairs, facts, settings.bin_width))


def separate(work: Path, sign: int | None = None) -> Done:
    """Separate friction torque from load torque by equation (8): ``torques.parquet``."""
    source = work / PAIRS
    facts = tables.facts(source)
    torques, signs = separate_pairs(tables.read(source, schemas.PAIRS), sign)
    facts["sign"] = {str(joint): value for joint, value in signs.items()}
    if torques["load"].notna().any():
        facts["load_unit"] = "N·m"
    _write(work / TORQUES, torques, schemas.TORQUES, "separate", {"sign": sign}, [source], facts)
    return Done(work / TORQUES, separation_text(torques, signs, facts, told=sign is not None))


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


def diagnose(work: Path, settings: DiagnosisSettings | None = None) -> Done:
    """Find what the simulated torque gets wrong: ``diagnosis.json``, ``extended-model.json``."""
    settings = settings or DiagnosisSettings()
    torques = tables.read(work / TORQUES, schemas.TORQUES)
    facts = tables.facts(work / TORQUES)
    unit = facts.get("torque_unit", "N·m")
    ramps = ramp_logs(work / RAMPS, facts.get("sign", {}))
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
    provenance = Provenance("diagnose", asdict(settings), hashes([work / TORQUES, work / MODEL]))
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
