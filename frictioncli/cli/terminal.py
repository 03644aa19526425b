"""Printing on the terminal, with control characters from logs replaced, and progress."""

import io
import os
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from typing import TextIO, TypeVar

import typer

from frictioncli.errors import FrictionError
from frictioncli.plain_text import without_control_characters

_PATIENCE = 2.0
"""Time after which work says that it goes on. [s]"""

_PERIOD = 0.5
"""Time between two updates of the line. [s]"""

_NOBODY_READS = 141
"""Exit status of a program that writes into a pipe which nobody reads any more."""

_CLEAR_LINE = "\r\x1b[K"


def say(what: object, *, fault: bool = False) -> None:
    """Print something, on stderr if it is a fault.

    Raises
    ------
    FrictionError
        If the system does not allow it, as on a full disk.
    SystemExit
        If nobody reads the output any more, as in ``frictioncli run LOGS -w RUN | head -1``.
    """
    stream = sys.stderr if fault else sys.stdout
    if isinstance(stream, io.TextIOWrapper):
        # characters missing from the terminal's encoding are written as escapes
        stream.reconfigure(errors="backslashreplace")
    try:
        typer.echo(without_control_characters(str(what)), err=fault)
    except BrokenPipeError:
        _redirect_to_nowhere(stream)
        raise SystemExit(_NOBODY_READS) from None
    except OSError as error:
        _redirect_to_nowhere(stream)
        if not fault:  # a fault is told by the status alone
            raise FrictionError(f"output cannot be written ({error.strerror or error})") from None


def _redirect_to_nowhere(stream: TextIO) -> None:
    """Drop what is still in the buffer of a stream: Python would try again when it ends."""
    with suppress(OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())
        os.close(nowhere)


def say_result(label: str, call: Callable[[], object]) -> None:
    """Call a function, say on a terminal that it works, and print what it returns."""
    with working(label):
        result = call()
    say(result)


class ProgressLine:
    """A line that says what is being done and since when; rewritten in place.

    Parameters
    ----------
    stream : file
        Where it is written.
    label : str
        What is being done.
    patience : float
        Time before it appears. [s]
    """

    def __init__(self, stream: TextIO, label: str, patience: float = _PATIENCE) -> None:
        self.label = label
        self._stream = stream
        self._patience = patience
        self._start = time.monotonic()
        self._lock = threading.Lock()
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def start(self) -> None:
        """Begin to write the line."""
        self._thread.start()

    def relabel(self, label: str) -> None:
        """Say that something else is being done now."""
        self.label = label

    def end(self) -> None:
        """Remove the line."""
        self._ended.set()
        self._thread.join()
        self._write(_CLEAR_LINE)

    @contextmanager
    def paused(self, label: str) -> Iterator[None]:
        """Remove the line while something else is printed; then go on with another label."""
        with self._lock:
            self._stream.write(_CLEAR_LINE)
            self._stream.flush()
            yield
            self.label = label

    def _run(self) -> None:
        if self._ended.wait(self._patience):
            return
        while True:
            with self._lock:
                seconds = time.monotonic() - self._start
                self._write(f"{_CLEAR_LINE}{self.label} ... {seconds:.0f} s")
            if self._ended.wait(_PERIOD):
                return

    def _write(self, text: str) -> None:
        self._stream.write(text)
        self._stream.flush()


class _NoLine(ProgressLine):
    """Stands for a progress line where the output is no terminal: writes nothing."""

    def start(self) -> None:
        """Write nothing."""

    def end(self) -> None:
        """Write nothing."""

    @contextmanager
    def paused(self, label: str) -> Iterator[None]:
        """Write nothing."""
        self.label = label
        yield


@contextmanager
def working(label: str, patience: float = _PATIENCE) -> Iterator[ProgressLine]:
    """Say on a terminal what is being done, if it takes longer than two seconds.

    Nothing is written where stdout or stderr is no terminal, as in a pipe.

    Parameters
    ----------
    label : str
        What is being done.
    patience : float
        Time before it is said. [s]
    """
    on_terminal = sys.stdout.isatty() and sys.stderr.isatty()
    line = (ProgressLine if on_terminal else _NoLine)(sys.stderr, label, patience)
    line.start()
    try:
        yield line
    finally:
        line.end()


def say_stage(line: ProgressLine, stage: str, result: object) -> None:
    """Print what a stage of a run says, with its name in front."""
    first, *others = str(result).splitlines() or [""]
    with line.paused(f"after {stage}"):
        say(f"{stage:9s} {first}")
        for other in others:
            say(f"{'':9s} {other}")


Outcome = TypeVar("Outcome")


@contextmanager
def counted(outcomes: Iterator[Outcome], joints: int) -> Iterator[Iterable[Outcome]]:
    """Yield outcomes; on a terminal a line says how many joints are done, and for how long."""
    with working(f"fleet: 0 of {joints} joints") as line:

        def counting() -> Iterator[Outcome]:
            for number, outcome in enumerate(outcomes, start=1):
                line.label = f"fleet: {number} of {joints} joints"
                yield outcome

        yield counting()
