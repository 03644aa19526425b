"""Processing of all joints of a fleet, and the table of their results."""

import os
import textwrap
from collections import Counter
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import AbstractContextManager, closing, nullcontext
from dataclasses import dataclass, field, replace
from itertools import islice
from pathlib import Path
from urllib.parse import quote

import pyarrow as pa

from frictioncli import schemas
from frictioncli.errors import OptionError
from frictioncli.files import write_text
from frictioncli.fleet.cluster import run_on_cluster
from frictioncli.fleet.joint import (
    DONE,
    FAILED,
    UNCHANGED,
    JointOutcome,
    JointTask,
    settings_document,
)
from frictioncli.fleet.joint_logs import JointLogs, find_joints
from frictioncli.fleet.joint_record import check_folder, read_row
from frictioncli.fleet.local_processes import run_locally
from frictioncli.fleet.settings import FleetSettings
from frictioncli.provenance import Provenance, sha256
from frictioncli.report.fleet_page import fleet_html
from frictioncli.stages.settings import RunSettings
from frictioncli.tables import TableWriter
from frictioncli.workfolder import locked

FLEET = "fleet.parquet"
PAGE = "fleet.html"

Progress = Callable[[Iterator[JointOutcome], int], AbstractContextManager[Iterable[JointOutcome]]]
"""Wraps the outcomes and their number, as a progress bar does."""

_ROWS_PER_BATCH = 1000
_MOST_FAILURES = 20
_MOST_CHARACTERS = 300


@dataclass(slots=True)
class FleetSummary:
    """Counts of the outcomes; the command prints it.

    Attributes
    ----------
    path : Path
        Table of the fleet.
    joints : int
        Number of joints.
    status, verdicts : Counter
        Number of joints by status, and by verdict of the diagnosis.
    failures : list of str
        First failed joints with a shortened reason; the table has the full one.
    seconds : float
        Processing time of all joints together. [s]
    """

    path: Path
    joints: int
    status: Counter[str] = field(default_factory=Counter)
    verdicts: Counter[str] = field(default_factory=Counter)
    failures: list[str] = field(default_factory=list)
    seconds: float = 0.0

    def add(self, outcome: JointOutcome) -> None:
        """Count an outcome."""
        self.status[outcome.status] += 1
        self.seconds += outcome.seconds
        if outcome.verdict is not None:
            self.verdicts[outcome.verdict] += 1
        if outcome.status == FAILED and len(self.failures) < _MOST_FAILURES:
            reason = textwrap.shorten(outcome.message, _MOST_CHARACTERS, placeholder=" ...")
            self.failures.append(f"robot {outcome.robot}, joint {outcome.joint}: {reason}")

    def __str__(self) -> str:
        unchanged = self.status[UNCHANGED]
        lines = [
            f"joints    {self.joints}: {self.status[DONE] + unchanged} done"
            + (f" ({unchanged} of them before, unchanged)" if unchanged else "")
            + f", {self.status[FAILED]} failed; {self.seconds:,.0f} s of work"
        ]
        if self.verdicts:
            counts = [f"{count} {verdict}" for verdict, count in sorted(self.verdicts.items())]
            rest = self.joints - self.status[FAILED] - sum(self.verdicts.values())
            if rest:
                counts.append(f"{rest} not diagnosed: see left_out in {self.path.name}")
            lines.append(f"verdicts  {', '.join(counts)}")
        lines += [f"failed    {text}" for text in sorted(self.failures)]
        if self.status[FAILED] > len(self.failures):
            more = self.status[FAILED] - len(self.failures)
            lines.append(f"          and {more} more: see status and message in {self.path.name}")
        page = self.path.with_name(PAGE)
        return "\n".join([*lines, f"table     {self.path}", f"page      {page}"])


def run_fleet(
    fleet: Path,
    out: Path,
    settings: RunSettings | None = None,
    options: FleetSettings | None = None,
    progress: Progress = lambda outcomes, joints: nullcontext(outcomes),
) -> FleetSummary:
    """Run the chain for each joint of a fleet, and write ``fleet.parquet`` and ``fleet.html``.

    Parameters
    ----------
    fleet : Path
        Folder or table of contents, see :func:`frictioncli.fleet.joint_logs.find_joints`.
    out : Path
        Folder for the table and for one work folder ``robot=R/joint=J`` per joint.
    settings : RunSettings, optional
        Settings of the stages for all joints.
    options : FleetSettings, optional
        Where the joints are processed.
    progress : callable, optional
        Wraps the outcomes, given them and the number of joints.

    Returns
    -------
    FleetSummary
        Counts of the outcomes.

    Raises
    ------
    FrictionError
        If the folders or the table of contents are wrong, or ``out`` cannot be used. A fault of a
        joint is no error: it is in the row of the joint.
    """
    settings = settings or RunSettings()
    options = options or FleetSettings()
    options.certificates()
    # workers may have another current folder
    fleet, out = fleet.absolute(), out.absolute()
    if settings.ingest.map_file is not None:
        map_file = settings.ingest.map_file.absolute()
        settings = replace(settings, ingest=replace(settings.ingest, map_file=map_file))
    tasks = [
        JointTask(
            logs=logs,
            work=out / logs.subfolder,
            settings=settings,
            report=options.report,
            redo=options.redo,
        )
        for logs in find_joints(fleet)
    ]
    _check_table(fleet, out)
    for task in tasks:
        check_folder(task.work)
        _check_logs(task.logs, task.work)
    summary = FleetSummary(path=out / FLEET, joints=len(tasks))
    with locked(out):
        with (
            closing(_outcomes(tasks, options)) as done,
            progress(done, len(tasks)) as outcomes,
        ):
            for outcome in outcomes:
                summary.add(outcome)
        inputs = {fleet.name: sha256(fleet)} if fleet.is_file() else {}
        document = settings_document(settings, report=options.report)
        provenance = Provenance("fleet", document, inputs)
        _write_table(summary.path, tasks, provenance)
        _write_page(out, tasks)
    return summary


def has_failed(summary: FleetSummary) -> bool:
    """Return whether a joint of a fleet has failed."""
    return summary.status[FAILED] > 0


def _check_table(fleet: Path, out: Path) -> None:
    """Raise if the table of contents is in the place of an output."""
    if os.path.realpath(fleet) in map(os.path.realpath, (out / FLEET, out / PAGE)):
        raise OptionError(
            f"{fleet}: the table of contents has the place of an output of this fleet; rename it,"
            " or choose another folder with -w"
        )


def _check_logs(logs: JointLogs, work: Path) -> None:
    """Raise if logs lie where the outputs of their joint go, or the outputs among the logs."""
    place = Path(os.path.realpath(work))
    runs = [path for _, path in logs.run_paths]
    runs += [] if logs.folder is None else logs.folder.glob("run=*")
    for path in runs:
        if place.is_relative_to(os.path.realpath(path)):
            raise OptionError(
                f"{work}: lies in {path}, all of which are logs of a run; choose another folder"
                " with -w"
            )
    named = (logs.folder, logs.map_file, *(path for _, path in logs.run_paths))
    for path in filter(None, named):
        if Path(os.path.realpath(path)).is_relative_to(place):
            raise OptionError(
                f"{path}: lies in the folder of this joint's results, {work}; expected logs"
                " elsewhere: choose another folder with -w"
            )


def _outcomes(
    tasks: list[JointTask], options: FleetSettings
) -> Generator[JointOutcome, None, None]:
    """Return the outcomes, from the cluster or from processes of this machine."""
    if options.scheduler is not None:
        return run_on_cluster(tasks, options.scheduler, options.timeout, options.certificates())
    workers = min(options.workers or os.cpu_count() or 1, len(tasks))
    return run_locally(tasks, workers, options.timeout)


def _write_page(out: Path, tasks: list[JointTask]) -> None:
    """Write the page of the fleet, with a link to each joint's report."""
    rows = [read_row(task.work) for task in tasks]
    pages = [task.work / "report" / "index.html" for task in tasks]
    addresses = [
        quote(os.fsencode(page.relative_to(out).as_posix()), safe="/=") if page.exists() else ""
        for page in pages
    ]
    write_text(out / PAGE, fleet_html(rows, addresses))


def _write_table(path: Path, tasks: list[JointTask], provenance: Provenance) -> None:
    """Write the rows of all joints in their order, in batches."""
    schema = pa.schema([(column.name, column.type) for column in schemas.FLEET.columns])
    works = (task.work for task in tasks)
    with TableWriter(path, schemas.FLEET, provenance) as writer:
        while rows := [read_row(work) for work in islice(works, _ROWS_PER_BATCH)]:
            writer.write(pa.Table.from_pylist(rows, schema=schema))
