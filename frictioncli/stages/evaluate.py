"""Error of the predicted friction by number of temperature corrections: ``evaluate``."""

from dataclasses import asdict
from pathlib import Path

import pandas as pd

from frictioncli import schemas
from frictioncli.correction import evaluation as correction
from frictioncli.correction.settings import CorrectionSettings, EvaluationGrid
from frictioncli.model.document import FrictionModel
from frictioncli.stages.correction_table import write_correction_table
from frictioncli.stages.stage import StageResult, stage
from frictioncli.workfiles import EVALUATION


@stage
def evaluate(
    work: Path,
    grid: EvaluationGrid | None = None,
    settings: CorrectionSettings | None = None,
    *,
    extended: bool = False,
) -> StageResult:
    """Evaluate all criteria over a grid of schedules: ``evaluation.parquet``.

    Parameters
    ----------
    work : Path
        Work folder with ``torques.parquet`` and the model.
    grid : EvaluationGrid, optional
        Schedules to evaluate.
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
    grid = grid or EvaluationGrid()
    settings = settings or CorrectionSettings()
    notes: list[str] = []

    def calculate(torques: pd.DataFrame, model: FrictionModel) -> pd.DataFrame:
        evaluation = correction.evaluate(torques, model, settings, grid)
        notes.extend(evaluation.notes)
        return evaluation.rows

    rows, faults, unit = write_correction_table(
        work,
        schemas.EVALUATION,
        "evaluate",
        asdict(grid) | asdict(settings),
        calculate,
        extended=extended,
    )
    text = correction.evaluation_text(rows, unit)
    return StageResult(work / EVALUATION, "\n".join([text, *notes, *faults]))
