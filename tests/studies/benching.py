"""The harness of ``make bench``: contestants at the same work, in rounds that take turns.

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

Every round runs every contestant once, in turning order. Ratios are taken inside a round, then
their median and range are told: speed that changes between rounds changes both sides. Rows stay in
``build/bench``; those of an older state of the package are not used again.
"""

import hashlib
import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

from tests.studies.bench_call import RESULT

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "frictioncli"
STORE = ROOT / "build" / "bench"
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


@dataclass(frozen=True, slots=True)
class Measured:
    """What is known of a work.

    Attributes
    ----------
    rounds : list of dict
        The runs of each round whose results agreed, by contestant.
    agreed : str
        What the check found equal.
    faults : list of str
        What was wrong in the other rounds.
    load : float
        Median number of processes that wanted to run just before a round: 0 on an idle machine.
    """

    rounds: list[dict[str, Run]]
    agreed: str
    faults: list[str]
    load: float

    def figures(self, goal: Goal) -> tuple[float, float, float]:
        """Return median, least and greatest figure over the rounds."""
        values = [goal.figure(runs) for runs in self.rounds]
        return statistics.median(values), min(values), max(values)

    def median(self, contestant: str, measure: str) -> float:
        """Return a contestant's median ``wall``, ``cpu`` or ``peak``."""
        return statistics.median(getattr(runs[contestant], measure) for runs in self.rounds)


def measure(work: Work, *, rounds: int, store: Path = STORE, data: Path | None = None) -> Measured:
    """Run the rounds of a work that are not stored yet, and return all of them.

    Parameters
    ----------
    work : Work
        The work.
    rounds : int
        Number of rounds wanted; those that ended in a fault are run again.
    store : Path
        Folder of the rows.
    data : Path, optional
        Folder in which inputs are made, each in a folder of its work's name.
    """
    folder = (data or store / "data") / work.name
    rows = [row for row in _rows(work, store) if not row["fault"]]
    if len(rows) < rounds:
        _prepared(work, folder)
    store.mkdir(parents=True, exist_ok=True)
    with (store / f"{work.name}.jsonl").open("w", encoding="utf-8") as stream:
        for row in rows:
            stream.write(json.dumps(row) + "\n")
        for number in range(len(rows), rounds):
            row = _round(work, folder, number)
            stream.write(json.dumps(row) + "\n")
            stream.flush()
    return stored(work, store)


def stored(work: Work, store: Path = STORE) -> Measured:
    """Return what is stored of a work for the present package; it may be nothing."""
    rows = _rows(work, store)
    return Measured(
        rounds=[
            {name: Run(**run) for name, run in row["runs"].items()}
            for row in rows
            if not row["fault"]
        ],
        agreed=next((row["agreed"] for row in rows if row["agreed"]), ""),
        faults=[row["fault"] for row in rows if row["fault"]],
        load=statistics.median([row["load"] for row in rows] or [0.0]),
    )


def _rows(work: Work, store: Path) -> list[dict]:
    path = store / f"{work.name}.jsonl"
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    names = {contestant.name for contestant in work.contestants}
    rows = [json.loads(line) for line in lines]
    return [
        row
        for row in rows
        if row["state"] == state(*work.sources) and set(row["contestants"]) == names
    ]


@cache
def state(*sources: str) -> str:
    """Return a digest of files and folders of the package: other states' measures do not count."""
    places = [PACKAGE / source for source in sources]
    files = [file for place in places for file in (sorted(place.rglob("*.py")) or [place])]
    return hashlib.sha256(b"\0".join(file.read_bytes() for file in files)).hexdigest()[:12]


def _prepared(work: Work, folder: Path) -> None:
    """Make the input unless it is there whole."""
    mark = folder / ".prepared"
    if mark.exists():
        return
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    work.prepare(folder)
    mark.touch()


def _round(work: Work, data: Path, number: int) -> dict:
    """Run every contestant once, the first one a place later in each round; check; clean up."""
    turn = number % len(work.contestants)
    order = [*work.contestants[turn:], *work.contestants[:turn]]
    load = os.getloadavg()[0]
    agreed = fault = ""
    runs: dict[str, Run] = {}
    with tempfile.TemporaryDirectory(dir=data, prefix=".out-") as box:
        try:
            for contestant in order:
                out = Path(box) / f"{len(runs)}"
                out.mkdir()
                runs[contestant.name] = measured_run(contestant, data, out)
            agreed = work.check(runs)
        except Disagreement as found:
            fault = str(found)
    return {
        "state": state(*work.sources),
        "contestants": [contestant.name for contestant in work.contestants],
        "runs": {
            name: {"wall": run.wall, "cpu": run.cpu, "peak": run.peak, "result": run.result}
            for name, run in runs.items()
        },
        "agreed": agreed,
        "fault": fault,
        "load": load,
    }


def measured_run(contestant: Contestant, data: Path, out: Path) -> Run:
    """Run a contestant once in processes of its own.

    Raises
    ------
    Disagreement
        If its exit status is another than it must be.
    """
    places = {
        "{python}": sys.executable,
        "{frictioncli}": str(Path(sys.executable).with_name("frictioncli")),
        "{data}": str(data),
        "{out}": str(out),
    }
    words = list(contestant.words)
    for mark, place in places.items():
        words = [word.replace(mark, place) for word in words]
    report = out / "measures.json"
    starter = [sys.executable, "-I", "-S", str(Path(__file__).with_name("bench_process.py"))]
    with (
        (out / "stdout.txt").open("wb") as told,
        (out / "stderr.txt").open("wb") as complained,
    ):
        subprocess.run(
            [*starter, str(report), *words], cwd=ROOT, stdout=told, stderr=complained, check=False
        )
    if not report.exists():
        raise Disagreement(f"{contestant.name}: could not be started: {contestant.shown}")
    measures = json.loads(report.read_text(encoding="utf-8"))
    status = measures.pop("status")
    if status != contestant.status:
        last = (out / "stderr.txt").read_text(encoding="utf-8", errors="replace").strip()[-300:]
        raise Disagreement(f"{contestant.name}: ended with {status}: {last}")
    result = out / RESULT
    own = json.loads(result.read_text(encoding="utf-8")) if result.exists() else {}
    return Run(**(measures | own), out=out)
