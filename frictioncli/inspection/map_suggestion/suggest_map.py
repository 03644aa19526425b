"""Suggest a mapping file for logs whose columns are not recognised."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from frictioncli.errors import LogError, NotEnoughData
from frictioncli.inspection.map_suggestion.check import check_by_pairing
from frictioncli.inspection.map_suggestion.log_head import LogHead, read_log_head
from frictioncli.inspection.map_suggestion.map_text import map_text
from frictioncli.inspection.map_suggestion.suggestion import Suggestion, suggest_columns
from frictioncli.logs.channels.channel_map import ChannelMap, read_map
from frictioncli.logs.channels.joint_plan import JointPlan
from frictioncli.logs.formats import open_log
from frictioncli.logs.log_source import LogSource, Refusal
from frictioncli.logs.reading_plan import planned_logs
from frictioncli.logs.runs.discovery import LogFile, discover
from frictioncli.logs.runs.file_joint import joint_of_file
from frictioncli.logs.runs.joint_rows import joint_rows
from frictioncli.logs.runs.opening import open_run
from frictioncli.logs.settings import IngestSettings

_MOST_FILES = 8
"""Logs that are looked at."""


def suggested_map(logs: Sequence[Path], settings: IngestSettings | None = None) -> str:
    """Return the text of a suggested mapping file.

    It is made from the log that shows most, of those whose columns are not recognised if there are
    some. Where they are, it takes the torque that ``ingest`` takes without a map. What it says is
    checked by pairing the moves of the logs with it.

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
    joint = settings.joints[0] if settings.joints else None
    best: tuple[Suggestion, LogHead, str] | None = None
    reasons = []
    for log in _looked_at(logs, settings, channel_map):
        source, head = log.source, read_log_head(log.source)
        try:
            found = suggest_columns(head, joint, file_joint=log.joint, plans=log.plans)
        except NotEnoughData as error:
            reasons.append(f"{source.path}: {error}")
            continue
        if best is None or found.worth > best[0].worth:
            best = found, head, source.path.name
    if best is None:
        raise LogError(reasons[0])
    suggestion, head, name = best
    hints = channel_map.hints
    text = map_text(suggestion, head, name, hints=hints)
    check = check_by_pairing(text, logs, settings)
    believed = suggestion.doubted() if check.is_doubtful else suggestion
    return map_text(believed, head, name, check.text, hints)


@dataclass(frozen=True, slots=True)
class _Log:
    """A log, the joint that file or id column name, and how ``ingest`` would read it."""

    source: LogSource
    joint: int | None
    plans: tuple[JointPlan, ...]


def _looked_at(
    logs: Sequence[Path], settings: IngestSettings, channel_map: ChannelMap
) -> list[_Log]:
    """Return logs whose columns are not recognised, else those that can be opened.

    Of many, some evenly spaced ones are returned, the first among them.
    """
    unrecognised: list[LogFile] = []
    recognised: list[LogFile] = []
    refusals = []
    plans: dict[Path, tuple[JointPlan, ...]] = {}
    for run in discover(logs):
        opened, refused = open_run(run, settings, channel_map)
        recognised += [log.file for log in opened]
        planned, _ = planned_logs(opened, settings, channel_map)
        plans |= {log.log.file.path: log.plans for log in planned}
        for log in refused:
            if log.refusal.reason.startswith("no_"):
                unrecognised.append(log.file)
            else:
                refusals.append(f"{log.file.path}: {log.refusal.text}")
    files = unrecognised or recognised
    spaced = sorted({round(i) for i in np.linspace(0, max(len(files) - 1, 0), _MOST_FILES)})
    usable = []
    for file in [files[i] for i in spaced] if files else []:
        # not merged with others: with a mapping file, the files of a trace stay separate
        source = open_log(file.path, channel_map.hints)
        if isinstance(source, Refusal):
            continue
        parts = joint_rows(source, settings, channel_map)
        for part in () if isinstance(parts, Refusal) else parts:
            usable.append(_Log(part, joint_of_file(file, part), plans.get(file.path, ())))
    if not usable:
        raise LogError("no log can be opened; " + "; ".join(refusals[:4]))
    return usable
