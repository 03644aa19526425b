"""From logs to samples: ``ingest``."""

from pathlib import Path

from frictioncli.logs.ingest import ingest as ingest_logs
from frictioncli.logs.runs.discovery import Logs
from frictioncli.logs.settings import IngestSettings
from frictioncli.stages.stage import Done, stage
from frictioncli.workfiles import SAMPLES


@stage
def ingest(logs: Logs, work: Path, settings: IngestSettings | None = None) -> Done:
    """Read logs into ``samples.parquet``; what cannot be used goes to ``rejected.parquet``."""
    summary = ingest_logs(logs, work, settings or IngestSettings())
    return Done(work / SAMPLES, str(summary))
