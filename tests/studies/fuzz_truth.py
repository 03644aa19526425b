"""What a damaged log must have given where its rows are known."""

from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow.parquet as pq

from tests.studies.fuzz_damage import Case

_NEIGHBOURS = 12
"""Rows about a damaged one that may go with it: it is not known which of them is wrong."""

_SAME_TIME = 1e-4
"""Greatest difference of a row's time. [s]"""


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
        if kept != one["rows_kept"]:
            return f"{kept} samples, but {dict(one)}"
        if kept + one["rows_rejected"] != one["rows_read"]:
            return f"{kept} kept + {one['rows_rejected']} rejected is not {one['rows_read']} read"
        if not (np.diff(samples["time"][key]) > 0).all():
            return "time does not grow"
    for name, of_it in recordings.groupby("recording"):
        lost = int((rows["recording"] == name).sum())
        counts = of_it["rows_rejected"]
        # a row is of all joints, or each is of one
        if not (counts == lost).all() and counts.sum() != lost:
            return f"{lost} rejected rows of {name}, but {counts.to_list()}"
    values = samples[["time", "position", "velocity", "torque"]].to_numpy()
    if not np.isfinite(values).all():
        return "a sample is no number"
    read = recordings["rows_read"]
    read = read.iloc[0] if case.layout.joints is None else read.sum()
    if case.lines is not None and case.lines != read:
        return f"{case.lines} lines, but {read} rows read"
    if case.whole is None or case.touched is None:
        return ""
    of_rows = case.layout.joints
    joints = [case.layout.joint] if of_rows is None else sorted(set(of_rows))
    found = (_values(case, samples[samples["joint"] == joint], joint) for joint in joints)
    return next(filter(None, found), "")


def _values(case: Case, own: pd.DataFrame, joint: int) -> str:
    """Compare the samples of a joint with its rows that nothing has touched."""
    assert case.whole is not None
    assert case.touched is not None
    log = case.layout
    whole = [i for i in case.whole if log.joints is None or log.joints[i] == joint]
    expected = [log.torque] if log.position is None else [log.position, log.torque]
    names = ["torque"] if log.position is None else ["position", "torque"]
    # rows are one of a kind: six digits tell which is which
    known = {}
    for shift in (1e-7, 0.0):
        rounded = np.round(np.column_stack(expected)[whole] + shift, 6).tolist()
        known |= {tuple(row): place for row, place in zip(rounded, whole, strict=True)}
    found = [known.get(tuple(row)) for row in np.round(own[names].to_numpy(), 6).tolist()]
    strange = [place for place, row in enumerate(found) if row is None]
    if len(strange) > case.touched:
        some = own[names].iloc[strange[:3]].to_numpy().tolist()
        return f"{len(strange)} samples are none of the {len(whole)} whole rows: {some}"
    least = len(whole) - _NEIGHBOURS * (case.touched + 1)
    if len(found) - len(strange) < least:
        return f"only {len(found) - len(strange)} of {len(whole)} whole rows were kept"
    if log.time is None or len(found) == len(strange):
        return ""
    shifts = np.array(
        [
            time - log.time[row]
            for time, row in zip(own["time"].to_list(), found, strict=True)
            if row is not None
        ]
    )
    places = [row for row in found if row is not None]
    away = np.abs(shifts - np.median(shifts))
    # a damaged cell may read as another row: of two samples that do, one is that row
    nearest: dict[int, float] = {}
    for place, distance in zip(places, away.tolist(), strict=True):
        nearest[place] = min(distance, nearest.get(place, distance))
    other = sum(distance > _SAME_TIME for distance in nearest.values())
    return f"{other} of {len(nearest)} whole rows have another time" if other else ""
