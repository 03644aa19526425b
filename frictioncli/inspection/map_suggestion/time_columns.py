"""Which column is the time: it grows from row to row, in steps that are nearly even."""

from dataclasses import dataclass

import numpy as np

from frictioncli.inspection.map_suggestion.probe import Probe
from frictioncli.logs.channels import aliases as names
from frictioncli.logs.channels import units
from frictioncli.logs.channels.recognition import recognise_channels, split_unit

_GROWS = 0.98
_EVEN = 0.5
_COUNTER = 1e-9
_PERIODS = (2e-4, 5.0)
"""Periods at which robots are logged. [s]"""


@dataclass(frozen=True, slots=True)
class TimeColumn:
    """A column that may be the time: its step, its unit where known, and what speaks for it."""

    column: int
    step: float
    unit: str | None
    why: str


def clocks(found: Probe) -> list[TimeColumn]:
    """Return the columns that may be the time, best first.

    A name that says so counts most; then a step that varies a little, as measured time does: one
    that is exactly 1 may be a counter of rows.
    """
    said = {c.column: c for c in recognise_channels(found.names) if c.quantity == names.TIME}
    ranked: list[tuple[tuple[bool, bool, int], TimeColumn]] = []
    for column, values in found.values.items():
        steps = np.diff(values)
        if len(steps) < 2 or np.mean(steps > 0) < _GROWS:
            continue
        step = float(np.median(steps))
        spread = float(np.median(np.abs(steps - step)))
        if spread > _EVEN * step:
            continue
        counter = abs(step - 1) < _COUNTER and spread < _COUNTER
        channel = said.get(column)
        written = split_unit(found.names[column])[1] or (channel.meaning.unit if channel else "")
        unit = units.canonical(written, names.TIME) if written else None
        even = f"grows by {step:.4g} from row to row"
        why = f"{even}, and its name says time" if channel else even
        rank = (channel is None, counter, len(ranked))
        ranked.append((rank, TimeColumn(column, step, unit, why + ", or counts rows" * counter)))
    return [clock for _, clock in sorted(ranked, key=lambda pair: pair[0])]


def possible_units(clock: TimeColumn) -> list[str]:
    """Return the units of time in which a log has a usual rate, the shortest first.

    A unit that is too short leaves velocities that no unit explains; one that is too long may not.
    """
    if clock.unit is not None:
        return [clock.unit]
    factors = units.FACTORS[names.TIME]
    low, high = _PERIODS
    return [u for u in ("ns", "us", "ms", "s") if low <= clock.step * factors[u] <= high] or ["s"]
