"""The command for many joints."""

import sys
from collections.abc import Iterable, Iterator
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from frictioncli.cli import options as o
from frictioncli.cli.terminal import say
from frictioncli.correction.settings import ScheduleSettings
from frictioncli.fleet.settings import FleetSettings
from frictioncli.model.settings import FitSettings

if TYPE_CHECKING:
    from frictioncli.fleet.joint import Outcome

_FLEET = "Fleet"
_INTERRUPTED = 130


def fleet(
    logs: Annotated[
        Path,
        typer.Argument(
            help="Folder with robot=R/joint=J/run=D folders of logs, or a table of contents (CSV,"
            " Parquet) with columns robot, joint, run, path and, if wanted, map, gear_ratio.",
            metavar="FLEET",
        ),
    ],
    out: Annotated[
        Path,
        typer.Option("-w", "--work", metavar="OUT", help="Folder for the table and all joints."),
    ] = Path("friction-fleet"),
    workers: Annotated[
        int | None,
        typer.Option(help="Processes on this machine; one per processor.", rich_help_panel=_FLEET),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS",
            help="Dask scheduler whose workers do it, as tcp://host:8786.",
            rich_help_panel=_FLEET,
        ),
    ] = None,
    redo: Annotated[
        bool, typer.Option("--redo", help="Do joints again that are done.", rich_help_panel=_FLEET)
    ] = False,
    report: Annotated[
        bool,
        typer.Option(
            "--report/--no-report", help="Write a page per joint.", rich_help_panel=_FLEET
        ),
    ] = True,
    diagnosis: Annotated[
        bool,
        typer.Option(
            "--diagnosis/--no-diagnosis", help="Diagnose each joint.", rich_help_panel=_FLEET
        ),
    ] = True,
    map_file: o.Map = None,
    gear_ratio: o.GearRatio = None,
    time_unit: o.TimeUnit = None,
    position_unit: o.PositionUnit = None,
    velocity_unit: o.VelocityUnit = None,
    torque_unit: o.TorqueUnit = None,
    temperature_unit: o.TemperatureUnit = None,
    sign: o.Sign = "auto",
    method: o.Method = o.FIT.method,
    temperature: o.Temperature = o.FIT.temperature,
    k: o.K = o.SCHEDULE.k,
    tmax: o.TMax = o.SCHEDULE.tmax / 60,
) -> None:
    """Run the chain for many joints; one row each in fleet.parquet. N·m (or A), °C, deg/s."""
    from frictioncli.logs.settings import IngestSettings

    options = o.chosen(FleetSettings, locals())
    parts: dict[str, Any] = {
        "ingest": o.chosen(IngestSettings, locals()),
        "sign": o.sign_number(sign),
        "fit": o.chosen(FitSettings, locals()),
        "diagnosis": o.DIAGNOSIS if diagnosis else None,
        "schedule": ScheduleSettings(k=k, tmax=tmax * 60),
    }
    from frictioncli.fleet.fleet import run_fleet
    from frictioncli.stages.run import RunSettings

    settings = RunSettings(**parts)
    try:
        done = run_fleet(logs, out, settings, options, _bar)
    except KeyboardInterrupt:
        say("interrupted; joints that are done stay done: call again to go on", fault=True)
        raise typer.Exit(_INTERRUPTED) from None
    say(done)


def _bar(outcomes: "Iterator[Outcome]", joints: int) -> "AbstractContextManager[Iterable[Outcome]]":
    """Return the outcomes with a progress bar around them, on a terminal only."""
    if not sys.stdout.isatty():
        return nullcontext(outcomes)
    return typer.progressbar(outcomes, length=joints, label="joints")
