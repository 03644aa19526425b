"""Decorator and result of the stages."""

import functools
import inspect
from collections.abc import Callable
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import ParamSpec

from threadpoolctl import threadpool_limits

from frictioncli.files import is_there
from frictioncli.workfolder import locked, outdated


@dataclass(frozen=True, slots=True)
class StageResult:
    """Output of a stage.

    Attributes
    ----------
    path : Path
        File that the stage has written.
    text : str
        Summary that the command prints.
    """

    path: Path
    text: str

    def __str__(self) -> str:
        return self.text

    def _repr_html_(self) -> str:
        """Return the text with its line breaks, for notebooks."""
        return f"<pre>{escape(self.text)}</pre>"


_Arguments = ParamSpec("_Arguments")


def stage(function: Callable[_Arguments, StageResult]) -> Callable[_Arguments, StageResult]:
    """Return a stage that locks its work folder, and warns of outdated inputs.

    Linear algebra uses one thread, as in a call of the command.

    Parameters
    ----------
    function : callable
        The stage; its parameter ``work`` is the work folder.
    """
    signature = inspect.signature(function)

    @functools.wraps(function)
    def locked_stage(*args: _Arguments.args, **kwargs: _Arguments.kwargs) -> StageResult:
        work: Path = signature.bind(*args, **kwargs).arguments["work"]
        # matrices here are small: more threads cost more than they give, and change last digits
        with locked(work), threadpool_limits(1):
            result = function(*args, **kwargs)
            # the report shows all tables of its folder
            outputs = [result.path] if result.path.parent == work else sorted(work.iterdir())
            warnings = [f"warning: {text}" for text in outdated(outputs)]
        return StageResult(result.path, "\n".join([*warnings, result.text]))

    return locked_stage


def existing(*paths: Path) -> list[Path]:
    """Return the paths that exist; work folders of older versions lack some."""
    return [path for path in paths if is_there(path)]
