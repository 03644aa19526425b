"""A fleet: every joint on its own, then one table of all."""

import os
import textwrap
from collections import Counter
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import AbstractContextManager, closing, nullcontext
from dataclasses import dataclass, field, replace
from itertools import islice
from pathlib import Path

import pyarrow as pa

from frictioncli import schemas
from frictioncli.fleet.cluster import run_on_cluster
from frictioncli.fleet.joint import (
    DONE,
    FAILED,
    UNCHANGED,
    JointTask,
    Outcome,
    settings_document,
)
from frictioncli.fleet.joint_record import check_own, read_row
from frictioncli.fleet.layout import joints_of
from frictioncli.fleet.local_pool import run_local
from frictioncli.fleet.settings import FleetSettings
from frictioncli.provenance import Provenance, sha256
from frictioncli.stages.settings import RunSettings
from frictioncli.tables import TableWriter
from frictioncli.workfolder import locked

FLEET = "fleet.parquet"

Watch = Callable[[Iterator[Outcome], int], AbstractContextManager[Iterable[Outcome]]]
"""Stands between the outcomes and who counts them, as a progress bar does."""

_ROWS = 1000
_SHOWN = 20
_WIDTH = 300


@dataclass(slots=True)
class FleetSummary:
    """What has been done; it prints as the command's output.

    Attributes
    ----------
    path : Path
        The fleet's table.
    joints : int
        How many there are.
    status, verdicts : Counter
        How many joints have each.
    failures : list of str
        The first few that failed, and why in short; the table has the whole reason.
    seconds : float
        Time that joints took, all together. [s]
    """

    path: Path
    joints: int
    status: Counter[str] = field(default_factory=Counter)
    verdicts: Counter[str] = field(default_factory=Counter)
    failures: list[str] = field(default_factory=list)
    seconds: float = 0.0

    def add(self, outcome: Outcome) -> None:
        """Count an outcome."""
        self.status[outcome.status] += 1
        self.seconds += outcome.seconds
        if outcome.verdict is not None:
            self.verdicts[outcome.verdict] += 1
        if outcome.status == FAILED and len(self.failures) < _SHOWN:
            reason = textwrap.shorten(outcome.message, _WIDTH, placeholder=" ...")
            self.failures.append(f"robot {outcome.robot}, joint {outcome.joint}: {reason}")

    def __str__(self) -> str:
        kept = self.status[UNCHANGED]
        lines = [
            f"joints    {self.joints}: {self.status[DONE] + kept} done"
            + (f" ({kept} of them before, unchanged)" if kept else "")
            + f", {self.status[FAILED]} failed; {self.seconds:,.0f} s of work"
        ]
        if self.verdicts:
            told = ", ".join(
                f"{count} {verdict}" for verdict, count in sorted(self.verdicts.items())
            )
            lines.append(f"verdicts  {told}")
        lines += [f"failed    {text}" for text in sorted(self.failures)]
        if self.status[FAILED] > len(self.failures):
            more = self.status[FAILED] - len(self.failures)
            lines.append(f"          and {more} more: see status and message in {self.path.name}")
        return "\n".join([*lines, f"table     {self.path}"])


def run_fleet(
    fleet: Path,
    out: Path,
    settings: RunSettings | None = None,
    options: FleetSettings | None = None,
    watch: Watch = lambda outcomes, joints: nullcontext(outcomes),
) -> FleetSummary:
    """Run the chain for each joint of a fleet, and write ``fleet.parquet``.

    Parameters
    ----------
    fleet : Path
        Folder or table of contents, see :func:`frictioncli.fleet.layout.joints_of`.
    out : Path
        Gets the table, and a work folder ``robot=R/joint=J`` per joint.
    settings : RunSettings, optional
        Of the stages, for all joints; without any for the diagnosis there is none.
    options : FleetSettings, optional
        Where joints are worked on.
    watch : callable, optional
        Given the outcomes as they come and the number of joints, hands them on.

    Raises
    ------
    FrictionError
        If the layout cannot be followed, or ``out`` cannot be used. What is wrong with a joint is
        no error: it is in its row.
    """
    settings = settings or RunSettings()
    options = options or FleetSettings()
    # workers may stand in another folder
    fleet, out = fleet.absolute(), out.absolute()
    if settings.ingest.map_file is not None:
        chart = settings.ingest.map_file.absolute()
        settings = replace(settings, ingest=replace(settings.ingest, map_file=chart))
    tasks = [
        JointTask(
            logs=logs,
            work=out / logs.place,
            settings=settings,
            report=options.report,
            redo=options.redo,
        )
        for logs in joints_of(fleet)
    ]
    for task in tasks:
        check_own(task.work)
    summary = FleetSummary(path=out / FLEET, joints=len(tasks))
    with locked(out):
        with closing(_outcomes(tasks, options)) as found, watch(found, len(tasks)) as outcomes:
            for outcome in outcomes:
                summary.add(outcome)
        inputs = {fleet.name: sha256(fleet)} if fleet.is_file() else {}
        document = settings_document(settings, report=options.report)
        provenance = Provenance("fleet", document, inputs)
        _write(summary.path, tasks, provenance)
    return summary


def _outcomes(tasks: list[JointTask], options: FleetSettings) -> Generator[Outcome, None, None]:
    if options.scheduler is not None:
        return run_on_cluster(tasks, options.scheduler)
    return run_local(tasks, min(options.workers or os.cpu_count() or 1, len(tasks)))


def _write(path: Path, tasks: list[JointTask], provenance: Provenance) -> None:
    """Gather the rows of all joints, in their order, a bounded number at a time."""
    schema = pa.schema([(column.name, column.type) for column in schemas.FLEET.columns])
    works = (task.work for task in tasks)
    with TableWriter(path, schemas.FLEET, provenance) as writer:
        while rows := [read_row(work) for work in islice(works, _ROWS)]:
            writer.write(pa.Table.from_pylist(rows, schema=schema))
