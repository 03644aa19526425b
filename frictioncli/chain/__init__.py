"""The stages on a work folder: each reads the tables of the one before and writes its own.

Every function here is a command of the same name; what it returns prints as that command's output.
All of them one after the other: :mod:`frictioncli.pipeline`.
"""

from frictioncli.chain.correcting import evaluate, simulate
from frictioncli.chain.modelling import DIAGNOSIS, EXTENDED, diagnose, fit, has_finding
from frictioncli.chain.reading import ingest, pair, separate
from frictioncli.chain.showing import report
from frictioncli.chain.stage import (
    EVALUATION,
    MODEL,
    PAIRS,
    RAMPS,
    RECORDINGS,
    SAMPLES,
    SCHEDULE,
    TORQUES,
    Done,
)

__all__ = [
    "DIAGNOSIS",
    "EVALUATION",
    "EXTENDED",
    "MODEL",
    "PAIRS",
    "RAMPS",
    "RECORDINGS",
    "SAMPLES",
    "SCHEDULE",
    "TORQUES",
    "Done",
    "diagnose",
    "evaluate",
    "fit",
    "has_finding",
    "ingest",
    "pair",
    "report",
    "separate",
    "simulate",
]
