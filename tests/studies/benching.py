"""What ``make bench`` compares: contestants at the same work, and goals.

A :class:`Work` has an input that is made once, :class:`Contestant` commands that do the same thing
to it, a check that their results agree, and :class:`Goal` figures. A study is a module with one
function::

    def works(small: bool) -> list[Work]:
        size = 10**5 if small else 10**6
        return [
            Work(
                name="squares",                     # also its file's name
                title="Sum of squares of 1e6 numbers",
                prepare=partial(write_numbers, size=size),       # (data folder) -> None
                contestants=[
                    command("ours", "{frictioncli}", "inspect", "{data}/log.csv"),
                    function("a loop", "tests.studies.bench_squares:loop", times=3),
                ],
                check=same_sum,                     # (dict of Run by name) -> what was found equal
                goals=[faster("ours", "a loop", must=3, reach=5), peak("ours", most=256)],
            )
        ]

and one entry in the list of :mod:`tests.studies.bench`. In words of commands ``{python}`` is the
interpreter, ``{frictioncli}`` the installed command, ``{data}`` the folder of the input, ``{out}``
a folder of the run's own that is removed after the check. A ``function`` is
``(data, out, *arguments) -> act``; its time is that of ``act()``, whose return value (of JSON
types) is the run's result; its memory is that of the whole fresh process, as with commands.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

MEGABYTE = 1e6


class Disagreement(Exception):
    """Contestants do not have the same result, or one of them failed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Contestant:
    """A command that does the work.

    Attributes
    ----------
    name : str
        Its name in the tables.
    words : tuple of str
        The command, with placeholders.
    shown : str
        What the page shows as the command.
    status : int
        Exit status that it must have.
    """

    name: str
    words: tuple[str, ...]
    shown: str
    status: int = 0


def command(name: str, *words: str, shown: str | None = None, status: int = 0) -> Contestant:
    """Return a contestant that is a whole program; ``shown`` replaces its words on the page."""
    text = shown or " ".join(words).replace("{python}", "python")
    return Contestant(
        name=name, words=words, shown=text.replace("{frictioncli}", "frictioncli"), status=status
    )


def function(
    name: str, target: str, *arguments: str, times: int = 1, shown: str | None = None
) -> Contestant:
    """Return a contestant ``module:function`` whose act is timed, median of so many ``times``."""
    words = ("{python}", "-m", "tests.studies.bench_call", target, "{data}", "{out}", str(times))
    text = shown or f"{target.partition(':')[2]}({', '.join(arguments)})"
    return Contestant(name=name, words=(*words, *arguments), shown=text)


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """One contestant's part of one round.

    Attributes
    ----------
    wall, cpu : float
        Time from start to end, and of the processors. [s]
    peak : float
        Greatest memory of the process, or of the largest of its processes. [bytes]
    result : object
        What a function returned, or the file ``result.json`` in the output folder says.
    out : Path or None
        Folder of its outputs, with ``stdout.txt`` and ``stderr.txt``; none once it is only a row.
    """

    wall: float
    cpu: float
    peak: float
    result: object = None
    out: Path | None = None


Round = Mapping[str, Run]
"""The runs of one round by contestant."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Goal:
    """A figure of every round, what its median must be, and what would be better still.

    Attributes
    ----------
    text : str
        What the figure is, with its unit.
    figure : callable
        From a round to the figure.
    must : float
        Least (or greatest) value that will do.
    reach : float or None
        The value to reach for.
    at_most : bool
        Whether small is good.
    """

    text: str
    figure: Callable[[Round], float]
    must: float
    reach: float | None = None
    at_most: bool = False

    def verdict(self, value: float) -> str:
        """Return ``reached``, ``met`` or ``missed``."""

        def good(wanted: float) -> bool:
            return value <= wanted if self.at_most else value >= wanted

        if self.reach is not None and good(self.reach):
            return "reached"
        return "met" if good(self.must) else "missed"


def faster(
    ours: str, other: str, must: float, reach: float | None = None, measure: str = "wall"
) -> Goal:
    """Return the goal of being so many times as fast by ``wall`` or ``cpu`` time."""
    return Goal(
        text=f"{ours}, times as fast as {other}" + ("" if measure == "wall" else " (CPU)"),
        figure=lambda runs: getattr(runs[other], measure) / getattr(runs[ours], measure),
        must=must,
        reach=reach,
    )


def rate(ours: str, amount: float, unit: str, must: float, reach: float | None = None) -> Goal:
    """Return the goal of doing so many units a second."""
    return Goal(
        text=f"{ours}, {unit} a second",
        figure=lambda runs: amount / runs[ours].wall,
        must=must,
        reach=reach,
    )


def peak(ours: str, most: float) -> Goal:
    """Return the goal of needing at most so many megabytes (1e6 bytes)."""
    return Goal(
        text=f"{ours}, peak MB",
        figure=lambda runs: runs[ours].peak / MEGABYTE,
        must=most,
        at_most=True,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Work:
    """The same thing to be done by several contestants; see the module's text.

    ``sources`` are files and folders of the package: once they change, the work is measured again.
    """

    name: str
    title: str
    contestants: Sequence[Contestant]
    goals: Sequence[Goal]
    check: Callable[[Round], str]
    prepare: Callable[[Path], None] = field(default=lambda data: None)
    sources: Sequence[str] = (".",)
