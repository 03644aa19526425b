"""Processing of joints in processes of this machine."""

import multiprocessing
import signal
from collections.abc import Generator, Iterable
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from itertools import islice

from frictioncli.fleet.joint import JointOutcome, JointTask, record_failure, run_joint
from frictioncli.fleet.settings import ATTEMPTS


@dataclass(slots=True)
class _Job:
    """A joint in progress and the process pool, of one process, that it runs in."""

    pool: ProcessPoolExecutor
    task: JointTask
    attempt: int = 1


def run_locally(tasks: Iterable[JointTask], workers: int) -> Generator[JointOutcome, None, None]:
    """Yield the outcome of each joint as soon as it is done.

    Each process has a pool of its own and works on one joint at a time. If a process dies, killed
    or out of memory, only its joint is tried again, in a new process; the others go on.

    Parameters
    ----------
    tasks : iterable of JointTask
        The joints.
    workers : int
        Number of processes.
    """
    waiting = iter(tasks)
    pools: list[ProcessPoolExecutor] = []
    running: dict[Future[JointOutcome], _Job] = {}

    def start(job: _Job) -> None:
        running[job.pool.submit(run_joint, job.task)] = job

    try:
        for task in islice(waiting, workers):
            pools.append(_one_process())
            start(_Job(pools[-1], task))
        while running:
            done, _ = wait(running, return_when=FIRST_COMPLETED)
            for future in done:
                job = running.pop(future)
                try:
                    yield future.result()
                except BrokenProcessPool:
                    pools.remove(job.pool)
                    job.pool = _one_process()
                    pools.append(job.pool)
                    if job.attempt < ATTEMPTS:
                        start(_Job(job.pool, job.task, job.attempt + 1))
                        continue
                    yield record_worker_death(job.task)
                following = next(waiting, None)
                if following is not None:
                    start(_Job(job.pool, following))
    finally:
        for pool in pools:
            pool.shutdown(wait=True, cancel_futures=True)


def record_worker_death(task: JointTask) -> JointOutcome:
    """Record that the process of a joint has died in every attempt.

    Parameters
    ----------
    task : JointTask
        The joint.
    """
    text = "the process that worked on it died, each time it was tried; out of memory?"
    return record_failure(task, text, text)


def _one_process() -> ProcessPoolExecutor:
    # a new interpreter, because a fork copies locks that threads of this process hold
    context = multiprocessing.get_context("spawn")
    return ProcessPoolExecutor(1, mp_context=context, initializer=_end_on_interrupt)


def _end_on_interrupt() -> None:
    """Let Ctrl-C end a worker at once and without a traceback; the caller prints the message."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
