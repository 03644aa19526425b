"""From torques to a friction model: ``fit``."""

from dataclasses import asdict
from pathlib import Path

from frictioncli import schemas, tables
from frictioncli.errors import NotEnoughData
from frictioncli.model.document import write_models
from frictioncli.model.fitting import fit_joint
from frictioncli.model.settings import FitSettings
from frictioncli.provenance import Provenance, input_hashes
from frictioncli.stages.stage import Done, stage
from frictioncli.workfiles import MODEL, TORQUES


@stage
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
    write_models(work / MODEL, models, Provenance("fit", asdict(settings), input_hashes([source])))
    return Done(work / MODEL, "\n".join([*(model.table() for model in models), *faults]))
