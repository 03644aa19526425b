"""Constant speed and pairs in logs, found with the code of the stage ``pair``."""

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import pandas as pd
import pyarrow as pa

from frictioncli.errors import NotEnoughData
from frictioncli.pairs.pair_tables import pair_rows
from frictioncli.pairs.pairing import pair_segments
from frictioncli.pairs.partitioned_store import PartitionedStore
from frictioncli.pairs.segments import Joint, SegmentTables, find_segments
from frictioncli.pairs.settings import PairingSettings

FORWARD, REVERSE = "forward", "reverse"

_HEADS = (
    "run",
    "joint",
    "pair",
    "speed",
    "phase",
    "motor_temperature",
    "half_difference",
    "load_low",
    "load_high",
)

NO_SEGMENTS: Mapping[str, int] = MappingProxyType(dict.fromkeys((FORWARD, REVERSE), 0))
SegmentCounts = dict[tuple[str, str, int], dict[str, int]]
"""Run, recording and joint -> constant-speed parts forward and in reverse."""


def segments_and_pairs(
    samples: Iterable[pa.RecordBatch],
    said: Callable[[], pd.DataFrame],
    settings: PairingSettings,
    folder: Path,
) -> tuple[SegmentCounts, pd.DataFrame]:
    """Return the constant-speed parts of samples, and one row per pair of them.

    Parameters
    ----------
    samples : iterable of RecordBatch
        Rows of :data:`frictioncli.schemas.SAMPLES`, recording by recording.
    said : callable
        Asked when all samples are through: ``phase`` and ``payload`` [kg] by run and recording.
    settings : PairingSettings
        What makes a pair.
    folder : Path
        Where intermediate tables may lie.

    Returns
    -------
    moves : SegmentCounts
        How often a constant speed was held.
    pairs : DataFrame
        Run, joint, pair, speed [deg/s], phase, motor temperature [°C], mean half difference of the
        torques, lowest and highest load.
    """
    with PartitionedStore[Joint](folder) as moving, PartitionedStore[Joint](folder) as paired:
        found = find_segments(samples, settings.steady, settings.bin_width, moving)
        told = said()
        try:
            pairing = pair_segments(found, settings, paired, told["payload"])
        except NotEnoughData:
            return _moves(found), pd.DataFrame(columns=_HEADS)
        parts = [_heads(rows) for rows in pair_rows(found, pairing, told["phase"])]
        return _moves(found), pd.concat(parts, ignore_index=True)


def _moves(found: SegmentTables) -> SegmentCounts:
    """Return how often each joint held a constant speed in each recording."""
    moves: SegmentCounts = {}
    for run, joint in found.counts:
        for (segments,) in found.store.read((run, joint), "segments"):
            for way, sign in ((FORWARD, 1), (REVERSE, -1)):
                numbers, counts = np.unique(
                    segments["recording"][segments["direction"] == sign], return_counts=True
                )
                for number, count in zip(numbers.tolist(), counts.tolist(), strict=True):
                    key = (*found.recordings[number], joint)
                    moves.setdefault(key, dict(NO_SEGMENTS))[way] += count
    return moves


def _heads(rows: pa.Table) -> pd.DataFrame:
    """Return one row per pair."""
    frame = rows.to_pandas()
    half = (frame["torque_forward"] - frame["torque_reverse"]) / 2
    load = (frame["torque_forward"] + frame["torque_reverse"]) / 2
    load = frame["load"].where(frame["load"].notna(), load)
    grouped: Any = frame.assign(half_difference=half, own_load=load).groupby("pair", sort=False)
    return grouped.agg(
        run=("run", "first"),
        joint=("joint", "first"),
        speed=("speed", "first"),
        phase=("phase", "first"),
        motor_temperature=("motor_temperature", "first"),
        half_difference=("half_difference", "mean"),
        load_low=("own_load", "min"),
        load_high=("own_load", "max"),
    ).reset_index()
