"""Call one function in this fresh process; time the act that it prepares, without the preparing.

Usage: python -m tests.studies.bench_call MODULE:FUNCTION DATA OUT TIMES [ARGUMENT...]
"""

import importlib
import json
import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path

RESULT = "result.json"
"""File in the output folder: the result, and the times if the whole process's do not count."""


def main(target: str, data: Path, out: Path, times: int, arguments: list[str]) -> None:
    """Prepare the act, do it so many times, and write its result with the median times [s]."""
    module, _, name = target.partition(":")
    prepare: Callable[..., Callable[[], object]] = getattr(importlib.import_module(module), name)
    act = prepare(data, out, *arguments)
    walls, cpus = [], []
    for _ in range(times):
        wall, cpu = time.perf_counter(), time.process_time()
        result = act()
        walls.append(time.perf_counter() - wall)
        cpus.append(time.process_time() - cpu)
    told = {"result": result, "wall": statistics.median(walls), "cpu": statistics.median(cpus)}
    (out / RESULT).write_text(json.dumps(told), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3]), int(sys.argv[4]), sys.argv[5:])
