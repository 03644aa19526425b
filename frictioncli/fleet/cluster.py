"""Processing of joints on a running Dask cluster; the workers read and write the files."""

import logging
from collections.abc import Generator, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import contextmanager
from typing import Any

from frictioncli import __version__
from frictioncli.errors import FrictionError, OptionError
from frictioncli.fleet.joint import JointOutcome, JointTask, run_joint
from frictioncli.fleet.local_processes import record_worker_death

_PATIENCE = 60
"""Timeout for the scheduler and its first worker. [s]"""

_LARGEST_BATCH = 16
_BATCHES_PER_WORKER = 20


def run_on_cluster(tasks: Sequence[JointTask], address: str) -> Generator[JointOutcome, None, None]:
    """Yield the outcome of each joint as soon as it is done.

    The joints are sent in batches, one batch per worker at a time. If a worker dies, the scheduler
    gives its batch to another one; joints that were done stay done. If a batch has killed as many
    workers as the scheduler allows, its joints are tried one by one, and the joint that kills
    workers again has failed.

    Parameters
    ----------
    tasks : sequence of JointTask
        The joints, with absolute paths that are the same on all workers.
    address : str
        Address of the scheduler, such as ``tcp://host:8786``.

    Raises
    ------
    OptionError
        If Dask is not installed, no scheduler answers, or a worker has several threads or another
        version of the program.
    FrictionError
        If the scheduler is lost.
    """
    with _client(address) as client:
        from distributed import KilledWorker, as_completed

        size = _batch_size(len(tasks), len(client.nthreads()))
        waiting = [list(tasks[i : i + size]) for i in range(0, len(tasks), size)][::-1]
        running: dict[str, list[JointTask]] = {}
        queue = as_completed(loop=client.loop)

        def submit() -> None:
            while waiting and len(running) < max(1, len(client.nthreads())):
                batch = waiting.pop()
                future = client.submit(_run_batch, batch, pure=False)
                running[future.key] = batch
                queue.add(future)

        submit()
        for future in queue:
            batch = running.pop(future.key)
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


@contextmanager
def _client(address: str) -> Iterator[Any]:
    try:
        from distributed import Client
    except ImportError as error:
        raise OptionError(
            "--scheduler needs Dask; install it with: pip install 'frictioncli[cluster]'"
        ) from error
    try:
        client = Client(address, timeout=_PATIENCE, set_as_default=False)
    except (OSError, ValueError) as error:
        raise OptionError(
            f"--scheduler {address}: no Dask scheduler answers ({error}); expected an address such"
            " as tcp://host:8786"
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
