"""Rows of the tables ``pairs`` and ``ramps``, page by page."""

from collections.abc import Iterator

import numpy as np
import pandas as pd
import pyarrow as pa
from numpy.typing import NDArray

from frictioncli.arrays import Numbers
from frictioncli.pairs.pairing import Pairing
from frictioncli.pairs.partitioned_store import Columns
from frictioncli.pairs.ramps import COLUMNS, PARTS
from frictioncli.pairs.segments import TEMPERATURES, Joint, Segments
from frictioncli.pairs.thermal_phases import phases, phases_of


def pair_rows(found: Segments, paired: Pairing, phase: pd.Series) -> Iterator[pa.Table]:
    """Yield rows of :data:`frictioncli.schemas.PAIRS`, ordered by run, joint, pair and angle.

    Parameters
    ----------
    found, paired : Segments, Pairing
        Spans, and the pairs made of them.
    phase : Series
        Phase by run and recording as the manifest says; missing where it does not, and then found
        from the trend of the motor temperature.
    """
    for joint in sorted(paired.pages.keys):
        trend = phases(
            value
            for (heads,) in paired.pages.of(joint, "heads")
            for value in heads["motor_temperature"].tolist()
        )
        for heads, rows in paired.pages.of(joint, "heads", "rows"):
            head = rows["pair"] - heads["pair"][0]
            said = _said(found, heads["recording"], phase)
            name = np.where(pd.isna(said), phases_of(heads["pair"], trend), said)
            speed = paired.speed_of(joint[1], heads)
            yield _table(
                joint,
                {
                    "pair": rows["pair"],
                    "speed": speed[head],
                    "time": heads["time"][head],
                    "phase": name[head],
                    **{name: heads[name][head] for name in TEMPERATURES},
                    "position": (rows["bin"] + 0.5) * found.bin_width,
                    "torque_forward": rows["torque_forward"],
                    "torque_reverse": rows["torque_reverse"],
                    "n_forward": rows["n_forward"],
                    "n_reverse": rows["n_reverse"],
                    "load": rows["load"],
                    "payload": heads["payload"][head],
                },
            )


def ramp_rows(found: Segments, payload: pd.Series) -> Iterator[pa.Table]:
    """Yield rows of :data:`frictioncli.schemas.RAMPS`, ordered by run, joint and time.

    Parameters
    ----------
    found : Segments
        Spans and ramps.
    payload : Series
        Payload by run and recording, missing where unknown. [kg]
    """
    names = np.array([recording for _, recording in found.recordings], dtype=object)
    before = 0
    for joint in sorted(found.counts):
        for (ramps,) in found.pages.of(joint, "ramps"):
            yield _table(
                joint,
                {name: ramps[name] for name in COLUMNS}
                | {
                    "recording": names[ramps["recording"]],
                    "move": ramps["move"] + before,
                    "part": np.array(PARTS, dtype=object)[ramps["part"]],
                    "payload": _said(found, ramps["recording"], payload).astype(float),
                },
            )
        before += found.counts[joint]


def _said(found: Segments, recording: Numbers, said: pd.Series) -> NDArray[np.object_]:
    """Return what the manifest says of recordings that are given by number."""
    keys = pd.MultiIndex.from_tuples(found.recordings, names=["run", "recording"])
    return said.reindex(keys).to_numpy()[recording]


def _table(joint: Joint, columns: Columns) -> pa.Table:
    """Return rows of one run and joint; what is not a number has no value."""
    rows = len(next(iter(columns.values())))
    run, number = joint
    return pa.table(
        {
            "run": pa.DictionaryArray.from_arrays(np.zeros(rows, np.int32), [run]),
            "joint": np.full(rows, number, np.int16),
        }
        | {name: pa.array(values, from_pandas=True) for name, values in columns.items()}
    )
