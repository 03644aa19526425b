"""Error of the friction estimate by number of temperature corrections: ``evaluate``."""

from dataclasses import asdict
from pathlib import Path

import pandas as pd

from frictioncli import schemas
from frictioncli.correction import evaluation as correction
from frictioncli.correction.settings import CorrectionSettings, EvaluationGrid
from frictioncli.model.document import FrictionModel
from frictioncli.stages.corrected import corrected
from frictioncli.stages.stage import Done, stage
from frictioncli.workfiles import EVALUATION


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

    rows, faults, unit = corrected(
        work, schemas.EVALUATION, "evaluate", asdict(grid) | asdict(settings), evaluated, extended
    )
    text = correction.evaluation_text(rows, unit)
    return Done(work / EVALUATION, "\n".join([text, *notes, *faults]))
