"""SIGKILL at any moment: what is left are the old files or the new ones, never anything else."""

import multiprocessing
import os
import shutil
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path

from frictioncli.stages.fit import fit
from frictioncli.stages.ingest import ingest
from frictioncli.stages.pair import pair
from frictioncli.stages.separate import separate
from tests.command_line import called
from tests.robustness.runs import check_readable, digests, finished, outputs, started, write_warm_up

_CHANGES = {"open", "os.rename", "os.remove", "os.mkdir", "os.rmdir", "os.link", "os.truncate"}
_PROCESSES = multiprocessing.get_context("forkserver")
_PROCESSES.set_forkserver_preload(["frictioncli.stages.run", "frictioncli.report.page"])


class Worlds:
    """Two versions of a joint's logs, and the undisturbed outputs of each.

    Parameters
    ----------
    folder : Path
        Where all of it is made.
    levels : tuple of int
        Motor temperature of each recording. [°C]
    whole : bool
        Whether the outputs are those of the whole chain; else they end with the model.

    Attributes
    ----------
    logs : Path
        Logs of the run that is disturbed.
    old : Path
        Work folder of a former run, over other logs of the same names.
    before, after : dict of str to str
        Name -> SHA-256 of the outputs of the former and of the undisturbed new run.
    duration : float
        What the undisturbed run took. [s]
    """

    def __init__(self, folder: Path, levels: tuple[int, ...], *, whole: bool = True) -> None:
        self.folder = folder
        self.logs, self.old = folder / "logs", folder / "old"
        write_warm_up(self.logs / "day", levels=levels, seed=1)
        make = _run if whole else _stages_to_the_model
        make(self.logs, self.old)
        shutil.rmtree(self.logs)
        write_warm_up(self.logs / "day", levels=levels, seed=4)
        begin = time.monotonic()
        # in this process, which has imported what a process of its own has to
        make(self.logs, folder / "new")
        self.duration = time.monotonic() - begin
        self.before, self.after = digests(self.old), digests(folder / "new")
        # else nothing would tell old from new
        assert self.before.keys() == self.after.keys()
        assert all(self.before[n] != self.after[n] for n in ("samples.parquet", "model.json"))

    def work(self, *, fresh: bool) -> Path:
        """Return a new work folder: empty, or as the former run left it."""
        work = self.folder / "work"
        shutil.rmtree(work, ignore_errors=True)
        if not fresh:
            shutil.copytree(self.old, work)
        return work

    def check(self, work: Path) -> None:
        """Fail unless every output is the old one or the new one, whole."""
        found = digests(work)
        for path in outputs(work):
            name = path.relative_to(work).as_posix()
            check_readable(path)
            assert found[name] in (self.before[name], self.after[name]), name

    def check_next_run(self, work: Path) -> None:
        """Fail unless the next run completes with exactly the undisturbed outputs."""
        again = finished("run", self.logs, "-w", work)
        assert again.returncode == 0, again.stderr
        assert digests(work) == self.after


def _run(logs: Path, work: Path) -> None:
    assert called("run", logs, "-w", work).returncode == 0


def _stages_to_the_model(logs: Path, work: Path) -> None:
    ingest([logs], work)
    for stage in (pair, separate, fit):
        stage(work)


def killed_run(worlds: Worlds, seconds: float, *, fresh: bool) -> tuple[Path, bool]:
    """Kill a run after some time; return its work folder and whether it was still running."""
    work = worlds.work(fresh=fresh)
    process = started("run", worlds.logs, "-w", work)
    time.sleep(seconds)
    running = process.poll() is None
    process.kill()
    process.communicate()
    return work, running


def killed_before_change(stage: Callable[[], object], work: Path, number: int) -> bool:
    """Run a stage and kill it before its ``number``-th change of the work folder.

    Returns whether it came to that; False when the stage ended before.
    """
    process = _PROCESSES.Process(target=_run_until, args=(stage, work, number))
    process.start()
    process.join()
    assert process.exitcode in (0, -signal.SIGKILL)
    return process.exitcode != 0


def _run_until(stage: Callable[[], object], work: Path, number: int) -> None:
    left = number

    def hook(event: str, arguments: tuple[object, ...]) -> None:
        nonlocal left
        if event == "ctypes.dlsym" or (event in _CHANGES and _concerns(event, arguments, work)):
            left -= 1
            if left == 0:
                os.kill(os.getpid(), signal.SIGKILL)

    sys.addaudithook(hook)
    stage()


def _concerns(event: str, arguments: tuple[object, ...], work: Path) -> bool:
    if event == "open" and not int(arguments[2] or 0) & (os.O_WRONLY | os.O_RDWR):
        return False
    return str(work) in str(arguments[0])
