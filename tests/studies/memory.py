"""Peak memory and time of ``ingest`` for logs that are many, wide or long.

Usage: python -m tests.studies.memory [many wide long] [--share 1.0]

``--share`` makes smaller ones: 0.1 reads a tenth of the files, row groups and samples.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from tests.studies.bench_growth import write_log

FILES, ROWS = 100_000, 8
COLUMNS, GROUPS, GROUP_ROWS = 2_000, 400, 64
SAMPLES = 10**9
LIMIT = 500
"""Peak that none may exceed. [MB]"""

MEASURE = Path(__file__).with_name("bench_process.py")


def many(folder: Path, share: float) -> str:
    """Write short logs of 9 MB together."""
    for number in range(round(FILES * share)):
        time = 0.01 * np.arange(ROWS)
        rows = (f"{t:.2f};{number % 90 + t:.2f};{t * 7 % 3:.1f}\n" for t in time)
        (folder / f"log-{number:06d}.csv").write_text("t;q;tau\n" + "".join(rows))
    return f"{round(FILES * share):,} files"


def wide(folder: Path, share: float) -> str:
    """Write a Parquet file of many columns and row groups."""
    names = ["time [s]", "position [deg]", "velocity [deg/s]", "torque [N·m]"]
    names += [f"x{i}" for i in range(COLUMNS - len(names))]
    schema = pa.schema([(name, pa.float64()) for name in names])
    other = np.random.default_rng(2).random(GROUP_ROWS)
    groups = round(GROUPS * share)
    with pq.ParquetWriter(folder / "log.parquet", schema) as writer:
        for group in range(groups):
            time = 0.01 * np.arange(group * GROUP_ROWS, (group + 1) * GROUP_ROWS)
            position, velocity = 50 * np.sin(time / 5), 10 * np.cos(time / 5)
            motion = [time, position, velocity, 10 * np.sign(velocity) + velocity]
            writer.write_table(pa.table([*motion, *[other] * (COLUMNS - 4)], schema=schema))
    return f"Parquet, {COLUMNS:,} columns, {groups} row groups"


def long(folder: Path, share: float) -> str:
    """Write one log whose motor temperature has steps of a degree."""
    write_log(folder / "trace.csv.zst", round(SAMPLES * share))
    return f"{SAMPLES * share:.0e} samples, stepped register"


def main() -> None:
    """Measure the forms that are named, else the first two; ends with 1 above the limit."""
    forms = {"many": many, "wide": wide, "long": long}
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("forms", nargs="*", choices=forms, default=["many", "wide"])
    parser.add_argument("--share", type=float, default=1.0)
    asked = parser.parse_args()
    worst = 0.0
    for form in asked.forms:
        with tempfile.TemporaryDirectory() as name:
            logs, report = Path(name, "logs"), Path(name, "report.json")
            logs.mkdir()
            told = forms[form](logs, asked.share)
            words = [sys.executable, "-m", "frictioncli", "ingest", str(logs), "-w", f"{name}/work"]
            call = [sys.executable, "-I", "-S", str(MEASURE), str(report), *words]
            subprocess.run(call, stdout=subprocess.DEVNULL, check=True)
            found = json.loads(report.read_text())
        peak = found["peak"] / 1e6
        worst = max(worst, peak)
        print(
            f"{told}: {peak:.0f} MB, {found['wall']:.0f} s ({found['cpu']:.0f} s of processor)",
            flush=True,
        )
    sys.exit(int(worst > LIMIT))


if __name__ == "__main__":
    main()
