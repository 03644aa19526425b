"""Rows of the tables ``pairs``, ``ramps`` and ``starts``, and the text about them."""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow as pa
from numpy.typing import NDArray

from frictioncli import schemas, tables
from frictioncli.arrays import Array, Numbers
from frictioncli.pairs import starts
from frictioncli.pairs.other_joints import OtherMotion
from frictioncli.pairs.pairing import Pairing
from frictioncli.pairs.partitioned_store import Columns
from frictioncli.pairs.ramps import COLUMNS, PARTS, SHARED
from frictioncli.pairs.segments import TEMPERATURES, Joint, SegmentTables
from frictioncli.pairs.thermal_phases import phases, phases_of

_KEY = ["run", "recording"]
_FROM_MANIFEST = ["phase", "payload"]

_LISTED_SPEEDS = 12
"""Speeds of a joint that the text lists."""


def read_phase_and_payload(path: Path) -> pd.DataFrame:
    """Return phase and payload [kg] by run and recording as the manifest gives them.

    Parameters
    ----------
    path : Path
        The table ``recordings``; without that file the result is empty.

    Returns
    -------
    DataFrame
        Columns ``phase`` and ``payload``, missing where the manifest gives none.
    """
    if not path.exists():
        return pd.DataFrame(columns=[*_KEY, *_FROM_MANIFEST]).set_index(_KEY)
    recordings = tables.read(path, schemas.RECORDINGS)
    return recordings.drop_duplicates(_KEY).set_index(_KEY)[_FROM_MANIFEST]


def pair_rows(segments: SegmentTables, pairing: Pairing, phase: pd.Series) -> Iterator[pa.Table]:
    """Yield rows of :data:`frictioncli.schemas.PAIRS`, ordered by run, joint, pair and angle.

    Parameters
    ----------
    segments : SegmentTables
        The segments.
    pairing : Pairing
        Pairs of these segments.
    phase : Series
        Phase by run and recording from the manifest. Where it is missing, the phase is found from
        the trend of the motor temperature.

    Yields
    ------
    Table
        Whole pairs of one run and joint.
    """
    for joint in sorted(pairing.store.keys):
        trend = phases(
            value
            for (pairs,) in pairing.store.read(joint, "pairs")
            for value in pairs["motor_temperature"].tolist()
        )
        for pairs, bins in pairing.store.read(joint, "pairs", "bins"):
            row = bins["pair"] - pairs["pair"][0]
            given = _of_recordings(segments, pairs["recording"], phase)
            name = np.where(pd.isna(given), phases_of(pairs["pair"], trend), given)
            speed = pairing.speed_of(joint[1], pairs)
            yield _table(
                joint,
                {
                    "pair": bins["pair"],
                    "speed": speed[row],
                    "time": pairs["time"][row],
                    "phase": name[row],
                    **{name: pairs[name][row] for name in TEMPERATURES},
                    "position": (bins["bin"] + 0.5) * segments.bin_width,
                    "torque_forward": bins["torque_forward"],
                    "torque_reverse": bins["torque_reverse"],
                    "n_forward": bins["n_forward"],
                    "n_reverse": bins["n_reverse"],
                    "load": bins["load"],
                    "payload": pairs["payload"][row],
                    "pose": pairs["pose"][row],
                },
            )


def ramp_rows(segments: SegmentTables, payload: pd.Series) -> Iterator[pa.Table]:
    """Yield rows of :data:`frictioncli.schemas.RAMPS`, ordered by run, joint and time.

    Parameters
    ----------
    segments : SegmentTables
        Segments and ramps.
    payload : Series
        Payload by run and recording, missing where unknown. [kg]

    Yields
    ------
    Table
        Ramps of one run and joint.
    """
    names = np.array([recording for _, recording in segments.recordings], dtype=object)
    before = 0
    for joint in sorted(segments.counts):
        for (ramps,) in segments.store.read(joint, "ramps"):
            if segments.other_motion.leaves_out(joint[1]):
                alone = ~ramps[SHARED]
                ramps = {name: values[alone] for name, values in ramps.items()}
            carried = _carried(segments, ramps, payload)
            yield _table(
                joint,
                {name: ramps[name] for name in COLUMNS}
                | {
                    "recording": names[ramps["recording"]],
                    "move": ramps["move"] + before,
                    "part": np.array(PARTS, dtype=object)[ramps["part"]],
                    "payload": carried,
                    "pose": ramps["pose"],
                },
            )
        before += segments.counts[joint]


def start_rows(segments: SegmentTables, payload: pd.Series) -> Iterator[pa.Table]:
    """Yield rows of :data:`frictioncli.schemas.STARTS`, ordered by run, joint and time.

    Parameters
    ----------
    segments : SegmentTables
        Segments and starts.
    payload : Series
        Payload by run and recording, missing where unknown. [kg]

    Yields
    ------
    Table
        Starts of one run and joint.
    """
    names = np.array([recording for _, recording in segments.recordings], dtype=object)
    before = 0
    for joint in sorted(segments.counts):
        for (found,) in segments.store.read(joint, "starts"):
            kept = found[starts.NUMBER] % segments.starts.stride(joint) == 0
            if segments.other_motion.leaves_out(joint[1]):
                kept &= ~np.isin(found["move"], found["move"][found[SHARED]])
            rows = {name: values[kept] for name, values in found.items()}
            carried = _carried(segments, rows, payload)
            yield _table(
                joint,
                {name: rows[name] for name in starts.COLUMNS}
                | {
                    "recording": names[rows["recording"]],
                    "move": rows["move"] + before,
                    "payload": carried,
                    "pose": rows["pose"],
                },
            )
        before += segments.counts[joint]


def _carried(segments: SegmentTables, rows: Columns, payload: pd.Series) -> Array:
    """Return the payload of the motion of rows, else that of their recording [kg]."""
    of_recording = _of_recordings(segments, rows["recording"], payload).astype(float)
    return np.where(np.isnan(rows["payload"]), of_recording, rows["payload"])


def _of_recordings(
    segments: SegmentTables, recording: Numbers, values: pd.Series
) -> NDArray[np.object_]:
    """Return the values of recordings that are given by number."""
    keys = pd.MultiIndex.from_tuples(segments.recordings, names=_KEY)
    return values.reindex(keys).to_numpy()[recording]


def _table(joint: Joint, columns: Columns) -> pa.Table:
    """Return rows of one run and joint; NaN becomes null."""
    rows = len(next(iter(columns.values())))
    run, number = joint
    return pa.table(
        {
            "run": pa.DictionaryArray.from_arrays(np.zeros(rows, np.int32), [run]),
            "joint": np.full(rows, number, np.int16),
        }
        | {name: pa.array(values, from_pandas=True) for name, values in columns.items()}
    )


@dataclass(slots=True)
class PairCounts:
    """Counts of pairs by joint and speed, and of their samples by joint."""

    speeds: dict[int, Counter[float]] = field(default_factory=dict)
    of_joint: Counter[int] = field(default_factory=Counter)

    @property
    def samples(self) -> int:
        """Samples in pairs, of all joints."""
        return self.of_joint.total()

    def share(self, joint: int, moving: int) -> float:
        """Return the share of a joint's samples in motion that are in pairs."""
        return self.of_joint[joint] / max(moving, 1)

    def count(self, tables: Iterable[pa.Table]) -> Iterator[pa.Table]:
        """Yield tables of :func:`pair_rows` unchanged, and count them."""
        for rows in tables:
            joint = int(rows["joint"][0].as_py())
            _, first = np.unique(rows["pair"].to_numpy(), return_index=True)
            speed = np.round(rows["speed"].to_numpy()[first], 1)
            self.speeds.setdefault(joint, Counter()).update(speed.tolist())
            for name in ("n_forward", "n_reverse"):
                self.of_joint[joint] += int(rows[name].to_numpy().sum())
            yield rows


def pairing_text(
    counts: PairCounts, facts: Mapping[str, Any], other_motion: OtherMotion, requested_width: float
) -> str:
    """Return the text on pairs per speed and samples dropped per reason.

    Parameters
    ----------
    counts : PairCounts
        Counts of the pairs.
    facts : mapping
        ``samples``, ``dropped`` and ``bin_width`` of the pairing.
    other_motion : OtherMotion
        Samples taken while other joints moved.
    requested_width : float
        Requested width of the angle bins. [deg]
    """
    lines = []
    if facts["bin_width"] > requested_width:
        lines.append(
            f"angle bins widened from {requested_width:g} to {facts['bin_width']:g} deg: the joint"
            " moves that far between samples"
        )
    for joint, speeds in sorted(counts.speeds.items()):
        listed = sorted(speeds)[:_LISTED_SPEEDS]
        text = ", ".join(f"{speeds[speed]} at {speed:g}" for speed in listed)
        more = (
            f" and {len(speeds) - _LISTED_SPEEDS} other speeds"
            if len(speeds) > _LISTED_SPEEDS
            else ""
        )
        lines.append(f"joint {joint}: {speeds.total()} pairs: {text}{more} deg/s")
    for joint in sorted(counts.speeds):
        kind = "note" if other_motion.tells_poses_apart(joint) else "warning"
        lines += [f"{kind}: {text}" for text in other_motion.texts([joint])]
    dropped = "; ".join(
        f"{reason} {count:,}" for reason, count in facts["dropped"].items() if count
    )
    lines.append(
        f"samples: {facts['samples']:,} read, {counts.samples:,} in pairs; dropped: {dropped or 0}"
    )
    return "\n".join(lines)
