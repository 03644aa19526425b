"""Settings of a fleet: who does the work, and what is done again."""

from dataclasses import dataclass, field

from frictioncli.errors import OptionError
from frictioncli.options import option

ATTEMPTS = 3
"""How often a joint is tried whose worker process dies, before it counts as failed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FleetSettings:
    """Where the joints are processed, and what is left out.

    Attributes
    ----------
    workers : int or None
        Processes on this machine; None: one per processor.
    scheduler : str or None
        Address of a Dask scheduler whose workers are used instead.
    redo : bool
        Whether joints that are unchanged are processed again.
    report : bool
        Whether each joint gets a report.
    """

    workers: int | None = field(
        default=None, metadata=option("Processes on this machine; one per processor.")
    )
    scheduler: str | None = field(
        default=None,
        metadata=option(
            "Dask scheduler whose workers do it, as tcp://host:8786.", metavar="ADDRESS"
        ),
    )
    redo: bool = field(default=False, metadata=option("Do joints again that are done."))
    report: bool = field(default=True, metadata=option("Write a page per joint."))

    def __post_init__(self) -> None:
        if self.workers is not None and self.workers < 1:
            raise OptionError(f"--workers {self.workers}: expected 1 or more")
        if self.workers is not None and self.scheduler is not None:
            raise OptionError(
                "--workers and --scheduler exclude each other: a cluster has its own workers"
            )
