"""Files that the page offers: tables as CSV and Parquet, models, robot programs.

They lie beside the page in ``report/data``, since a page that held them all could not be opened.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from shutil import copyfile

import numpy as np
import pandas as pd
import pyarrow as pa
from pyarrow import csv

from frictioncli import schemas, tables
from frictioncli.arrays import Array
from frictioncli.report.results import WorkFolderResults
from frictioncli.workfiles import DIAGNOSIS, EXTENDED, MODEL, PLAN

FOLDER = "data"

_TABLES = (
    (schemas.TORQUES, "friction and load torque of each pair and angle"),
    (schemas.SCHEDULE, "simulated corrections"),
    (schemas.EVALUATION, "error by setting of the corrections"),
)
_DOCUMENTS = (
    (MODEL, "base model"),
    (EXTENDED, "extended model"),
    (DIAGNOSIS, "diagnosis"),
    (PLAN, "next experiment"),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Download:
    """One line of the list of downloads.

    Attributes
    ----------
    name : str
        What it is.
    files : tuple of (str, str)
        Text and address, relative to the page, of each form.
    """

    name: str
    files: tuple[tuple[str, str], ...]


def downloads(results: WorkFolderResults) -> list[Download]:
    """Return the files that the page offers.

    Parameters
    ----------
    results : WorkFolderResults
        Contents of the work folder.
    """
    found = []
    for table, what in _TABLES:
        stem = f"{FOLDER}/{table.name}"
        if f"{table.name}.parquet" in results.files:
            forms = (("CSV", f"{stem}.csv"), ("Parquet", f"{stem}.parquet"))
            found.append(Download(name=what, files=forms))
    found += [
        Download(name=what, files=((name, f"{FOLDER}/{name}"),))
        for name, what in _DOCUMENTS
        if name in results.files
    ]
    if programs := program_files(results):
        links = tuple((name, f"{FOLDER}/{name}") for name in programs)
        found.append(Download(name="robot program of the next experiment", files=links))
    return found


def program_files(results: WorkFolderResults) -> list[str]:
    """Return the names of the robot program's files, of the experiment and of its check.

    Parameters
    ----------
    results : WorkFolderResults
        Contents of the work folder.
    """
    names: list[str] = []
    for joint in results.joints:
        if joint.plan is not None:
            names += joint.plan.programme.files
            names += getattr(joint.plan.check, "files", ())
    return [name for name in names if name in results.files]


def write_downloads(work: Path, draft: Path, found: Sequence[Download]) -> None:
    """Write the files that the page offers.

    Parameters
    ----------
    work : Path
        The work folder, which they are copied from.
    draft : Path
        The folder of the page.
    found : sequence of Download
        The files.
    """
    (draft / FOLDER).mkdir()
    schema = {table.name: table for table, _ in _TABLES}
    for _, address in (form for one in found for form in one.files):
        source, target = work / Path(address).name, draft / address
        if target.suffix == ".csv" and target.stem in schema:
            rows = tables.read(source.with_suffix(".parquet"), schema[target.stem])
            _write_csv(rows, target)
        else:
            copyfile(source, target)


def _write_csv(rows: pd.DataFrame, target: Path) -> None:
    """Write a table as CSV with nine digits; pandas would format number by number."""
    rounded = rows.copy()
    for name in rows.select_dtypes("floating"):
        rounded[name] = _nine_digits(rows[name].to_numpy())
    for name in rows.select_dtypes("bool"):
        rounded[name] = rows[name].astype(str)
    csv.write_csv(pa.Table.from_pandas(rounded, preserve_index=False), target)


def _nine_digits(values: Array) -> Array:
    """Return values as near as possible to their first nine digits, so that no more are written."""
    with np.errstate(divide="ignore", over="ignore"):
        scale = 10.0 ** (8 - np.floor(np.log10(np.abs(values))))
    # an integer over a power of ten is the float nearest to that decimal number
    plain = (scale >= 1) & (scale <= 1e22)
    scale = np.where(plain, scale, 1.0)
    return np.where(plain, np.rint(values * scale) / scale, values)
