"""When to correct the temperature: ``simulate``, ``evaluate``."""

from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pandas as pd

from frictioncli import schemas, tables
from frictioncli.chain.stage import Done, stage
from frictioncli.correction import stage as correction
from frictioncli.correction.settings import CorrectionSettings, EvaluationGrid, ScheduleSettings
from frictioncli.diagnosis.applied import with_effects, without_effects
from frictioncli.diagnosis.extended import read_extended
from frictioncli.errors import NotEnoughData
from frictioncli.model.document import FrictionModel, read_models
from frictioncli.provenance import Provenance, hashes
from frictioncli.workfiles import EVALUATION, EXTENDED, MODEL, SCHEDULE, TORQUES


@stage
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


@stage
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


def _corrected(
    work: Path,
    table: schemas.Table,
    name: str,
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
    inputs = hashes([work / TORQUES, source])
    provenance = Provenance(name, settings | {"extended": extended}, inputs)
    tables.write(work / f"{table.name}.parquet", whole, table, provenance, facts)
    return whole, faults, facts.get("torque_unit", "N·m")
