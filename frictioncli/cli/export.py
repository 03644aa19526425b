"""The command that writes a model for controllers, simulators and tables."""

from typing import Annotated

import typer

from frictioncli.cli import options as o
from frictioncli.cli.terminal import say
from frictioncli.deployment.settings import TARGETS, ExportSettings

_DEFAULTS = ExportSettings(to="json")
_FORM, _CORRECT = "Simpler forms (urdf, mjcf, csv)", "Correction (c, json)"

To = Annotated[str, typer.Option("--to", help=f"Form of the file: {', '.join(TARGETS)}.")]
Joint = Annotated[
    int | None, typer.Option(help="Joint, from 1; needed where the model has several.")
]
Extended = Annotated[
    bool,
    typer.Option(
        "--extended",
        help="Carry extended-model.json: the gear's temperature and effects without memory.",
        rich_help_panel=_CORRECT,
    ),
]
Criterion = Annotated[
    str,
    typer.Option(help="When to correct: first_degree, latest_degree.", rich_help_panel=_CORRECT),
]
Temperature = Annotated[
    float | None,
    typer.Option(
        help="Where the form must fit best [°C]; the middle of the data.", rich_help_panel=_FORM
    ),
]
Load = Annotated[
    float | None,
    typer.Option(
        help="As --temperature, load [N·m]; the root mean square over the data's range.",
        rich_help_panel=_FORM,
    ),
]
Lowest = Annotated[
    float | None,
    typer.Option(help="Lowest speed to fit [deg/s]; that of the data.", rich_help_panel=_FORM),
]
Highest = Annotated[
    float | None,
    typer.Option(help="Highest speed to fit [deg/s]; that of the data.", rich_help_panel=_FORM),
]
Tolerance = Annotated[
    float | None,
    typer.Option(
        help="csv: greatest error of linear interpolation [torque unit]; 1/1000 of the friction.",
        rich_help_panel=_FORM,
    ),
]
TorqueConstant = Annotated[
    float | None,
    typer.Option(
        help="urdf, mjcf: torque at the joint per unit of the log's torque [N·m/A].",
        rich_help_panel=_FORM,
    ),
]


def export(
    to: To,
    work: o.Work = o.WORK,
    joint: Joint = None,
    extended: Extended = False,
    criterion: Criterion = _DEFAULTS.criterion,
    k: o.K = o.SCHEDULE.k,
    tmax: o.TMax = o.SCHEDULE.tmax / 60,
    temperature: Temperature = None,
    load: Load = None,
    lowest: Lowest = None,
    highest: Highest = None,
    tolerance: Tolerance = None,
    torque_constant: TorqueConstant = None,
) -> None:
    """Write the model as C, URDF, MJCF, JSON or a table (N·m or A, deg/s, °C); say what is lost."""
    settings = o.chosen(ExportSettings, locals() | {"tmax": tmax * 60})
    from frictioncli.stages.export import export as export_stage

    say(export_stage(work, settings))
