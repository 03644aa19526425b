"""Processes that examine damaged inputs under a limit of memory and time."""

import multiprocessing
import os
import resource
import shutil
import tempfile
import time
import traceback
import warnings
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from pathlib import Path

from tests.studies.fuzz_corpus import keep
from tests.studies.fuzz_damage import Case, case
from tests.studies.fuzz_forms import examine
from tests.studies.fuzz_layouts import layouts
from tests.studies.fuzz_truth import contradiction

GOOD = ("read", "refused")
"""Outcomes that are as they should be; every other one is a finding."""

MEMORY = 500
"""What the process may take at most. [MB]"""

_INSPECTED = 16  # one in so many is inspected too, which takes three times as long as reading
_ADDRESSES = 4 << 30
_SECONDS, _WAIT = 120.0, 600.0
"""Processor time that an input may take, and the time on a loaded machine. [s]"""
_PROCESSES = multiprocessing.get_context("forkserver")
_PROCESSES.set_forkserver_preload(["tests.studies.fuzz_process"])
_LAYOUTS = layouts()
# in memory where there is such a folder: waiting for a disk is not what is tried here
_DISK = "/dev/shm" if Path("/dev/shm").is_dir() else None


@dataclass(frozen=True, slots=True)
class Finding:
    """What became of an input, and what there is to say of it."""

    number: int
    layout: str
    damage: str
    outcome: str
    text: str = ""


def examined(
    numbers: Sequence[int], processes: int, form: str = "logs", base: Path | None = None
) -> Iterator[Finding]:
    """Yield what became of each input, as they come.

    A process that takes too long over an input is killed, and so is one that took too much memory.

    Parameters
    ----------
    numbers : sequence of int
        The inputs.
    processes : int
        How many work at a time.
    form : str
        ``logs``, or one of :data:`tests.studies.fuzz_forms.FORMS`.
    base : Path, optional
        What inputs of such a form begin with, see :func:`tests.studies.fuzz_forms.prepare`.
    """
    waiting = iter(numbers)
    workers = [_Worker(waiting, form, base) for _ in range(min(processes, len(numbers)))]
    while workers:
        ready = wait([worker.results for worker in workers], timeout=10.0)
        for worker in list(workers):
            found = worker.take() if worker.results in ready else worker.late()
            if found is not None:
                yield found
                if not worker.next():
                    workers.remove(worker)


class _Worker:
    """One process and the input that it is at."""

    def __init__(self, numbers: Iterator[int], form: str, base: Path | None) -> None:
        self._numbers, self._form, self._base = numbers, form, base
        self._start()
        self.next()

    def _start(self) -> None:
        self.results, theirs = _PROCESSES.Pipe()
        what = (theirs, self._form, self._base)
        self._process = _PROCESSES.Process(target=_work, args=what, daemon=True)
        self._process.start()
        theirs.close()

    def next(self) -> bool:
        """Hand out the next input; end the process when there is none."""
        number = next(self._numbers, None)
        self.results.send(number)
        if number is None:
            self._process.join()
            return False
        self._number = number
        self._used, self._began = self._processor_time(), time.monotonic()
        return True

    def _processor_time(self) -> float:
        """Return the processor time of the process so far; 0 where the system does not tell. [s]"""
        try:
            stat = Path(f"/proc/{self._process.pid}/stat").read_text(encoding="utf-8")
        except OSError:
            return 0.0
        user, system = stat.rpartition(")")[2].split()[11:13]
        return (int(user) + int(system)) / os.sysconf("SC_CLK_TCK")

    def take(self) -> Finding:
        """Return the result that is there; a process that died says so by its end."""
        try:
            found: Finding = self.results.recv()
        except EOFError:
            self._process.join()
            return self._again(f"died, exit code {self._process.exitcode}")
        return self._again(found.outcome, found) if found.outcome == "memory" else found

    def late(self) -> Finding | None:
        """Kill the process if it is at its input for too long."""
        used, waited = self._processor_time() - self._used, time.monotonic() - self._began
        if used < _SECONDS and waited < _WAIT:
            return None
        self._process.kill()
        self._process.join()
        return self._again(f"not done in {used:.0f} s of processor, {waited:.0f} s")

    def _again(self, outcome: str, found: Finding | None = None) -> Finding:
        if self._process.is_alive():
            self._process.kill()
        self._start()
        if found is None and self._form != "logs":
            return Finding(self._number, self._form, "", outcome)
        one = case(self._number, _LAYOUTS)
        return found or Finding(self._number, one.layout.name, one.damage, outcome)


def _work(connection: Connection, form: str, base: Path | None) -> None:
    resource.setrlimit(resource.RLIMIT_AS, (_ADDRESSES, _ADDRESSES))
    while (number := connection.recv()) is not None:
        connection.send(examine_here(number, form, base, most=MEMORY))


def examine_here(
    number: int, form: str = "logs", base: Path | None = None, *, most: float = float("inf")
) -> Finding:
    """Examine one input in this process; parameters as of :func:`examined`.

    A log may take the memory ``most`` in a process that does nothing else. [MB]
    """
    if form != "logs":
        assert base is not None
        with tempfile.TemporaryDirectory(prefix="fuzz-", dir=_DISK) as folder:
            input_, outcome, text = examine(form, number, Path(folder), base)
            if outcome not in GOOD:
                keep(form, number, Path(folder), input_.words)
        return Finding(number, form, input_.damage, outcome, text)
    one = case(number, _LAYOUTS)
    with tempfile.TemporaryDirectory(prefix="fuzz-", dir=_DISK) as folder:
        outcome, text = _outcome(one, Path(folder), most, inspected=number % _INSPECTED == 0)
    return Finding(number, one.layout.name, one.damage, outcome, text)


def _outcome(one: Case, folder: Path, most: float, *, inspected: bool) -> tuple[str, str]:
    from frictioncli.documents import to_json
    from frictioncli.errors import FrictionError
    from frictioncli.inspection.document import document
    from frictioncli.inspection.inspect import inspect
    from frictioncli.inspection.map_suggestion.suggest_map import suggested_map
    from frictioncli.inspection.text import text
    from frictioncli.logs.ingest import IngestSettings, ingest

    run, work = folder / "run", folder / "work"
    run.mkdir()
    for name, content in one.files.items():
        (run / name).write_bytes(content)
    settings = IngestSettings(
        map_file=run / one.layout.map_file if one.layout.map_file else None,
        gear_ratio=one.layout.gear_ratio,
    )
    _forget_peak()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            if inspected:
                found = inspect([run], settings)
                to_json(document(found))
                text(found, verbose=True)
                with suppress(FrictionError):  # no log that can be opened
                    suggested_map([run], settings)
            ingest([run], work, settings)
    except FrictionError:
        left = [*work.rglob("*")] if work.exists() else []
        return ("half-written", str(left)) if left else ("refused", "")
    except MemoryError:
        return "memory", traceback.format_exc()[-1500:]
    except Exception:
        return "traceback", traceback.format_exc()[-1500:]
    # before the tables are compared, which takes more memory than to read a log
    if (peak := _peak()) > most:
        return "memory", f"{peak:.0f} MB"
    wrong = contradiction(one, work)
    shutil.rmtree(work)
    return ("wrong", wrong) if wrong else ("read", "")


def _forget_peak() -> None:
    """Let the peak of this process's memory begin anew, where the system can."""
    with suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5", encoding="ascii")


def _peak() -> float:
    """Return the peak of this process's memory since it was forgotten. [MB]"""
    try:
        status = Path("/proc/self/status").read_text(encoding="ascii")
    except OSError:
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000
    return int(status.partition("VmHWM:")[2].split()[0]) / 1000
