"""Joints on a Dask cluster that is there already; each worker reads and writes its own files."""

import logging
from collections.abc import Generator, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import contextmanager
from typing import Any

from frictioncli import __version__
from frictioncli.errors import FrictionError, OptionError
from frictioncli.fleet.joint import JointTask, Outcome, run_joint
from frictioncli.fleet.local_pool import given_up

_PATIENCE = 60
"""How long a scheduler and its first worker are waited for. [s]"""

_LARGEST_BATCH = 16
_BATCHES_PER_WORKER = 20


def run_on_cluster(tasks: Sequence[JointTask], address: str) -> Generator[Outcome, None, None]:
    """Yield the outcome of each joint as it comes.

    As many tasks are in flight as the cluster has workers, a few joints each where there are many.
    When a worker dies the scheduler gives its task to another one; joints that were done stay
    done. A task that takes down as many workers as the scheduler allows comes back: its joints are
    then tried alone, and the one that does it again has failed.

    Parameters
    ----------
    tasks : sequence of JointTask
        The joints, with absolute paths that all workers share.
    address : str
        Address of the scheduler, such as ``tcp://host:8786``.

    Raises
    ------
    OptionError
        If Dask is not installed, nothing answers at the address, or a worker does not suit.
    FrictionError
        If the scheduler is lost.
    """
    with _client(address) as client:
        from distributed import KilledWorker, as_completed

        size = _batch_size(len(tasks), len(client.nthreads()))
        waiting = [list(tasks[i : i + size]) for i in range(0, len(tasks), size)][::-1]
        running: dict[str, list[JointTask]] = {}
        queue = as_completed(loop=client.loop)

        def fill() -> None:
            while waiting and len(running) < max(1, len(client.nthreads())):
                batch = waiting.pop()
                future = client.submit(_run_batch, batch, pure=False)
                running[future.key] = batch
                queue.add(future)

        fill()
        for future in queue:
            batch = running.pop(future.key)
            try:
                yield from future.result()
            except KilledWorker:
                if len(batch) == 1:
                    yield given_up(batch[0])
                else:
                    waiting += [[task] for task in batch]
            except CancelledError as error:
                raise FrictionError(
                    f"--scheduler {address}: the scheduler is gone; joints that were done stay"
                    " done: start it and call again"
                ) from error
            fill()


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
    with _silent("distributed.client"), client:
        try:
            client.wait_for_workers(1, timeout=_PATIENCE)
        except TimeoutError as error:
            raise OptionError(
                f"--scheduler {address}: the scheduler has no workers; start some with"
                f" 'dask worker {address} --nthreads 1'"
            ) from error
        yield client


@contextmanager
def _silent(name: str) -> Iterator[None]:
    """Keep a library from telling, with a traceback, what one message here tells."""
    log = logging.getLogger(name)
    level = log.level
    log.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        log.setLevel(level)


def _batch_size(joints: int, workers: int) -> int:
    """Return how many joints make a task: enough batches remain to keep all workers busy."""
    return max(1, min(_LARGEST_BATCH, joints // (_BATCHES_PER_WORKER * max(workers, 1))))


def _run_batch(tasks: Sequence[JointTask]) -> list[Outcome]:
    """Work on a few joints, on a worker of the cluster."""
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
