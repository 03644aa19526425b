"""A fleet of 200 joints, here and on Dask: results, cost, scaling. Writes docs/fleet.md.

The hand-written part of the page stays; what is measured stands between two marks.

Usage: OMP_NUM_THREADS=1 python -m tests.studies.fleet [JOINTS] [--rounds N]
"""

import argparse
import json
import os
import shutil
import statistics
import subprocess
import sys
import time
from contextlib import ExitStack
from pathlib import Path

import pandas as pd

from frictioncli import schemas, tables
from frictioncli.stages.run import analyse
from frictioncli.stages.run import run as run_chain
from tests.fleet.clusters import scheduler, worker
from tests.fleet.fleets import ENVIRONMENT, PROGRAM, ROOT, contents
from tests.fleet.joints import Joint, write_joint
from tests.studies.fleet_page import Costs, Measures, Process, write
from tests.studies.fleet_world import Member, write_world

BUILD = ROOT / "build" / "fleet"
_METER = ROOT / "tests" / "studies" / "bench_process.py"
_SUBSET = 20
_RUNS = (2, 4, 8, 16, 32)


def measured(*words: object) -> Process:
    """Run ``frictioncli`` with these words and return what it took."""
    report = BUILD / "report.json"
    command = [sys.executable, "-I", "-S", _METER, report, sys.executable, "-c", PROGRAM, *words]
    subprocess.run([str(word) for word in command], env=ENVIRONMENT, check=True)
    measures = json.loads(report.read_text(encoding="utf-8"))
    if measures.pop("status") != 0:
        raise SystemExit(f"frictioncli {' '.join(map(str, words))} has failed")
    return Process(**measures)


def whole_fleet(joints: int) -> tuple[list[Member], pd.DataFrame, Process, Process, int]:
    """Do all joints by two processes and by two workers of Dask; both must give the same bytes."""
    members = write_world(BUILD / "logs", joints)
    here = measured("fleet", BUILD / "logs", "-w", BUILD / "here", "--workers", 2, "--no-report")
    with ExitStack() as stack:
        address, _ = stack.enter_context(scheduler())
        for number in range(2):
            stack.enter_context(worker(address, BUILD / f"worker{number}"))
        there = measured(
            *("fleet", BUILD / "logs", "-w", BUILD / "there"),
            *("--scheduler", address, "--no-report"),
        )
    one, other = contents(BUILD / "here"), contents(BUILD / "there")
    if one != other:
        names = {name for name in {*one, *other} if one.get(name) != other.get(name)}
        raise SystemExit(f"results differ: {', '.join(sorted(names))}")
    rows = tables.read(BUILD / "here" / "fleet.parquet", schemas.FLEET)
    return members, rows, here, there, len(one)


def scaling(members: list[Member], rounds: int) -> list[tuple[float, float]]:
    """Return the wall time of one and of two processes, round by round, in turn. [s]."""
    chosen = [member for member in members if member.kind != "bad"][:_SUBSET]
    rows = ["robot,joint,run,path"]
    for member in chosen:
        place = BUILD / "logs" / f"robot={member.robot}" / f"joint={member.joint}"
        for run in sorted(place.iterdir()):
            name = run.name.removeprefix("run=")
            rows.append(f"{member.robot},{member.joint},{name},{run.relative_to(BUILD)}")
    table = BUILD / "subset.csv"
    table.write_text("\n".join(rows), encoding="utf-8")

    def wall(workers: int) -> float:
        out = BUILD / "subset"
        options = ("--workers", workers, "--no-report")
        taken = measured("fleet", table, "-w", out, *options).wall
        shutil.rmtree(out)
        return taken

    found = []
    for number in range(rounds):
        order = (1, 2) if number % 2 == 0 else (2, 1)
        walls = {workers: wall(workers) for workers in order}
        found.append((walls[1], walls[2]))
    return found


def full_size() -> Costs:
    """Return what the chain costs on the sample logs, two days of one joint."""
    logs = ROOT / "sample_logs" / "kr10"
    work = BUILD / "full"
    whole = measured("run", logs, "-w", work)
    bare = BUILD / "bare"
    seconds = stages([logs], bare, report=True)
    files = [path for path in work.rglob("*") if path.is_file()]
    return Costs(
        runs=2,
        process=whole,
        seconds=seconds,
        logs=sum(path.stat().st_size for path in logs.rglob("*.csv")),
        results=sum(path.stat().st_size for path in files),
        samples=(work / "samples.parquet").stat().st_size,
    )


def stages(logs: list[Path], work: Path, *, report: bool = False) -> dict[str, float]:
    """Return the processor time of each stage. [s]."""
    found, last = {}, time.process_time()

    def tell(stage: str, _: object) -> None:
        nonlocal last
        now = time.process_time()
        found[stage], last = now - last, now

    (run_chain if report else analyse)(logs, work, None, tell)
    return found


def growth() -> dict[int, dict[str, float]]:
    """Return the processor time of each stage by the number of pairs of a joint. [s]."""
    found = {}
    for runs in _RUNS:
        folder = BUILD / "growth" / str(runs)
        joint = Joint(seed=1, runs=runs, cycle=6)
        write_joint(folder / "logs", joint)
        seconds = stages([folder / "logs"], folder / "work")
        pairs = json.loads((folder / "work" / "model.json").read_text(encoding="utf-8"))["n_pairs"]
        found[pairs] = seconds
    return found


def main(arguments: argparse.Namespace) -> None:
    """Measure everything, then write the page."""
    shutil.rmtree(BUILD, ignore_errors=True)
    BUILD.mkdir(parents=True)
    load = [os.getloadavg()[0]]
    members, rows, here, there, files = whole_fleet(arguments.joints)
    load.append(os.getloadavg()[0])
    measures = Measures(
        members=members,
        rows=rows,
        here=here,
        there=there,
        files=files,
        scaling=scaling(members, arguments.rounds),
        full=full_size(),
        growth=growth(),
        load=statistics.median([*load, os.getloadavg()[0]]),
    )
    write(measures, ROOT / "docs" / "fleet.md")
    shutil.rmtree(BUILD)


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="A fleet, here and on Dask.")
    parser.add_argument("joints", nargs="?", type=int, default=200)
    parser.add_argument("--rounds", type=int, default=3, help="of the scaling from one to two")
    return parser.parse_args()


if __name__ == "__main__":
    main(_arguments())
