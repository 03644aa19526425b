"""Reading of logs: ``ingest``."""

from pathlib import Path

from frictioncli.logs.ingest import ingest as ingest_logs
from frictioncli.logs.runs.discovery import Logs
from frictioncli.logs.settings import IngestSettings
from frictioncli.stages.stage import StageResult, stage
from frictioncli.workfiles import SAMPLES


@stage
def ingest(logs: Logs, work: Path, settings: IngestSettings | None = None) -> StageResult:
    """Read logs into ``samples.parquet``; unusable rows go to ``rejected.parquet``.

    Parameters
    ----------
    logs : Logs
        Log files or folders, each folder one run; or the runs by name.
    work : Path
        Work folder; it is made if it does not exist.
    settings : IngestSettings, optional
        Joints, units and channels.

    Raises
    ------
    LogError
        If no log can be used.
    MappingError
        If the mapping file or a manifest is wrong.
    """
    summary = ingest_logs(logs, work, settings or IngestSettings())
    return StageResult(work / SAMPLES, str(summary))
