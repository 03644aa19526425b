"""Find the time column: it grows from row to row in nearly even steps."""

from dataclasses import dataclass

import numpy as np

from frictioncli.inspection.map_suggestion.log_head import LogHead
from frictioncli.logs.channels import channel_names as names
from frictioncli.logs.channels import units
from frictioncli.logs.channels.column_name import split_unit
from frictioncli.logs.channels.recognition import recognise_channels

_LEAST_GROWING = 0.98
"""Least share of steps that are positive."""
_MAX_SPREAD = 0.5
"""Largest median absolute deviation of the steps, relative to their median."""
_COUNTER_TOLERANCE = 1e-9
_PERIODS = (2e-4, 5.0)
"""Range of sampling periods of robot logs. [s]"""


@dataclass(frozen=True, slots=True)
class TimeColumn:
    """A column that may be the time.

    Attributes
    ----------
    column : int
        Index in the file.
    step : float
        Median step from row to row. [raw]
    unit : str or None
        Its unit, None where it is unknown.
    reason : str
        The evidence for it.
    """

    column: int
    step: float
    unit: str | None
    reason: str


def find_time_columns(head: LogHead) -> list[TimeColumn]:
    """Return the columns that may be the time, best first.

    Columns named as a time come first. Of the others, those whose steps vary come first, as
    measured time does; steps of exactly 1 may be those of a row counter.
    """
    named = {c.column: c for c in recognise_channels(head.names) if c.quantity == names.TIME}
    ranked: list[tuple[tuple[bool, bool, int], TimeColumn]] = []
    for column, values in head.values.items():
        steps = np.diff(values)
        if len(steps) < 2 or np.mean(steps > 0) < _LEAST_GROWING:
            continue
        step = float(np.median(steps))
        spread = float(np.median(np.abs(steps - step)))
        if spread > _MAX_SPREAD * step:
            continue
        is_counter = abs(step - 1) < _COUNTER_TOLERANCE and spread < _COUNTER_TOLERANCE
        channel = named.get(column)
        written = split_unit(head.names[column])[1] or (channel.meaning.unit if channel else "")
        unit = units.canonical(written, names.TIME) if written else None
        growth = f"grows by {step:.4g} from row to row"
        reason = f"{growth}, and its name says time" if channel else growth
        reason += ", or counts rows" * is_counter
        rank = (channel is None, is_counter, len(ranked))
        ranked.append((rank, TimeColumn(column, step, unit, reason)))
    return [time for _, time in sorted(ranked, key=lambda pair: pair[0])]


def possible_time_units(time: TimeColumn) -> list[str]:
    """Return the units of time with a usual sampling period, the shortest first.

    The order matters: a unit that is too short leaves velocities that fit no unit, one that is too
    long may fit by chance.
    """
    if time.unit is not None:
        return [time.unit]
    factors = units.FACTORS[names.TIME]
    low, high = _PERIODS
    return [u for u in ("ns", "us", "ms", "s") if low <= time.step * factors[u] <= high] or ["s"]
