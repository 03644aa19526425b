"""The stages on a work folder: each reads the tables of the one before and writes its own.

Every function here is a command of the same name; what it returns prints as that command's output.
All of them one after the other: :mod:`frictioncli.pipeline`.

A stage is imported when it is first asked for: reading logs then needs no scipy and begins without
pandas, which saves more than half a second and 60 MB.
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
    from frictioncli.chain.comparing import above_threshold, compare
    from frictioncli.chain.correcting import evaluate, simulate
    from frictioncli.chain.deploying import deployed, export
    from frictioncli.chain.modelling import diagnose, fit, has_finding
    from frictioncli.chain.planning import plan, plan_new
    from frictioncli.chain.reading import ingest
    from frictioncli.chain.separating import pair, separate
    from frictioncli.chain.showing import report

_STAGES = {
    "ingest": "reading",
    "pair": "separating",
    "separate": "separating",
    "fit": "modelling",
    "diagnose": "modelling",
    "has_finding": "modelling",
    "simulate": "correcting",
    "evaluate": "correcting",
    "report": "showing",
    "plan": "planning",
    "plan_new": "planning",
    "export": "deploying",
    "deployed": "deploying",
    "compare": "comparing",
    "above_threshold": "comparing",
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
    "above_threshold",
    "compare",
    "deployed",
    "diagnose",
    "evaluate",
    "export",
    "fit",
    "has_finding",
    "ingest",
    "pair",
    "plan",
    "plan_new",
    "report",
    "separate",
    "simulate",
]


def __getattr__(name: str) -> Any:
    if name not in _STAGES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_STAGES[name]}"), name)
