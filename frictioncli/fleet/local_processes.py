"""Processing of joints in processes of this machine.

Who started the call handles the signals: workers ignore Ctrl-C, and end when the pipe to the
process that started them closes, whatever has ended it.
"""

import multiprocessing
import os
import signal
import sys
import threading
import time
import warnings
from collections.abc import Generator, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from itertools import islice
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from queue import SimpleQueue
from types import ModuleType

from frictioncli.errors import OptionError
from frictioncli.fleet.joint import JointOutcome, JointTask, record_failure, run_joint
from frictioncli.fleet.settings import ATTEMPTS

_CONTEXT = multiprocessing.get_context("spawn")
"""A new interpreter, because a fork copies locks that threads of this process hold."""

_LONGEST_WAIT = 86_400.0
"""The system waits no longer than 24 days at once. [s]"""


def run_locally(
    tasks: Iterable[JointTask], workers: int, timeout: float | None = None
) -> Generator[JointOutcome, None, None]:
    """Yield the outcome of each joint as soon as it is done.

    Each process works on one joint at a time. If a process dies, killed or out of memory, only its
    joint is tried again, in a new process; the others go on.

    Parameters
    ----------
    tasks : iterable of JointTask
        The joints.
    workers : int
        Number of processes.
    timeout : float, optional
        Time after which a joint has failed and its process is ended. [s]
    """
    waiting = iter(tasks)
    running: list[_Worker] = []
    try:
        for task in islice(waiting, workers):
            running.append(_Worker())
            running[-1].start(task)
        while running:
            for worker in _next_ready(running, timeout):
                outcome = worker.outcome(timeout)
                if outcome is None:
                    worker.start_again()
                    continue
                yield outcome
                following = next(waiting, None)
                if following is not None:
                    worker.start(following)
                else:
                    running.remove(worker)
                    worker.end()
    finally:
        for worker in running:
            worker.end()


def record_worker_death(task: JointTask) -> JointOutcome:
    """Record that the process of a joint has died in every attempt.

    Parameters
    ----------
    task : JointTask
        The joint.
    """
    text = "the process that worked on it died, each time it was tried; out of memory?"
    return record_failure(task, text, text)


def record_timeout(task: JointTask, timeout: float) -> JointOutcome:
    """Record that a joint has taken too long.

    Parameters
    ----------
    task : JointTask
        The joint.
    timeout : float
        The time that it had. [s]
    """
    text = f"not done within the {timeout:g} s of --timeout; its process was ended"
    return record_failure(task, text, text)


@dataclass(slots=True, eq=False)
class _Worker:
    """A process and the joint that it works on."""

    process: BaseProcess | None = None
    connection: Connection | None = None
    task: JointTask | None = None
    attempt: int = 1
    began: float = 0.0

    def start(self, task: JointTask) -> None:
        """Hand out a joint, in a new process if there is none."""
        self.task, self.attempt = task, 1
        self._send()

    def start_again(self) -> None:
        """Hand out the same joint again, in a new process."""
        self.attempt += 1
        self._send()

    def _send(self) -> None:
        if self.connection is None:
            connection, theirs = _CONTEXT.Pipe()
            # a daemon is ended with this process where that ends in the usual way
            process = _CONTEXT.Process(target=_work, args=(theirs,), daemon=True)
            with theirs:
                try:
                    with _interrupt_held(), _script_hidden():
                        process.start()
                except OSError as fault:
                    connection.close()
                    raise OptionError(
                        f"--workers: a process for a joint could not be started ({fault.strerror});"
                        " expected that the system allows one more; ask for fewer, or raise the"
                        " limits of processes and memory"
                    ) from None
            self.connection, self.process = connection, process
        self.began = time.monotonic()
        with suppress(OSError):  # it has died already: receiving tells
            self.connection.send(self.task)

    def outcome(self, timeout: float | None) -> JointOutcome | None:
        """Return what became of the joint; None if it is to be tried again."""
        assert self.task is not None
        assert self.connection is not None
        try:
            if self.connection.poll():
                outcome: JointOutcome = self.connection.recv()
                return outcome
        except (EOFError, OSError):
            self.end()
            return None if self.attempt < ATTEMPTS else record_worker_death(self.task)
        self.end()
        assert timeout is not None  # it was waited for no longer
        return record_timeout(self.task, timeout)

    def end(self) -> None:
        """End the process, whatever it is doing: outputs appear whole or not at all."""
        if self.connection is not None:
            self.connection.close()
        if self.process is not None:
            self.process.kill()
            self.process.join()
        self.process = self.connection = None


def _next_ready(running: list[_Worker], timeout: float | None) -> list[_Worker]:
    """Wait for workers that have an outcome, have died or have taken too long; none may come."""
    connections = [worker.connection for worker in running if worker.connection is not None]
    if timeout is None:
        ready = wait(connections)
        return [worker for worker in running if worker.connection in ready]
    first = min(worker.began for worker in running) + timeout
    ready = wait(connections, min(max(first - time.monotonic(), 0), _LONGEST_WAIT))
    late = time.monotonic() - timeout
    return [w for w in running if w.connection in ready or w.began <= late]


@contextmanager
def _interrupt_held() -> Iterator[None]:
    """Hold Ctrl-C back: the process that is started in the block never gets it."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _script_hidden() -> Iterator[None]:
    """Keep the process that is started in the block from running the caller's script anew.

    A new interpreter would do so, to know what the script defines; joints need nothing of it.
    """
    script = sys.modules["__main__"]
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = script


def _work(connection: Connection) -> None:
    """Work on joints until the connection closes, and end at once when it does."""
    if not sys.warnoptions:
        warnings.simplefilter("ignore")
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    tasks: SimpleQueue[JointTask] = SimpleQueue()

    def receive() -> None:
        try:
            while True:
                tasks.put(connection.recv())
        except (EOFError, OSError):
            os._exit(1)

    threading.Thread(target=receive, daemon=True).start()
    while True:
        outcome = run_joint(tasks.get())
        with suppress(OSError):
            connection.send(outcome)
