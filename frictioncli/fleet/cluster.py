"""Processing of joints on a running Dask cluster; the workers read and write the files."""

import logging
import time
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from threading import Thread
from typing import Any

from frictioncli import __version__
from frictioncli.errors import OptionError
from frictioncli.fleet.joint import JointOutcome, JointTask, record_unworked, run_joint
from frictioncli.fleet.local_processes import record_timeout, record_worker_death

_POLL, _RESTART = 0.05, 20  # [s]
_CHECKED = 5
"""Time between questions to the scheduler, and for its answer. [s]"""
_PATIENCE = 60
"""Timeout for the scheduler and its first worker. [s]"""

_WITHOUT_WORKERS = 300
"""Time for which a scheduler may have no workers. [s]"""

_LARGEST_BATCH = 16
_BATCHES_PER_WORKER = 20


def run_on_cluster(
    tasks: Sequence[JointTask],
    address: str,
    timeout: float | None = None,
    tls: Sequence[Path] = (),
) -> Generator[JointOutcome, None, None]:
    """Yield the outcome of each joint as soon as it is done.

    The joints are sent in batches, one batch per worker at a time. If a worker dies, the scheduler
    gives its batch to another one; joints that were done stay done. If a batch has killed as many
    workers as the scheduler allows, its joints are tried one by one, and the joint that kills
    workers again has failed.

    With a timeout joints are sent one by one. One that takes longer has failed, its worker is
    restarted where a nanny watches it, and gets no further joint where none does.

    If the scheduler is lost, stays silent or loses all workers for long, the joints that are not
    done have failed.

    Parameters
    ----------
    tasks : sequence of JointTask
        The joints, with absolute paths that are the same on all workers.
    address : str
        Address of the scheduler, such as ``tls://host:8786``.
    timeout : float, optional
        Time that a joint may take. [s]
    tls : sequence of Path
        Files of the authority, the certificate and its key; none: as Dask is configured.

    Raises
    ------
    OptionError
        If Dask is not installed, no scheduler answers, or a worker has several threads or another
        version of the program.
    """
    with _client(address, tls) as client:
        from distributed import KilledWorker, as_completed

        scheduler = _Scheduler(client)
        size = 1 if timeout else _batch_size(len(tasks), len(scheduler.workers()))
        waiting = [list(tasks[i : i + size]) for i in range(0, len(tasks), size)][::-1]
        running: dict[str, _Running] = {}
        stuck: set[str] = set()
        queue = as_completed(loop=client.loop)

        def submit() -> None:
            workers = scheduler.workers()
            free = workers - stuck
            while waiting and len(running) < max(1, len(free)) and (free or not workers):
                batch = waiting.pop()
                chosen = {"workers": sorted(free), "allow_other_workers": True} if stuck else {}
                future = client.submit(_run_batch, batch, pure=False, **chosen)
                running[future.key] = _Running(future, batch, time.monotonic())
                queue.add(future)

        try:
            submit()
            while running:
                if not queue.has_ready():
                    time.sleep(_POLL)
                    scheduler.check()
                    late = [one for one in running.values() if timeout and one.seconds() > timeout]
                    for one in late:
                        del running[one.future.key]
                        yield record_timeout(one.batch[0], timeout or 0.0)
                        stuck |= scheduler.end(one.future)
                        submit()
                    continue
                future = next(queue)
                if future.key not in running:  # it was late
                    continue
                batch = running[future.key].batch
                try:
                    outcomes = future.result()
                except KilledWorker:
                    outcomes = [record_worker_death(batch[0])] if len(batch) == 1 else []
                    waiting += [[task] for task in batch] if len(batch) > 1 else []
                except CancelledError as error:
                    raise _SchedulerLost("the scheduler stopped answering") from error
                del running[future.key]
                yield from outcomes
                submit()
            text = "all workers are blocked by joints that took too long"
        except _SchedulerLost as lost:
            text = f"--scheduler {address}: {lost}: start it and call again"
            waiting += [one.batch for one in running.values()]
        for task in (task for batch in waiting for task in batch):
            yield record_unworked(task, text)


class _SchedulerLost(Exception):
    """The scheduler, or all of its workers, do not answer."""


class _Scheduler:
    """Questions to the scheduler, none of which waits for ever.

    Parameters
    ----------
    client : distributed.Client
        Its client.
    """

    def __init__(self, client: Any) -> None:
        self._client = client
        self._answered = self._had_workers = self._asked = time.monotonic()

    def workers(self) -> set[str]:
        """Return the addresses of the workers.

        Raises
        ------
        _SchedulerLost
            If it does not answer.
        """
        while True:
            try:
                return self._workers()
            except (OSError, AttributeError):  # the client has lost it and looks for it
                self._check_silence()
                time.sleep(_POLL)

    def check(self) -> None:
        """Ask now and then whether it is there and has workers.

        Raises
        ------
        _SchedulerLost
            If it has not answered, or has had no workers, for long.
        """
        if time.monotonic() - self._asked < _CHECKED:
            return
        try:
            self._workers()
        except (OSError, AttributeError):
            self._check_silence()
        self._asked = time.monotonic()
        if self._asked - self._had_workers > _WITHOUT_WORKERS:
            raise _SchedulerLost(f"it has had no workers for {_WITHOUT_WORKERS} s")

    def end(self, future: Any) -> set[str]:
        """End the work on a future; return the workers that cannot be restarted and go on."""
        try:
            processing = self._ask(self._client.scheduler.processing, workers=None)
            workers = {name for name, keys in processing.items() if future.key in keys}
            future.cancel()
            restarted = self._client.restart_workers(
                list(workers), timeout=_RESTART, raise_for_error=False
            )
        except (ValueError, TimeoutError):  # no nanny
            return workers
        except (OSError, AttributeError):
            self._check_silence()
            return set()
        return {name for name in workers if restarted.get(name) != "OK"}

    def _workers(self) -> set[str]:
        found = set(self._ask(self._client.scheduler.ncores, workers=None))
        self._answered = time.monotonic()
        if found:
            self._had_workers = self._answered
        return found

    def _ask(self, question: Any, **more: Any) -> Any:
        return self._client.sync(question, callback_timeout=_CHECKED, **more)

    def _check_silence(self) -> None:
        if self._client.status == "closed" or time.monotonic() - self._answered > _PATIENCE:
            raise _SchedulerLost("the scheduler stopped answering")


@dataclass(frozen=True, slots=True)
class _Running:
    """Joints that a worker has got, and when."""

    future: Any
    batch: list[JointTask]
    began: float

    def seconds(self) -> float:
        return time.monotonic() - self.began


@contextmanager
def _client(address: str, tls: Sequence[Path]) -> Iterator[Any]:
    try:
        from distributed import Client
    except ImportError as error:
        raise OptionError(
            "--scheduler needs Dask; install it with: pip install 'frictioncli[cluster]'"
        ) from error
    try:
        options = {"security": _security(tls)} if tls else {}
        client = _connected(Client, address, options)
    except (OSError, ValueError, TypeError) as error:
        raise OptionError(
            f"--scheduler {address}: no Dask scheduler answers ({error}); expected an address such"
            " as tls://host:8786, with the files of --tls-ca, --tls-cert and --tls-key"
        ) from error
    with _no_logging("distributed.client"), client:
        _wait_for_workers(client, address)
        yield client


def _connected(kind: Callable[..., Any], address: str, options: dict[str, Any]) -> Any:
    """Return a client; Dask would wait for ever for the greeting of a scheduler that is stopped."""
    found: list[Any] = []

    def connect() -> None:
        try:
            found.append(kind(address, timeout=_PATIENCE, set_as_default=False, **options))
        except Exception as error:  # raised again below
            found.append(error)

    # nothing waits for a daemon when the program ends
    thread = Thread(target=connect, daemon=True)
    thread.start()
    thread.join(2 * _PATIENCE)
    if not found:
        raise TimeoutError(f"it is silent for {2 * _PATIENCE} s")
    if isinstance(found[0], Exception):
        raise found[0]
    return found[0]


def _wait_for_workers(client: Any, address: str) -> None:
    scheduler, began = _Scheduler(client), time.monotonic()
    try:
        while not scheduler.workers():
            if time.monotonic() - began > _PATIENCE:
                raise OptionError(
                    f"--scheduler {address}: the scheduler has no workers; start some with"
                    f" 'dask worker {address} --nthreads 1'"
                )
            time.sleep(_POLL)
    except _SchedulerLost as lost:
        raise OptionError(f"--scheduler {address}: {lost}: start it and call again") from lost


def _security(tls: Sequence[Path]) -> Any:
    """Return the settings of an encrypted connection, in which each side knows the other."""
    from distributed.security import Security

    authority, certificate, key = map(str, tls)
    return Security(
        require_encryption=True,
        tls_ca_file=authority,
        tls_client_cert=certificate,
        tls_client_key=key,
    )


@contextmanager
def _no_logging(name: str) -> Iterator[None]:
    """Suppress the log messages of a library; its faults are reported here by one message."""
    log = logging.getLogger(name)
    level = log.level
    log.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        log.setLevel(level)


def _batch_size(joints: int, workers: int) -> int:
    """Return the number of joints in a batch, small enough to keep all workers busy."""
    return max(1, min(_LARGEST_BATCH, joints // (_BATCHES_PER_WORKER * max(workers, 1))))


def _run_batch(tasks: Sequence[JointTask]) -> list[JointOutcome]:
    """Process a batch of joints, on a worker of the cluster."""
    from distributed import get_worker

    worker = get_worker()
    if worker.state.nthreads != 1:
        raise OptionError(
            f"worker {worker.address} has {worker.state.nthreads} threads; expected one, as joints"
            " run in processes of their own: start it with --nthreads 1"
        )
    if tasks[0].version != __version__:
        raise OptionError(
            f"worker {worker.address} has frictioncli {__version__}; expected"
            f" {tasks[0].version}, the version of the caller"
        )
    return [run_joint(task) for task in tasks]
