"""Names of the files of a work folder, and the commands that make them."""

from pathlib import Path

SAMPLES = "samples.parquet"
RECORDINGS = "recordings.parquet"
REJECTED = "rejected.parquet"
PAIRS = "pairs.parquet"
RAMPS = "ramps.parquet"
STARTS = "starts.parquet"
TORQUES = "torques.parquet"
MODEL = "model.json"
SCHEDULE = "schedule.parquet"
EVALUATION = "evaluation.parquet"
DIAGNOSIS = "diagnosis.json"
EXTENDED = "extended-model.json"
PLAN = "plan.json"
COMPARISON = "comparison.json"
CHALLENGE = "challenge.parquet"
REPORT = "report"

MADE_BY_RUN = (
    *(SAMPLES, RECORDINGS, REJECTED, PAIRS, RAMPS, STARTS, TORQUES, MODEL),
    *(DIAGNOSIS, EXTENDED, SCHEDULE, EVALUATION, REPORT),
)
"""Files, and the folder of the report, that the whole chain makes."""

_MADE_BY = {
    "samples": "ingest LOGS",
    "recordings": "ingest LOGS",
    "rejected": "ingest LOGS",
    "pairs": "pair",
    "ramps": "pair",
    "starts": "pair",
    "torques": "separate",
    "schedule": "simulate",
    "evaluation": "evaluate",
    "challenge": "challenge LOGS",
}


def missing_text(path: Path) -> str:
    """Return the text that a table is missing, with the command that makes it.

    Examples
    --------
    >>> missing_text(Path("run/pairs.parquet"))
    "run/pairs.parquet is missing; make it with 'frictioncli pair -w run'"
    """
    command = _MADE_BY.get(path.stem, path.stem)
    return f"{path} is missing; make it with 'frictioncli {command} -w {path.parent}'"
