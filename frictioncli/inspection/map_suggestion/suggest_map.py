"""Suggest a mapping file for logs whose columns are not recognised."""

from collections.abc import Sequence
from pathlib import Path

from frictioncli.errors import LogError, NotEnoughData
from frictioncli.inspection.map_suggestion.log_head import read_log_head
from frictioncli.inspection.map_suggestion.map_text import map_text
from frictioncli.inspection.map_suggestion.suggestion import suggest_columns
from frictioncli.logs.channels.channel_map import ChannelMap, read_map
from frictioncli.logs.formats import open_log
from frictioncli.logs.log_source import LogSource, Refusal
from frictioncli.logs.runs.discovery import discover
from frictioncli.logs.runs.opening import open_run
from frictioncli.logs.settings import IngestSettings


def suggested_map(logs: Sequence[Path], settings: IngestSettings | None = None) -> str:
    """Return the text of a suggested mapping file.

    It is made from the first log whose columns are not recognised, else from the first log.

    Parameters
    ----------
    logs : sequence of Path
        Log files, or folders of them.
    settings : IngestSettings, optional
        The joint wanted, and a mapping file with the form of the text.

    Raises
    ------
    LogError
        If no log can be opened, or none of its columns resembles a time or a position.

    Examples
    --------
    >>> import tomllib
    >>> from tempfile import TemporaryDirectory
    >>> import numpy as np
    >>> import pandas as pd
    >>> seconds = np.arange(2000) / 100
    >>> angle, rate = 30 * np.sin(seconds), 30 * np.cos(seconds)
    >>> log = pd.DataFrame({"a": 5 * np.sign(rate) + angle / 50, "b": seconds, "c": angle})
    >>> with TemporaryDirectory() as folder:
    ...     log.to_csv(Path(folder, "log.csv"), index=False)
    ...     text = suggested_map([Path(folder)])
    >>> tomllib.loads(text)["channels"]
    {'time': 'b', 'position': 'c', 'torque': 'a'}
    """
    settings = settings or IngestSettings()
    channel_map = read_map(settings.map_file) if settings.map_file is not None else ChannelMap()
    source = _choose_log(logs, settings, channel_map)
    joint = settings.joints[0] if settings.joints else None
    head = read_log_head(source)
    try:
        return map_text(suggest_columns(head, joint), head, source.path.name)
    except NotEnoughData as error:
        raise LogError(f"{source.path}: {error}") from None


def _choose_log(
    logs: Sequence[Path], settings: IngestSettings, channel_map: ChannelMap
) -> LogSource:
    """Return the first log whose columns are not recognised, else the first that can be opened."""
    first: LogSource | None = None
    refusals = []
    for run in discover(logs):
        opened, refused = open_run(run, settings, channel_map)
        for log in refused:
            source = open_log(log.file.path, channel_map.hints)
            if isinstance(source, Refusal):
                refusals.append(f"{log.file.path}: {source.text}")
            elif log.refusal.reason.startswith("no_"):
                return source
        if first is None and opened:
            # not merged with others: with a mapping file, the files of a trace stay separate
            unmerged = open_log(opened[0].file.path, channel_map.hints)
            first = None if isinstance(unmerged, Refusal) else unmerged
    if first is None:
        raise LogError("no log can be opened; " + "; ".join(refusals[:4]))
    return first
