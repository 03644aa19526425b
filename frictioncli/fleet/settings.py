"""What the user can choose of a fleet beyond the chain of a joint."""

from dataclasses import dataclass

from frictioncli.errors import OptionError

ATTEMPTS = 3
"""How often a joint is begun whose worker process dies, before it counts as failed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FleetSettings:
    """Where joints are worked on, and what is left out.

    Attributes
    ----------
    workers : int or None
        Processes on this machine; one per processor if none.
    scheduler : str or None
        Address of a Dask scheduler whose workers do it instead.
    redo : bool
        Whether joints that are done already are done again.
    report : bool
        Whether each joint gets a report.
    """

    workers: int | None = None
    scheduler: str | None = None
    redo: bool = False
    report: bool = True

    def __post_init__(self) -> None:
        if self.workers is not None and self.workers < 1:
            raise OptionError(f"--workers {self.workers}: expected 1 or more")
        if self.workers is not None and self.scheduler is not None:
            raise OptionError(
                "--workers and --scheduler exclude each other: a cluster has its own workers"
            )
