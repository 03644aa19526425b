"""Inspection of a file that cannot be used: its format, columns and sampling."""

from contextlib import suppress
from pathlib import Path

import numpy as np

from frictioncli.inspection.findings import FileInspection
from frictioncli.inspection.monitors.sampling import Sampling, SamplingMonitor
from frictioncli.inspection.monitors.windows import Windows
from frictioncli.logs.channels import channel_names as names
from frictioncli.logs.channels import units
from frictioncli.logs.channels.channel_map import ChannelMap
from frictioncli.logs.channels.recognition import LogChannel, recognise_channels
from frictioncli.logs.formats import open_log
from frictioncli.logs.log_source import LogSource, Refusal, UnreadableLog
from frictioncli.logs.runs.discovery import LogRun
from frictioncli.logs.samples.log_rows import LogRows
from frictioncli.logs.settings import IngestSettings

_READABLE = (
    "no_time_channel",
    "no_torque_channel",
    "no_position_channel",
    "no_gear_ratio",
    "torque_in_percent",
    "mapped_column_missing",
)
"""Reasons of refusal for logs that have rows and columns nevertheless."""


def inspect_unusable(
    run: LogRun, path: Path, refusal: Refusal, channel_map: ChannelMap, settings: IngestSettings
) -> FileInspection:
    """Return what a file holds that is not used.

    Parameters
    ----------
    run : LogRun
        Its run.
    path : Path
        The file.
    refusal : Refusal
        Why it is not used.
    channel_map : ChannelMap
        What the user says of its form.
    settings : IngestSettings
        What the user says of the unit of time.
    """
    source = open_log(path, channel_map.hints) if refusal.reason in _READABLE else refusal
    if isinstance(source, Refusal):
        return FileInspection(path=path, run=run.name, reason=refusal.reason, refusal=refusal.text)
    times = [
        channel for channel in recognise_channels(source.columns) if channel.quantity == names.TIME
    ]
    rows, sampling = 0, None
    if times:
        rows, sampling = _sampled(source, times[0], settings)
    return FileInspection(
        path=path,
        run=run.name,
        form=source.form,
        reason=refusal.reason,
        refusal=refusal.text,
        columns=len(source.columns),
        rows=rows,
        sampling=sampling,
    )


def _sampled(
    source: LogSource, time: LogChannel, settings: IngestSettings
) -> tuple[int, Sampling | None]:
    """Return the number of rows of a log, and its sampling."""
    windows, monitor = Windows(), SamplingMonitor()
    factor, rows = np.nan, 0
    with suppress(UnreadableLog):
        for batch in source.batches([time.column], settings.batch_bytes):
            rows += len(batch.lines) + len(batch.bad_lines)
            values = batch.values[time.column]
            finite = np.isfinite(values)
            if np.isnan(factor):
                factor = units.FACTORS[names.TIME][_unit(time, values[finite], settings)]
            for window in windows.update(LogRows(batch.lines[finite], values[finite] * factor, {})):
                monitor.update(window)
    for window in windows.flush():
        monitor.update(window)
    return rows, monitor.result()


def _unit(time: LogChannel, values: np.ndarray, settings: IngestSettings) -> str:
    written = units.canonical(time.unit or time.meaning.unit, names.TIME)
    return settings.forced_units().get(names.TIME) or units.infer_time_unit([values], written)
