"""Identification of the friction model: ``fit``."""

from dataclasses import asdict
from pathlib import Path

from frictioncli import schemas, tables
from frictioncli.errors import NotEnoughData
from frictioncli.model.document import write_models
from frictioncli.model.fitting import fit_joint
from frictioncli.model.settings import FitSettings
from frictioncli.provenance import Provenance, input_hashes
from frictioncli.stages.stage import StageResult, stage
from frictioncli.workfiles import MODEL, TORQUES


@stage
def fit(work: Path, settings: FitSettings | None = None) -> StageResult:
    """Identify equation (16) for every joint: ``model.json``.

    Parameters
    ----------
    work : Path
        Work folder with ``torques.parquet``.
    settings : FitSettings, optional
        Method and temperature.

    Raises
    ------
    NotEnoughData
        If no joint can be identified.
    TableError
        If a table is missing or damaged.
    """
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
        raise NotEnoughData("; ".join(faults) or f"{source} has no rows")
    write_models(work / MODEL, models, Provenance("fit", asdict(settings), input_hashes([source])))
    return StageResult(work / MODEL, "\n".join([*(model.table() for model in models), *faults]))
