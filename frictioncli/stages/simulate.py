"""Simulation of the temperature correction with one schedule: ``simulate``."""

from dataclasses import asdict
from pathlib import Path

import pandas as pd

from frictioncli import schemas
from frictioncli.correction import evaluation as correction
from frictioncli.correction.settings import CorrectionSettings, ScheduleSettings
from frictioncli.model.document import FrictionModel
from frictioncli.stages.correction_table import write_correction_table
from frictioncli.stages.stage import StageResult, stage
from frictioncli.wording import count_text
from frictioncli.workfiles import SCHEDULE


@stage
def simulate(
    work: Path,
    schedule: ScheduleSettings | None = None,
    settings: CorrectionSettings | None = None,
    *,
    extended: bool = False,
) -> StageResult:
    """Simulate Algorithm 3 with one schedule: ``schedule.parquet``.

    Parameters
    ----------
    work : Path
        Work folder with ``torques.parquet`` and the model.
    schedule : ScheduleSettings, optional
        When the temperature is corrected.
    settings : CorrectionSettings, optional
        How corrections are computed.
    extended : bool
        Whether the extended model is used.

    Raises
    ------
    NotEnoughData
        If no joint has a thermal cycle and a model that depends on temperature.
    TableError
        If a table or the model is missing or damaged.
    """
    schedule = schedule or ScheduleSettings()
    settings = settings or CorrectionSettings()

    def calculate(torques: pd.DataFrame, model: FrictionModel) -> pd.DataFrame:
        return correction.simulate(torques, model, settings, schedule)

    rows, faults, unit = write_correction_table(
        work,
        schemas.SCHEDULE,
        "simulate",
        asdict(schedule) | asdict(settings),
        calculate,
        extended=extended,
    )
    lines = [
        f"{run}, joint {joint}, {phase}: {count_text(int(group['corrected'].sum()), 'correction')}"
        f" ({int(group['failed'].sum())} failed), epsilon"
        f" {correction.epsilon(group, 'friction_smoothed'):.3g} {unit}"
        f" ({correction.epsilon(group, 'friction_torque'):.3g} unsmoothed)"
        for (run, joint, phase), group in rows.groupby(["run", "joint", "phase"], sort=False)
    ]
    return StageResult(work / SCHEDULE, "\n".join([schedule.describe(unit), *lines, *faults]))
