"""What all stages share: what is done before and after, and what comes out."""

import functools
import inspect
from collections.abc import Callable
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import ParamSpec

from frictioncli.workfolder import locked, outdated


@dataclass(frozen=True, slots=True)
class Done:
    """What a stage made, and what it has to say about it."""

    path: Path
    text: str

    def __str__(self) -> str:
        return self.text

    def _repr_html_(self) -> str:
        """Return the text as it is, for notebooks."""
        return f"<pre>{escape(self.text)}</pre>"


_Arguments = ParamSpec("_Arguments")


def stage(work_on: Callable[_Arguments, Done]) -> Callable[_Arguments, Done]:
    """Let a stage have its work folder to itself, and say which of its inputs are out of date."""
    signature = inspect.signature(work_on)

    @functools.wraps(work_on)
    def alone_with_its_folder(*args: _Arguments.args, **kwargs: _Arguments.kwargs) -> Done:
        work: Path = signature.bind(*args, **kwargs).arguments["work"]
        with locked(work):
            done = work_on(*args, **kwargs)
            # a page shows all tables of its folder
            used = [done.path] if done.path.parent == work else sorted(work.iterdir())
            warnings = [f"warning: {text}" for text in outdated(used)]
        return Done(done.path, "\n".join([*warnings, done.text]))

    return alone_with_its_folder


def present(*paths: Path) -> list[Path]:
    """Return the inputs that a work folder has; those of older versions lack some."""
    return [path for path in paths if path.exists()]
