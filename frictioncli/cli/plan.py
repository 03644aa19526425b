"""The command for the next experiment."""

from typing import Annotated

import typer

from frictioncli.cli import options as o
from frictioncli.cli.terminal import say
from frictioncli.design.settings import PROGRAMS, PlanSettings

PLAN = PlanSettings()
_LIMITS, _PROGRAM = "Limits", "Program"


def plan(
    work: o.Work = o.WORK,
    minutes: Annotated[
        float, typer.Option(help="Time for all of it, the check on the next day included [min].")
    ] = PLAN.minutes,
    joint: Annotated[
        int | None,
        typer.Option("--joint", "--axis", help="Joint to plan for, from 1; that with most pairs."),
    ] = None,
    new: Annotated[
        bool,
        typer.Option("--new", help="Without data: Algorithms 1 and 2 of the paper, for any axis."),
    ] = False,
    seed: Annotated[int, typer.Option(help="Seed of the random order of speeds.")] = PLAN.seed,
    low: Annotated[
        float | None,
        typer.Option("--from", help="Lowest angle [deg]; as measured.", rich_help_panel=_LIMITS),
    ] = None,
    high: Annotated[
        float | None,
        typer.Option(
            "--to-angle", help="Highest angle [deg]; as measured.", rich_help_panel=_LIMITS
        ),
    ] = None,
    max_speed: Annotated[
        float | None,
        typer.Option(help="Highest speed [deg/s]; as measured.", rich_help_panel=_LIMITS),
    ] = None,
    max_temperature: Annotated[
        float | None,
        typer.Option(
            help="Motor temperature at which heating ends [°C]; as measured, at least 65.",
            rich_help_panel=_LIMITS,
        ),
    ] = None,
    payload: Annotated[
        list[float] | None,
        typer.Option(help="Payload that may be mounted [kg], repeatable.", rich_help_panel=_LIMITS),
    ] = None,
    to: Annotated[
        str,
        typer.Option(help=f"Robot program: {', '.join(PROGRAMS)}.", rich_help_panel=_PROGRAM),
    ] = PLAN.to,
    rated_speed: Annotated[
        float | None,
        typer.Option(
            help="Speed of the axis at 100 % [deg/s]; KUKA programs need it.",
            rich_help_panel=_PROGRAM,
        ),
    ] = None,
) -> None:
    """Plan the next experiment [min, deg, deg/s, °C]: what it would settle; write its program."""
    settings = o.chosen(PlanSettings, locals())
    from frictioncli.stages.plan import plan as plan_stage
    from frictioncli.stages.plan import plan_new

    say(plan_new(work, settings) if new else plan_stage(work, settings))
