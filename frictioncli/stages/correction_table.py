"""Tables of ``simulate`` and ``evaluate``: one calculation per joint, on either model."""

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import pandas as pd

from frictioncli import schemas, tables
from frictioncli.diagnosis.documents.apply_extension import with_effects, without_effects
from frictioncli.diagnosis.documents.extended_document import read_extended
from frictioncli.errors import NotEnoughData, TableError
from frictioncli.model.document import FrictionModel, read_models
from frictioncli.provenance import Provenance, input_hashes
from frictioncli.workfiles import EXTENDED, MODEL, TORQUES


def other_joint(source: Path, joint: int, joints: Iterable[int]) -> TableError:
    """Return the error that a model is of a joint that the torques are not of.

    Parameters
    ----------
    source : Path
        File of the model.
    joint : int
        Its joint.
    joints : iterable of int
        The joints of the torques.
    """
    known = ", ".join(str(number) for number in sorted(set(joints)))
    made_by = "diagnose" if source.name == EXTENDED else "fit"
    return TableError(
        f"{source}: of joint {joint}, but {TORQUES} in the same folder has joint(s) {known}; run"
        f" 'frictioncli {made_by}' again"
    )


def write_correction_table(
    work: Path,
    table: schemas.Table,
    stage: str,
    settings: dict[str, Any],
    calculate: Callable[[pd.DataFrame, FrictionModel], pd.DataFrame],
    *,
    extended: bool,
) -> tuple[pd.DataFrame, list[str], str]:
    """Calculate the rows of all joints and write their table.

    Parameters
    ----------
    work : Path
        Work folder with ``torques.parquet`` and the model.
    table : Table
        The table to write.
    stage : str
        Name of the stage, for the provenance.
    settings : dict
        Settings of the stage, for the provenance.
    calculate : callable
        Returns the rows of a joint from its torques and its model.
    extended : bool
        Whether the extended model is used. Its effects are subtracted from the measured friction
        before the calculation and added to the result.

    Returns
    -------
    rows : DataFrame
        Rows of all joints.
    faults : list of str
        Reasons why joints have no rows.
    unit : str
        Unit of torque.

    Raises
    ------
    NotEnoughData
        If no joint has rows.
    """
    torques = tables.read(work / TORQUES, schemas.TORQUES)
    source = work / (EXTENDED if extended else MODEL)
    extensions = read_extended(source) if extended else {}
    parts, faults = [], []
    for model in read_models(source):
        measured = torques[torques["joint"] == model.joint]
        if measured.empty:
            raise other_joint(source, model.joint, torques["joint"])
        try:
            if extended:
                reduced, base, added = without_effects(measured, model, extensions[model.joint])
                parts.append(with_effects(calculate(reduced, base), added))
            else:
                parts.append(calculate(measured, model))
        except NotEnoughData as fault:
            faults.append(str(fault))
    if not parts:
        raise NotEnoughData("; ".join(faults) or f"{source} has no model of these joints")
    rows = pd.concat(parts, ignore_index=True)
    facts = tables.facts(work / TORQUES)
    inputs = input_hashes([work / TORQUES, source])
    provenance = Provenance(stage, settings | {"extended": extended}, inputs)
    tables.write(work / f"{table.name}.parquet", rows, table, provenance, facts)
    return rows, faults, facts.get("torque_unit", "N·m")
