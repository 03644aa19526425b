"""The rounds of ``make bench``: every contestant in turn, in processes of their own.

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
from dataclasses import dataclass
from functools import cache
from itertools import chain
from pathlib import Path

from tests.studies.bench_call import RESULT
from tests.studies.benching import Contestant, Disagreement, Goal, Run, Work

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "frictioncli"
STORE = ROOT / "build" / "bench"


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
    files = [file for source in sources for file in _sources(PACKAGE / source)]
    return hashlib.sha256(b"\0".join(file.read_bytes() for file in files)).hexdigest()[:12]


def _sources(place: Path) -> list[Path]:
    """Return a file, or all of a folder that runs."""
    return sorted(chain(place.rglob("*.py"), place.rglob("*.c"))) or [place]


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
