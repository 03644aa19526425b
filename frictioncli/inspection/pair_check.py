"""Constant-speed segments and pairs of logs, found by the code of the stage ``pair``."""

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import pandas as pd
import pyarrow as pa

from frictioncli.errors import NotEnoughData
from frictioncli.pairs.other_joints import OtherMotion
from frictioncli.pairs.pair_tables import pair_rows
from frictioncli.pairs.pairing import pair_segments
from frictioncli.pairs.partitioned_store import PartitionedStore
from frictioncli.pairs.segments import Joint, SegmentTables, find_segments
from frictioncli.pairs.settings import PairingSettings

FORWARD, REVERSE = "forward", "reverse"

_PAIR_COLUMNS = (
    "run",
    "joint",
    "pair",
    "speed",
    "phase",
    "temperature",
    "half_difference",
    "load_low",
    "load_high",
)

NO_SEGMENTS: Mapping[str, int] = MappingProxyType(dict.fromkeys((FORWARD, REVERSE), 0))
SegmentCounts = dict[tuple[str, str, int], dict[str, int]]
"""Run, recording and joint -> number of constant-speed segments by direction."""


def segments_and_pairs(
    samples: Iterable[pa.RecordBatch],
    conditions: Callable[[], pd.DataFrame],
    settings: PairingSettings,
    folder: Path,
) -> tuple[SegmentCounts, pd.DataFrame, OtherMotion]:
    """Find the constant-speed segments of samples, and their pairs.

    Parameters
    ----------
    samples : iterable of RecordBatch
        Rows of :data:`frictioncli.schemas.SAMPLES`, recording by recording.
    conditions : callable
        Called after the last sample; returns ``phase`` and ``payload`` [kg] by run and recording.
    settings : PairingSettings
        Settings of the stage ``pair``.
    folder : Path
        Folder for temporary files.

    Returns
    -------
    counts : SegmentCounts
        Number of constant-speed segments.
    pairs : DataFrame
        One row per pair: run, joint, pair, speed [deg/s], phase, temperature of the motor, or of
        the housing where it has none [°C], mean half difference of the torques, lowest and highest
        load. [N·m or A]
    other_motion : OtherMotion
        Samples taken while other joints moved.
    """
    with PartitionedStore[Joint](folder) as moving, PartitionedStore[Joint](folder) as paired:
        found = find_segments(samples, settings.steady, settings.bin_width, moving)
        known = conditions()
        try:
            pairing = pair_segments(found, settings, paired, known["payload"])
        except NotEnoughData:
            none = pd.DataFrame(columns=_PAIR_COLUMNS)
            return _segment_counts(found), none, found.other_motion
        pairs = [_pair_means(rows) for rows in pair_rows(found, pairing, known["phase"])]
        return _segment_counts(found), pd.concat(pairs, ignore_index=True), found.other_motion


def _segment_counts(found: SegmentTables) -> SegmentCounts:
    """Return the number of constant-speed segments of each joint in each recording."""
    segment_counts: SegmentCounts = {}
    for run, joint in found.counts:
        for (segments,) in found.store.read((run, joint), "segments"):
            for direction, sign in ((FORWARD, 1), (REVERSE, -1)):
                numbers, counts = np.unique(
                    segments["recording"][segments["direction"] == sign], return_counts=True
                )
                for number, count in zip(numbers.tolist(), counts.tolist(), strict=True):
                    key = (*found.recordings[number], joint)
                    segment_counts.setdefault(key, dict(NO_SEGMENTS))[direction] += count
    return segment_counts


def _pair_means(rows: pa.Table) -> pd.DataFrame:
    """Return one row per pair."""
    frame = rows.to_pandas()
    half = (frame["torque_forward"] - frame["torque_reverse"]) / 2
    load = (frame["torque_forward"] + frame["torque_reverse"]) / 2
    load = frame["load"].where(frame["load"].notna(), load)
    temperature = frame["motor_temperature"].fillna(frame["housing_temperature"])
    known = frame.assign(half_difference=half, load_torque=load, temperature=temperature)
    grouped: Any = known.groupby("pair", sort=False)
    return grouped.agg(
        run=("run", "first"),
        joint=("joint", "first"),
        speed=("speed", "first"),
        phase=("phase", "first"),
        temperature=("temperature", "first"),
        half_difference=("half_difference", "mean"),
        load_low=("load_torque", "min"),
        load_high=("load_torque", "max"),
    ).reset_index()
