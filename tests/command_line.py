"""The command line in this process."""

from typer.testing import CliRunner, Result  # noqa: TID251

from frictioncli.cli.commands import app


def invoke(*words: object) -> Result:
    """Call a command; faults of the input are raised as they are in the library."""
    return CliRunner().invoke(app, [str(word) for word in words], catch_exceptions=False)
