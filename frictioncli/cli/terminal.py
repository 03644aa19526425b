"""Printing on the terminal, with control characters from logs replaced."""

import io
import sys

import typer

from frictioncli.plain_text import without_control_characters


def say(what: object, *, fault: bool = False) -> None:
    """Print something, on stderr if it is a fault."""
    stream = sys.stderr if fault else sys.stdout
    if isinstance(stream, io.TextIOWrapper):
        # characters missing from the terminal's encoding are written as escapes
        stream.reconfigure(errors="backslashreplace")
    typer.echo(without_control_characters(str(what)), err=fault)
