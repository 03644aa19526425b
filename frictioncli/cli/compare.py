"""The command that compares runs of a joint on different days."""

from pathlib import Path
from typing import Annotated

import typer

from frictioncli.cli.terminal import say
from frictioncli.comparison.settings import ComparisonSettings, threshold_of

_DEFAULTS = ComparisonSettings()


def compare(
    runs: Annotated[
        list[Path],
        typer.Argument(
            help="Work folders of the same joint on different days; each may hold several runs."
            " Without dates in the logs they follow each other as named here.",
            metavar="RUN...",
        ),
    ],
    out: Annotated[
        Path,
        typer.Option("-w", "--work", metavar="OUT", help="Folder for comparison.json and trend."),
    ] = Path("friction-comparison"),
    joint: Annotated[
        int | None, typer.Option(help="Joint, from 1; needed where folders share several.")
    ] = _DEFAULTS.joint,
    day_to_day: Annotated[
        float,
        typer.Option(
            help="Assumed standard deviation of friction from day to day without any change [%]."
        ),
    ] = _DEFAULTS.day_to_day,
    fail_above: Annotated[
        str | None,
        typer.Option(
            metavar="X",
            help="Exit with 3 if friction has changed, up or down, by more: 3% of the mean"
            " friction, or 1.5 in the unit of torque [N·m or A].",
        ),
    ] = None,
) -> None:
    """Say what changed in a joint between runs. Friction in N·m (or A) and %, °C, deg/s."""
    settings = ComparisonSettings(
        joint=joint,
        day_to_day=day_to_day,
        fail_above=None if fail_above is None else threshold_of(fail_above),
    )
    from frictioncli.stages.compare import above_threshold
    from frictioncli.stages.compare import compare as compare_stage

    say(compare_stage(runs, out, settings))
    if above_threshold(out):
        raise typer.Exit(3)
