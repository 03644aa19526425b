"""Processing of joints on a running Dask cluster; the workers read and write the files."""

import logging
import time
from collections.abc import Generator, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from frictioncli import __version__
from frictioncli.errors import FrictionError, OptionError
from frictioncli.fleet.joint import JointOutcome, JointTask, record_failure, run_joint
from frictioncli.fleet.local_processes import record_timeout, record_worker_death

_POLL, _RESTART = 0.05, 20  # [s]
_PATIENCE = 60
"""Timeout for the scheduler and its first worker. [s]"""

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
    FrictionError
        If the scheduler is lost.
    """
    with _client(address, tls) as client:
        from distributed import KilledWorker, as_completed

        size = 1 if timeout else _batch_size(len(tasks), len(client.nthreads()))
        waiting = [list(tasks[i : i + size]) for i in range(0, len(tasks), size)][::-1]
        running: dict[str, _Running] = {}
        stuck: set[str] = set()
        queue = as_completed(loop=client.loop)

        def submit() -> None:
            workers = set(client.nthreads())
            free = workers - stuck
            while waiting and len(running) < max(1, len(free)) and (free or not workers):
                batch = waiting.pop()
                chosen = {"workers": sorted(free), "allow_other_workers": True} if stuck else {}
                future = client.submit(_run_batch, batch, pure=False, **chosen)
                running[future.key] = _Running(future, batch, time.monotonic())
                queue.add(future)

        submit()
        while running:
            if timeout and not queue.has_ready():
                time.sleep(_POLL)
                for late in [one for one in running.values() if one.seconds() > timeout]:
                    del running[late.future.key]
                    stuck |= _ended(client, late.future)
                    yield record_timeout(late.batch[0], timeout)
                    submit()
                continue
            future = next(queue)
            if future.key not in running:  # it was late
                continue
            batch = running.pop(future.key).batch
            try:
                yield from future.result()
            except KilledWorker:
                if len(batch) == 1:
                    yield record_worker_death(batch[0])
                else:
                    waiting += [[task] for task in batch]
            except CancelledError as error:
                raise FrictionError(
                    f"--scheduler {address}: the scheduler is gone; joints that were done stay"
                    " done: start it and call again"
                ) from error
            submit()
        for (task,) in waiting:
            text = "all workers are held up by joints that took too long"
            yield record_failure(task, text, text)


@dataclass(frozen=True, slots=True)
class _Running:
    """Joints that a worker has got, and when."""

    future: Any
    batch: list[JointTask]
    began: float

    def seconds(self) -> float:
        return time.monotonic() - self.began


def _ended(client: Any, future: Any) -> set[str]:
    """End the work on a future; return the workers that cannot be restarted and go on with it."""
    workers = {name for name, keys in client.processing().items() if future.key in keys}
    future.cancel()
    try:
        restarted = client.restart_workers(list(workers), timeout=_RESTART, raise_for_error=False)
    except (ValueError, TimeoutError):  # no nanny
        return workers
    return {name for name in workers if restarted.get(name) != "OK"}


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
        client = Client(address, timeout=_PATIENCE, set_as_default=False, **options)
    except (OSError, ValueError, TypeError) as error:
        raise OptionError(
            f"--scheduler {address}: no Dask scheduler answers ({error}); expected an address such"
            " as tls://host:8786, with the files of --tls-ca, --tls-cert and --tls-key"
        ) from error
    with _no_logging("distributed.client"), client:
        try:
            client.wait_for_workers(1, timeout=_PATIENCE)
        except TimeoutError as error:
            raise OptionError(
                f"--scheduler {address}: the scheduler has no workers; start some with"
                f" 'dask worker {address} --nthreads 1'"
            ) from error
        yield client


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
            " are worked on side by side in processes: start it with --nthreads 1"
        )
    if tasks[0].version != __version__:
        raise OptionError(
            f"worker {worker.address} has frictioncli {__version__}; expected"
            f" {tasks[0].version}, as the one who asks"
        )
    return [run_joint(task) for task in tasks]
