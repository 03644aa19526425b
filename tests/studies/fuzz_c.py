"""Inputs for both C modules, guided by what they reach, with sanitizers of memory and of behaviour.

The modules are compiled by gcc with ``-fsanitize=address,undefined`` and ``trace-pc``. An input is
made from one of the corpus by a few changes; it joins the corpus where it reaches a place, or a
place more often, than any before. What the modules return is compared with Python's own numbers.
The corpus is kept in ``build/fuzz-c``, so that the next call goes on from there.

Usage: python -m tests.studies.fuzz_c [--inputs N] [--seed SEED]
"""

import argparse
import ctypes
import hashlib
import importlib.util
import math
import os
import random
import re
import subprocess
import sys
import sysconfig
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parents[2]
STORE = ROOT / "build" / "fuzz-c"
MODULES = {
    "_plain_numbers": ROOT / "frictioncli" / "logs" / "formats" / "_plain_numbers.c",
    "_bin_runs": ROOT / "frictioncli" / "pairs" / "_bin_runs.c",
}
SANITIZERS = ("-O1", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
NUMBER = re.compile(rb"-?\d+(?:\.\d*)?(?:[eE][+-]?\d{1,3})?")
PARTS = (b"0", b"-", b"+", b".", b";", b"\n", b"\r", b"\r\n", b"e", b"E9", b'"', b"\0", b"9" * 19)
SEEDS = (b"1;2\n3;4\n", b"-1.5e3;\n;2\r\n", b'"a";1\n', b"9007199254740993;1e22", b"1;2;3\n")


def built() -> dict[str, Path]:
    """Compile both modules and the counters of coverage; return the file of each."""
    STORE.mkdir(parents=True, exist_ok=True)
    include = sysconfig.get_paths()["include"]
    counters = STORE / "libcoverage.so"
    source = Path(__file__).with_name("fuzz_coverage.c")
    shared = ("gcc", "-shared", "-fPIC")
    subprocess.run([*shared, "-O1", str(source), "-o", str(counters)], check=True)
    files = {"coverage": counters}
    for name, path in MODULES.items():
        files[name] = STORE / f"{name}.so"
        words = [*shared, *SANITIZERS, "-fsanitize-coverage=trace-pc", f"-I{include}", str(path)]
        linked = ["-o", str(files[name]), str(counters), f"-Wl,-rpath,{STORE}"]
        subprocess.run([*words, *linked], check=True)
    return files


def loaded(name: str, path: Path):
    """Return a compiled module."""
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class Coverage:
    """What all inputs so far have reached."""

    def __init__(self, path: Path) -> None:
        self._library = ctypes.CDLL(str(path))
        self._places = (ctypes.c_int * 65536)()
        self.known: set[int] = set()

    def forget(self) -> None:
        """Begin a new input."""
        self._library.forget()

    def is_new(self) -> bool:
        """Return whether the input has reached anything new, and remember it."""
        found = set(self._places[: self._library.reached_places(self._places)])
        new = not found <= self.known
        self.known |= found
        return new


def changed(content: bytes, draw: random.Random, others: list[bytes]) -> bytes:
    """Return an input made from another by a few changes."""
    data = bytearray(content)
    for _ in range(draw.choice((1, 1, 2, 4, 8))):
        at = draw.randrange(len(data) + 1)
        kind = draw.randrange(5)
        if kind == 0 and data:
            data[at % len(data)] ^= 1 << draw.randrange(8)
        elif kind == 1:
            data[at:at] = draw.choice(PARTS)
        elif kind == 2:
            del data[at : at + draw.choice((1, 2, 8))]
        elif kind == 3:
            data[at:at] = data[at : at + draw.choice((1, 4, 16))]
        else:
            data[at:] = draw.choice(others)[draw.randrange(9) :]
    return bytes(data[:400])


def parse(module, content: bytes, draw: random.Random) -> None:
    """Parse an input as a log; compare what came of it with Python's numbers."""
    fields, rows = draw.choice((2, 2, 3)), content.count(b"\n") + draw.choice((0, 0, 1))
    wanted = np.array([draw.random() < 0.8 for _ in range(fields)], np.uint8)
    wanted[0] |= not wanted.any()
    found = np.empty((int(wanted.sum()), rows))
    assert module.line_feeds(content) == content.count(b"\n")
    if not module.columns(content, ord(";"), ord("."), wanted.data, found.data):
        return
    lines = re.split(rb"\r?\n", content)
    for row, line in enumerate(lines[:rows]):
        cells = [cell for cell, ask in zip(line.split(b";"), wanted, strict=True) if ask]
        for cell, value in zip(cells, found[:, row], strict=True):
            assert NUMBER.fullmatch(cell) if cell else math.isnan(value), (content, cell)
            assert not cell or float(cell) == value, (content, cell, value)


def bin_runs(module, content: bytes, draw: random.Random) -> None:
    """Bin samples made of the bytes of an input; compare the sums with those of NumPy."""
    n = len(content) // 8
    position = np.frombuffer(content[: 8 * n], np.float64) if draw.random() < 0.3 else None
    if position is None:
        position = np.frombuffer(content[: 8 * n], np.int8)[:n].astype(float) / 8
    n = len(position)
    torque, load, time = position * 2, np.where(position > 3, np.nan, 1.0), np.arange(float(n))
    cuts = sorted({draw.randrange(n + 1) for _ in range(draw.randrange(6))} | {0, n})
    start, stop = np.array(cuts[:-1], np.int64), np.array(cuts[1:], np.int64)
    if draw.random() < 0.1 and len(stop):
        stop[draw.randrange(len(stop))] += draw.choice((-5, 1, 1 << 62))
    width = draw.choice((1.0, 0.5, 1e-300, 1e300, math.nan, -1.0, 0.0))
    sums, count = np.empty((5, n)), np.empty(n, np.int64)
    end = np.empty(len(start), np.int64)
    given = (position, torque, load, time, start, stop)
    try:
        module.runs(*(np.ascontiguousarray(one).data for one in given), width, sums, count, end)
    except ValueError:
        return
    runs = int(end[-1]) if len(end) else 0
    assert int(count[:runs].sum()) == int((stop - start).sum())
    assert (count[:runs] > 0).all()
    if np.array_equal(start[1:], stop[:-1]) and int(count[:runs].sum()) == n:
        first = np.concatenate(([0], np.cumsum(count[:runs])[:-1]))
        expected = np.add.reduceat(time, first) if runs else np.empty(0)
        assert np.array_equal(sums[4, :runs], expected)


def work(asked: argparse.Namespace) -> None:
    """Try inputs; called in a process with the sanitizer loaded first."""
    files = built() if not (STORE / "libcoverage.so").exists() else None
    files = files or {name: STORE / f"{name}.so" for name in MODULES} | {
        "coverage": STORE / "libcoverage.so"
    }
    coverage = Coverage(files["coverage"])
    tries = {"_plain_numbers": parse, "_bin_runs": bin_runs}
    for name, one_try in tries.items():
        module, folder = loaded(name, files[name]), STORE / name
        folder.mkdir(exist_ok=True)
        corpus = [*SEEDS, *(path.read_bytes() for path in sorted(folder.iterdir()))]
        draw, coverage.known = random.Random(asked.seed), set()
        kept = len(corpus)
        for number in range(asked.inputs):
            old = number < len(corpus)
            content = corpus[number] if old else changed(draw.choice(corpus), draw, corpus)
            coverage.forget()
            one_try(module, content, draw)
            if coverage.is_new() and not old:
                corpus.append(content)
                (folder / hashlib.sha256(content).hexdigest()[:16]).write_bytes(content)
        print(
            f"{name}: {asked.inputs:,} inputs, {len(coverage.known)} places and counts reached,"
            f" corpus of {len(corpus)} ({len(corpus) - kept} new); no finding"
        )


def main() -> None:
    """Compile, and try in a process of its own."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--inputs", type=int, default=1_000_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--here", action="store_true", help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.here:
        work(asked)
        return
    built()
    library = subprocess.run(
        ["gcc", "-print-file-name=libasan.so"], check=True, capture_output=True, text=True
    ).stdout.strip()
    environment = os.environ | {
        "LD_PRELOAD": library,
        # the interpreter keeps memory until its end
        "ASAN_OPTIONS": "detect_leaks=0",
        "UBSAN_OPTIONS": "print_stacktrace=1",
    }
    words = [sys.executable, "-m", "tests.studies.fuzz_c", *sys.argv[1:], "--here"]
    raise SystemExit(subprocess.run(words, env=environment, check=False).returncode)


if __name__ == "__main__":
    main()
