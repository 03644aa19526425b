"""A Dask scheduler and workers as processes of this machine, on its loopback."""

import socket
import subprocess
import sys
from contextlib import contextmanager

from tests.fleet.fleets import ENVIRONMENT


@contextmanager
def program(module, *arguments, **environment):
    """Run a program of Dask while the block runs."""
    process = subprocess.Popen(
        [sys.executable, "-m", f"distributed.cli.{module}", *map(str, arguments)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env=ENVIRONMENT | environment,
    )
    try:
        yield process
    finally:
        process.kill()
        process.wait()


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


@contextmanager
def scheduler(**environment):
    """Run a scheduler; gives its address and process."""
    port = free_port()
    options = ("--host", "127.0.0.1", "--port", port, "--no-dashboard", "--no-show")
    with program("dask_scheduler", *options, **environment) as process:
        yield f"tcp://127.0.0.1:{port}", process


@contextmanager
def worker(address, folder, *, threads=1, nanny=False):
    """Run a worker that starts in an empty folder of its own."""
    folder.mkdir(exist_ok=True)
    options = ("--nthreads", threads, "--no-dashboard", "--local-directory", folder)
    kind = "--nanny" if nanny else "--no-nanny"
    with program("dask_worker", address, *options, kind, "--host", "127.0.0.1") as process:
        yield process
