"""Clocks of a log that are counters of 16 or 32 bits: at the end of its range one begins anew."""

from contextlib import suppress
from dataclasses import replace

import numpy as np

from frictioncli.logs.channels import channel_names as names
from frictioncli.logs.formats.compression import SUFFIXES
from frictioncli.logs.formats.continuous_clock import ContinuousClock
from frictioncli.logs.log_source import LogSource, UnreadableLog
from frictioncli.logs.samples.chunks import PlannedLog

_BITS = (16, 32)
_BATCH_BYTES = 1 << 22
_LEAST_CELL, _MOST_PACKED = 2, 100
"""Bytes of a number with its delimiter, and bytes of text in one of a compressed file."""
_MOST_DAMAGED = 0.05
"""Share of times that a counter may not show. [-]"""
_MOST_PERIODS = 50
"""Longest step across the end of the range."""


def with_continuous_clock(planned: PlannedLog) -> PlannedLog:
    """Return a log whose time goes on where its clock, a counter, begins anew.

    The time is read once more where the log may be long enough for that, at most up to the end of
    the range. A clock is taken for such a counter where it holds whole numbers and falls from the
    end of the range to its beginning, by all but a few sampling periods. Any other clock that is
    set back is left as it is.
    """
    channel = planned.plans[0].channels.time
    factor = planned.plans[0].conversions[names.TIME].factor
    first, period = planned.first_time / factor, planned.period / factor
    # a median of whole numbers may be half of one
    if not _is_whole(first) or not _is_whole(2 * period) or period <= 0:
        return planned
    source = planned.log.source
    for bits in _BITS:
        span = float(1 << bits)
        if abs(first) >= span or first + period * _most_rows(source) < span / 2:
            continue
        if _begins_anew(source, channel.column, span, period):
            clock = ContinuousClock(source, channel.column, span)
            note = f"the clock {channel.name} counts to 2^{bits} and begins anew: its time goes on"
            plans = planned.plans
            return replace(
                planned,
                log=replace(planned.log, source=clock),
                plans=(replace(plans[0], notes=(*plans[0].notes, note)), *plans[1:]),
            )
    return planned


def _is_whole(number: float) -> bool:
    return bool(np.isfinite(number)) and abs(number - round(number)) < 1e-6 * max(1.0, abs(number))


def _most_rows(source: LogSource) -> float:
    """Return a number of rows that a log does not exceed."""
    try:
        size = source.path.stat().st_size
    except OSError:
        return 0.0
    packed = _MOST_PACKED if source.path.suffix.lower() in SUFFIXES else 1
    return size * packed / (_LEAST_CELL * len(source.columns))


def _begins_anew(source: LogSource, time: int, span: float, period: float) -> bool:
    """Return whether the first large fall of a clock is one from the end to the beginning.

    Falls to a damaged time, from which the clock leaps back at once, are passed over.
    """
    last = np.nan
    with suppress(UnreadableLog):
        for batch in source.batches([time], _BATCH_BYTES):
            counts = batch.values[time]
            counts = counts[np.isfinite(counts)]
            shown = (counts == np.round(counts)) & (np.abs(counts) < span)
            if np.count_nonzero(~shown) > 1 + _MOST_DAMAGED * len(counts):
                return False
            counts = np.append(last, counts[shown])
            steps = np.diff(counts)
            falls = steps < -span / 2
            falls[:-1] &= steps[1:] < span / 2
            if falls.any():
                fall = int(np.argmax(falls))
                before, after = counts[fall], counts[fall + 1]
                end = span if after >= 0 else span / 2
                longest = _MOST_PERIODS * period
                return bool(before >= end - longest and 0 < after - before + span <= longest)
            last = float(counts[-1])
    return False
