"""The stages on a work folder: each reads the tables of the one before and writes its own.

Every function here is a command of the same name; what it returns prints as that command's output.
All of them one after the other: :mod:`frictioncli.pipeline`.

A stage is imported when it is first asked for: reading logs then needs no scipy, which saves half
a second and 60 MB.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from frictioncli.chain.stage import Done
from frictioncli.workfiles import (
    DIAGNOSIS,
    EVALUATION,
    EXTENDED,
    MODEL,
    PAIRS,
    RAMPS,
    RECORDINGS,
    SAMPLES,
    SCHEDULE,
    TORQUES,
)

if TYPE_CHECKING:
    from frictioncli.chain.correcting import evaluate, simulate
    from frictioncli.chain.modelling import diagnose, fit, has_finding
    from frictioncli.chain.reading import ingest, pair, separate
    from frictioncli.chain.showing import report

_STAGES = {
    "ingest": "reading",
    "pair": "reading",
    "separate": "reading",
    "fit": "modelling",
    "diagnose": "modelling",
    "has_finding": "modelling",
    "simulate": "correcting",
    "evaluate": "correcting",
    "report": "showing",
}
"""Function -> module of this package."""

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


def __getattr__(name: str) -> Any:
    if name not in _STAGES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_STAGES[name]}"), name)
