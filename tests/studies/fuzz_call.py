"""The program called in this process, and the options of its commands."""

import functools
import os
import sys
import traceback
import warnings
from collections.abc import Iterator
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from unittest.mock import patch

from frictioncli.fleet.joint import JointOutcome, JointTask, run_joint


def call(words: list[str]) -> tuple[int | str, str]:
    """Return the exit status of a call and what it said; ``traceback`` or ``memory`` for faults.

    What libraries write past Python counts too: it reaches the terminal of the user.
    """
    from frictioncli.cli import main

    output, errors, status = StringIO(), StringIO(), 0
    with (
        patch.object(sys, "argv", ["frictioncli", *words]),
        patch.object(sys, "warnoptions", ["error"]),
        patch("frictioncli.fleet.fleet.run_locally", _in_this_process),
        redirect_stdout(output),
        redirect_stderr(errors),
        warnings.catch_warnings(),
        _terminal() as past,
    ):
        warnings.simplefilter("error")
        try:
            main()
        except SystemExit as ended:
            status = ended.code if ended.code is not None else 0
        except MemoryError:
            return "memory", traceback.format_exc()[-1500:]
        except BaseException:
            return "traceback", traceback.format_exc()[-1500:]
    said = output.getvalue() + errors.getvalue()
    if "Traceback" in said or "Warning" in errors.getvalue():
        return "traceback", said[-1500:]
    if status == 2 and "the memory or the threads" in said:
        return "memory", said
    if past():
        return "past the program", past()[-1500:]
    return status, errors.getvalue() if status == 2 else said


def _in_this_process(
    tasks: list[JointTask], workers: int, timeout: float | None = None
) -> Iterator[JointOutcome]:
    yield from map(run_joint, tasks)


class _terminal:
    """Collects what is written to the file descriptors of output and errors."""

    def __enter__(self):
        import tempfile

        self._file = tempfile.TemporaryFile()
        self._kept = [(number, os.dup(number)) for number in (1, 2)]
        for number, _ in self._kept:
            os.dup2(self._file.fileno(), number)
        return lambda: self._text

    def __exit__(self, *_):
        for number, kept in self._kept:
            os.dup2(kept, number)
            os.close(kept)
        self._file.seek(0)
        self._text = self._file.read().decode("utf-8", "replace")
        self._file.close()


@functools.cache
def commands() -> dict[str, dict[str, bool]]:
    """Return command -> its options, each with whether it is a flag."""
    from typer.main import get_command  # noqa: TID251

    from frictioncli.cli.commands import app

    group = get_command(app)
    return {
        name: {
            option: bool(parameter.is_flag)
            for parameter in command.params
            if parameter.param_type_name == "option"
            for option in parameter.opts
        }
        for name, command in group.commands.items()
    }
