"""Brake columns: how long the brake was closed, whatever the polarity of the signal."""

import re
from collections.abc import Sequence

import numpy as np

from frictioncli.logs.channels import channel_names as names
from frictioncli.logs.channels.column_name import split_unit
from frictioncli.logs.channels.joint_plan import JointPlan
from frictioncli.logs.log_source import LogSource
from frictioncli.logs.samples.row_checks import LIMITS

_NAME = re.compile(r"brake|bremse", re.I)
_MOST_VALUES = 256
_STANDSTILL = 0.02
"""Mean speed with the brake closed, as a share of the highest mean speed of any value. [-]"""


def closed_seconds(source: LogSource, plan: JointPlan, batch_bytes: int) -> float | None:
    """Return how long the brake was closed [s], from another pass over three columns of a log.

    The brake is closed at those values of its column at which the joint does not move. So 0 and 1
    may mean either, as may the bits of KUKA's ``$BRAKE_SIG``.

    Parameters
    ----------
    source : LogSource
        The log.
    plan : JointPlan
        Columns and units of the joint.
    batch_bytes : int
        Size of a batch in the file. [byte]

    Returns
    -------
    float or None
        None where no column is named after a brake, it is constant or no digital signal, or the
        joint never moves.
    """
    brake = _brake_column(source.columns)
    if brake is None:
        return None
    time, position = plan.channels.time.column, plan.channels.position.column
    factor = plan.conversions[names.TIME].factor
    seconds: dict[float, float] = {}
    distances: dict[float, float] = {}
    last: dict[int, float] = {}
    for batch in source.batches([brake, time, position], batch_bytes):
        rows = {c: np.concatenate(([last.get(c, np.nan)], batch.values[c])) for c in batch.values}
        if not len(batch.lines):
            continue
        last = {column: float(values[-1]) for column, values in rows.items()}
        with np.errstate(over="ignore"):  # damaged cells may be of any size
            elapsed = np.diff(rows[time]) * factor
            distance = np.abs(np.diff(rows[position]) * plan.conversions[names.POSITION].factor)
        plausible = (elapsed < LIMITS[names.TIME]) & (distance < LIMITS[names.POSITION])
        good = (elapsed > 0) & plausible & np.isfinite(rows[brake][1:])
        for value in np.unique(rows[brake][1:][good]).tolist():
            at = good & (rows[brake][1:] == value)
            seconds[value] = seconds.get(value, 0.0) + float(elapsed[at].sum())
            distances[value] = distances.get(value, 0.0) + float(distance[at].sum())
            if len(seconds) > _MOST_VALUES:
                return None
    usual = max((distances[value] / seconds[value] for value in seconds), default=0.0)
    if not usual or len(seconds) < 2:
        return None
    return sum(s for value, s in seconds.items() if distances[value] / s < _STANDSTILL * usual)


def _brake_column(columns: Sequence[str]) -> int | None:
    """Return the first column that is named after a brake."""
    return next((i for i, name in enumerate(columns) if _NAME.search(split_unit(name)[0])), None)
