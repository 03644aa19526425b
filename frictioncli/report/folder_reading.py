"""Reading of the files of a work folder that the report uses."""

from collections.abc import Iterator, Mapping, Set
from pathlib import Path
from typing import Any

import pandas as pd

from frictioncli import documents, schemas, tables
from frictioncli.design.document import PlanDocument
from frictioncli.diagnosis.documents.extended_document import ExtendedDocument, extended_model
from frictioncli.diagnosis.documents.extended_model import ExtendedModel
from frictioncli.workfiles import DIAGNOSIS, EXTENDED, MODEL, PLAN

_TABLES = ("samples", "recordings", "rejected", "pairs", "torques", "schedule", "evaluation")


def read_if_present(work: Path, table: schemas.Table, files: Set[str]) -> pd.DataFrame:
    """Return a table of the work folder, without rows if it is not among the files.

    Parameters
    ----------
    work : Path
        The work folder.
    table : Table
        The table.
    files : set of str
        Names of the files that may be read.
    """
    path = work / f"{table.name}.parquet"
    if path.name in files:
        return tables.read(path, table)
    return pd.DataFrame(columns=list(table.names))


def read_extended_models(
    work: Path,
) -> tuple[dict[int, ExtendedDocument], dict[int, ExtendedModel]]:
    """Return each joint's extended model, as it is stated and to be evaluated.

    Parameters
    ----------
    work : Path
        The work folder.
    """
    path = work / EXTENDED
    stated = {one.joint: one for one in documents.read_joints(path, ExtendedDocument, "diagnose")}
    with documents.locate_faults(path, "diagnose"):
        return stated, {joint: extended_model(one) for joint, one in stated.items()}


def read_plan(work: Path) -> PlanDocument:
    """Return the next experiment.

    Parameters
    ----------
    work : Path
        The work folder.
    """
    return documents.read(work / PLAN, PlanDocument, "plan")


def read_metadata(work: Path, files: Set[str]) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Yield the name and the metadata of each of the files with provenance.

    Parameters
    ----------
    work : Path
        The work folder.
    files : set of str
        Names of the files.
    """
    for table in _TABLES:
        path = work / f"{table}.parquet"
        if path.name in files:
            yield path.name, tables.metadata(path)
    for name in (MODEL, DIAGNOSIS, EXTENDED, PLAN):
        if name in files:
            provenance = documents.read_provenance(work / name)
            yield name, provenance.as_dict() if provenance else {}
