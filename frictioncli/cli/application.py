"""The application that the commands belong to."""

from collections.abc import Callable
from typing import Annotated, Any

import typer

from frictioncli.cli.signature import Command, with_options
from frictioncli.cli.terminal import say

app = typer.Typer(
    name="frictioncli",
    help="Friction of a robot joint from its torque logs. Units: deg, deg/s, s, N·m, °C.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)


def _show_version(wanted: bool) -> None:
    if wanted:
        from frictioncli import __version__

        say(f"frictioncli {__version__}")
        raise typer.Exit


@app.callback()
def _common(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_show_version, is_eager=True, help="Show the version and exit."
        ),
    ] = False,
) -> None:
    """Friction of a robot joint from its torque logs. Units: deg, deg/s, s, N·m, °C."""


def command(**layout: Any) -> Callable[[Command], Command]:
    """Return a decorator that makes a function of settings a command.

    Parameters
    ----------
    **layout
        Options that are left out and their order in the help text, see
        :func:`frictioncli.cli.signature.with_options`.
    """

    def register(function: Command) -> Command:
        app.command()(with_options(function, **layout))
        return function

    return register
