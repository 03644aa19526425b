"""A first mapping file for logs: for the first that is not recognised, else for the first."""

from collections.abc import Sequence
from pathlib import Path

from frictioncli.errors import LogError, NotEnoughData
from frictioncli.inspection.map_suggestion.map_text import map_text
from frictioncli.inspection.map_suggestion.probe import probe
from frictioncli.inspection.map_suggestion.suggestion import suggest
from frictioncli.logs.channels.channel_map import ChannelMap, read_map
from frictioncli.logs.formats import open_log
from frictioncli.logs.log_source import LogSource, Refusal
from frictioncli.logs.runs.discovery import discover
from frictioncli.logs.runs.opening import open_run
from frictioncli.logs.settings import IngestSettings


def suggested_map(logs: Sequence[Path], settings: IngestSettings | None = None) -> str:
    """Return the text of a first mapping file.

    Parameters
    ----------
    logs : sequence of Path
        Log files, or folders of them.
    settings : IngestSettings, optional
        The joint wanted, and the form of the text by a mapping file that has ``[csv]`` only.

    Raises
    ------
    LogError
        If no log can be opened, or none of its columns is like a time or a position.
    """
    settings = settings or IngestSettings()
    channel_map = read_map(settings.map_file) if settings.map_file is not None else ChannelMap()
    source = _source(logs, settings, channel_map)
    joint = settings.joints[0] if settings.joints else None
    found = probe(source)
    try:
        return map_text(suggest(found, joint), found, source.path.name)
    except NotEnoughData as fault:
        raise LogError(f"{source.path}: {fault}") from None


def _source(logs: Sequence[Path], settings: IngestSettings, channel_map: ChannelMap) -> LogSource:
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
            # alone: with a map the files of one trace are not put together
            alone = open_log(opened[0].file.path, channel_map.hints)
            first = None if isinstance(alone, Refusal) else alone
    if first is None:
        raise LogError("no log can be opened; " + "; ".join(refusals[:4]))
    return first
