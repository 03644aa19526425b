"""Settings of a fleet: who does the work, and what is done again."""

import math
from dataclasses import dataclass, field
from pathlib import Path

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
    timeout : float or None
        Time after which a joint has failed; None: no limit. [s]
    tls_ca, tls_cert, tls_key : Path or None
        Files in PEM form for an encrypted connection to the scheduler: certificate of the authority
        that both sides trust, own certificate and its key. None: as Dask is configured.
    redo : bool
        Whether joints that are unchanged are processed again.
    report : bool
        Whether each joint gets a report.
    """

    workers: int | None = field(
        default=None, metadata=option("Processes on this machine; default: one per processor.")
    )
    scheduler: str | None = field(
        default=None,
        metadata=option("Dask scheduler to use, as tls://host:8786.", metavar="ADDRESS"),
    )
    timeout: float | None = field(
        default=None,
        metadata=option(
            "Time limit per joint, after which it counts as failed [s]; default: none."
        ),
    )
    tls_ca: Path | None = field(
        default=None, metadata=option("Certificate authority of the scheduler, PEM.")
    )
    tls_cert: Path | None = field(default=None, metadata=option("Client certificate, PEM."))
    tls_key: Path | None = field(default=None, metadata=option("Key of that certificate, PEM."))
    redo: bool = field(default=False, metadata=option("Process finished joints again."))
    report: bool = field(default=True, metadata=option("Write a report for each joint."))

    def __post_init__(self) -> None:
        if self.workers is not None and self.workers < 1:
            raise OptionError(f"--workers {self.workers}: expected 1 or more")
        if self.workers is not None and self.scheduler is not None:
            raise OptionError(
                "--workers and --scheduler exclude each other: a cluster has its own workers"
            )
        if self.timeout is not None and not 0 < self.timeout < math.inf:
            raise OptionError(f"--timeout {self.timeout:g} s: expected more than 0")

    def certificates(self) -> tuple[Path, ...]:
        """Return the files of TLS, none if they are left to Dask's configuration.

        Raises
        ------
        OptionError
            If some are missing, or there is no scheduler.
        """
        given = [path for path in (self.tls_ca, self.tls_cert, self.tls_key) if path is not None]
        if given and (len(given) < 3 or self.scheduler is None):
            raise OptionError(
                "--tls-ca, --tls-cert and --tls-key: expected all three, and --scheduler"
                " tls://host:8786"
            )
        for path in given:
            if not path.is_file():
                raise OptionError(f"{path}: no such file; expected a file in PEM form")
        return tuple(path.absolute() for path in given)
