"""When to correct the temperature, and the friction predicted: ``simulate``."""

from dataclasses import asdict
from pathlib import Path

import pandas as pd

from frictioncli import schemas
from frictioncli.correction import evaluation as correction
from frictioncli.correction.settings import CorrectionSettings, ScheduleSettings
from frictioncli.model.document import FrictionModel
from frictioncli.stages.corrected import corrected
from frictioncli.stages.stage import Done, stage
from frictioncli.workfiles import SCHEDULE


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

    rows, faults, unit = corrected(
        work, schemas.SCHEDULE, "simulate", asdict(schedule) | asdict(settings), simulated, extended
    )
    lines = [
        f"{run}, joint {joint}, {phase}: {int(group['corrected'].sum())} corrections"
        f" ({int(group['failed'].sum())} failed), epsilon"
        f" {correction.epsilon(group, 'friction_smoothed'):.3g} {unit}"
        f" ({correction.epsilon(group, 'friction_torque'):.3g} unsmoothed)"
        for (run, joint, phase), group in rows.groupby(["run", "joint", "phase"], sort=False)
    ]
    return Done(work / SCHEDULE, "\n".join([schedule.describe(unit), *lines, *faults]))
