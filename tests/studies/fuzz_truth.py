"""What a damaged log must have given where its rows are known."""

from pathlib import Path

import numpy as np
import pyarrow.parquet as pq

from tests.studies.fuzz_damage import Case

_NEIGHBOURS = 12
"""Rows about a damaged one that may go with it: it is not known which of them is wrong."""


def contradiction(case: Case, work: Path) -> str:
    """Return what is wrong with the tables of a damaged log; empty where nothing is.

    Parameters
    ----------
    case : Case
        The damaged log.
    work : Path
        Where ``ingest`` has written its tables.
    """
    recordings = pq.read_table(work / "recordings.parquet").to_pandas()
    samples = pq.read_table(work / "samples.parquet").to_pandas()
    rejected = pq.read_table(work / "rejected.parquet").to_pandas()
    rows = rejected[rejected["row"].notna()]
    for _, one in recordings.iterrows():
        key = (samples["recording"] == one["recording"]) & (samples["joint"] == one["joint"])
        kept = int(key.sum())
        lost = int((rows["recording"] == one["recording"]).sum())
        if kept != one["rows_kept"] or lost != one["rows_rejected"]:
            return f"{kept} samples and {lost} rejected rows, but {dict(one)}"
        if kept + lost != one["rows_read"]:
            return f"{kept} kept + {lost} rejected is not {one['rows_read']} read"
        if not (np.diff(samples["time"][key]) > 0).all():
            return "time does not grow"
    values = samples[["time", "position", "velocity", "torque"]].to_numpy()
    if not np.isfinite(values).all():
        return "a sample is no number"
    if case.lines is not None and case.lines != recordings["rows_read"].iloc[0]:
        return f"{case.lines} lines, but {recordings['rows_read'].iloc[0]} rows read"
    if case.whole is not None and case.touched is not None:
        own = samples[samples["joint"] == case.layout.joint]
        return _values(case, own["position"].to_numpy(), own["torque"].to_numpy())
    return ""


def _values(case: Case, position: np.ndarray, torque: np.ndarray) -> str:
    """Compare the samples with the rows that nothing has touched."""
    assert case.whole is not None
    assert case.touched is not None
    whole = list(case.whole)
    expected = np.column_stack((case.layout.position, case.layout.torque))[whole]
    found = np.column_stack((position, torque))
    # rows are one of a kind: six digits tell which is which
    known = {tuple(row) for row in np.round(expected, 6).tolist()}
    known |= {tuple(row) for row in np.round(expected + 1e-7, 6).tolist()}
    strange = [row for row in np.round(found, 6).tolist() if tuple(row) not in known]
    if len(strange) > case.touched:
        return f"{len(strange)} samples are none of the {len(whole)} whole rows: {strange[:3]}"
    least = len(whole) - _NEIGHBOURS * (case.touched + 1)
    if len(found) - len(strange) < least:
        return f"only {len(found) - len(strange)} of {len(whole)} whole rows were kept"
    return ""
