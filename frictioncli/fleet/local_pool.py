"""Joints on the processors of this machine."""

import multiprocessing
import signal
from collections.abc import Generator, Iterable
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from itertools import islice

from frictioncli.fleet.joint import JointTask, Outcome, failed, run_joint
from frictioncli.fleet.settings import ATTEMPTS


@dataclass(slots=True)
class _Job:
    """A joint at work, and the pool of one process that works on it."""

    pool: ProcessPoolExecutor
    task: JointTask
    attempt: int = 1


def run_local(tasks: Iterable[JointTask], workers: int) -> Generator[Outcome, None, None]:
    """Yield the outcome of each joint as it comes.

    Each process is a pool of its own that is given one joint at a time. So the death of one, killed
    or out of memory, has one suspect, which is begun again in a fresh process; no other notices.

    Parameters
    ----------
    tasks : iterable of JointTask
        The joints.
    workers : int
        Number of processes.
    """
    waiting = iter(tasks)
    pools: list[ProcessPoolExecutor] = []
    working: dict[Future[Outcome], _Job] = {}

    def begin(job: _Job) -> None:
        working[job.pool.submit(run_joint, job.task)] = job

    try:
        for task in islice(waiting, workers):
            pools.append(_pool())
            begin(_Job(pools[-1], task))
        while working:
            done, _ = wait(working, return_when=FIRST_COMPLETED)
            for future in done:
                job = working.pop(future)
                try:
                    yield future.result()
                except BrokenProcessPool:
                    pools.remove(job.pool)
                    job.pool = _pool()
                    pools.append(job.pool)
                    if job.attempt < ATTEMPTS:
                        begin(_Job(job.pool, job.task, job.attempt + 1))
                        continue
                    yield given_up(job.task)
                following = next(waiting, None)
                if following is not None:
                    begin(_Job(job.pool, following))
    finally:
        for pool in pools:
            pool.shutdown(wait=True, cancel_futures=True)


def given_up(task: JointTask) -> Outcome:
    """Note that a joint takes down every process that works on it."""
    text = "the process that worked on it died, each time it was tried; out of memory?"
    return failed(task, text, text)


def _pool() -> ProcessPoolExecutor:
    # a fresh interpreter: a fork would take over the locks of this one's threads as they stand
    context = multiprocessing.get_context("spawn")
    return ProcessPoolExecutor(1, mp_context=context, initializer=_quietly_interrupted)


def _quietly_interrupted() -> None:
    """Let Ctrl-C end a worker at once and without a traceback; the caller says what is done."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
