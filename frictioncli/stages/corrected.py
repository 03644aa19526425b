"""What ``simulate`` and ``evaluate`` share: the base or the extended model of every joint."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pandas as pd

from frictioncli import schemas, tables
from frictioncli.diagnosis.documents.apply_extension import with_effects, without_effects
from frictioncli.diagnosis.documents.extended_model import read_extended
from frictioncli.errors import NotEnoughData
from frictioncli.model.document import FrictionModel, read_models
from frictioncli.provenance import Provenance, input_hashes
from frictioncli.workfiles import EXTENDED, MODEL, TORQUES


def corrected(
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
    inputs = input_hashes([work / TORQUES, source])
    provenance = Provenance(name, settings | {"extended": extended}, inputs)
    tables.write(work / f"{table.name}.parquet", whole, table, provenance, facts)
    return whole, faults, facts.get("torque_unit", "N·m")
