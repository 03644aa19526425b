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
def scheduler(*, tls=None, **environment):
    """Run a scheduler, encrypted if it has certificates; gives its address and process."""
    port, protocol = free_port(), "tls" if tls else "tcp"
    options = ("--host", f"{protocol}://127.0.0.1", "--port", port, "--no-dashboard", "--no-show")
    with program("dask_scheduler", *options, *_tls(tls), **environment) as process:
        yield f"{protocol}://127.0.0.1:{port}", process


def _tls(files):
    names = ("--tls-ca-file", "--tls-cert", "--tls-key")
    return [part for pair in zip(names, files, strict=True) for part in pair] if files else []


@contextmanager
def worker(address, folder, *, threads=1, nanny=False, tls=None):
    """Run a worker that starts in an empty folder of its own."""
    folder.mkdir(exist_ok=True)
    options = ("--nthreads", threads, "--no-dashboard", "--local-directory", folder)
    kind = "--nanny" if nanny else "--no-nanny"
    host = f"{address.partition(':')[0]}://127.0.0.1"
    with program("dask_worker", address, *options, kind, "--host", host, *_tls(tls)) as process:
        yield process


def certificates(folder):
    """Make an authority, and a certificate of it with its key; return the three files."""

    def openssl(*words):
        subprocess.run(["openssl", *map(str, words)], check=True, capture_output=True, cwd=folder)

    folder.mkdir()
    new = ("-newkey", "rsa:2048", "-nodes", "-subj")
    openssl("req", "-x509", *new, "/CN=authority", "-keyout", "ca.key", "-out", "ca.pem")
    openssl("req", *new, "/CN=fleet", "-keyout", "own.key", "-out", "own.csr")
    signed = ("-CA", "ca.pem", "-CAkey", "ca.key", "-CAcreateserial")
    openssl("x509", "-req", "-in", "own.csr", *signed, "-out", "own.pem")
    return folder / "ca.pem", folder / "own.pem", folder / "own.key"
