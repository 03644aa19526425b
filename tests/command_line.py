"""The command line in this process."""

import os
import subprocess
import sys
from contextlib import chdir, redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from unittest.mock import patch

from typer.testing import CliRunner, Result  # noqa: TID251

from frictioncli.cli import main
from frictioncli.cli.commands import app


def invoke(*words: object) -> Result:
    """Call a command; faults of the input are raised as they are in the library."""
    return CliRunner().invoke(app, [str(word) for word in words], catch_exceptions=False)


def called(*words: object, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    """Call the program as a user would, but without a process of its own."""
    arguments = ["frictioncli", *map(str, words)]
    output, errors, status = StringIO(), StringIO(), 0
    with (
        chdir(cwd or Path.cwd()),
        patch.dict(os.environ),
        patch.object(sys, "argv", arguments),
        redirect_stdout(output),
        redirect_stderr(errors),
    ):
        try:
            main()
        except SystemExit as ended:
            status = int(ended.code or 0)
    return subprocess.CompletedProcess(arguments, status, output.getvalue(), errors.getvalue())
