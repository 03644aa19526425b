"""Does ``diagnose`` find what is hidden, and nothing else? Writes docs/blind.md and its pictures.

Every world is simulated by :mod:`frictioncli.simulator`, which shares no formula with the
catalogue, and diagnosed blind. Results are kept in ``build/blind.csv``; a second call goes on where
the first one stopped, and repeats what changed sources have made stale.

Usage: OMP_NUM_THREADS=1 python -m tests.studies.blind [SEEDS] [--minutes M] [--only KIND]
       [--processes N] [--keep] [--page]
"""

import argparse
import os
import time
from collections.abc import Iterable
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from itertools import islice
from pathlib import Path

import pandas as pd

from tests.studies.blind_examined import COLUMNS, examined
from tests.studies.blind_figures import confusion_picture, power_picture
from tests.studies.blind_page import page
from tests.studies.blind_rows import told
from tests.studies.blind_worlds import KEY, KINDS, World, sources, worlds
from tests.studies.rows import ROOT, Rows

ROWS = Rows(ROOT / "build" / "blind.csv", COLUMNS, KEY)
DOCS = ROOT / "docs"


def run(missing: Iterable[World], digest: str, processes: int, minutes: float) -> None:
    """Examine worlds and store their rows; hand out none any more after so many minutes."""
    until = time.monotonic() + 60.0 * minutes
    waiting = iter(missing)
    with ProcessPoolExecutor(processes) as pool, ROWS.adding() as add:
        tasks: set[Future[dict[str, object]]] = set()
        while True:
            if time.monotonic() < until:
                free = processes - len(tasks)
                tasks |= {pool.submit(examined, world, digest) for world in islice(waiting, free)}
            if not tasks:
                break
            done, tasks = wait(tasks, return_when=FIRST_COMPLETED)
            for task in done:
                add(task.result())


def write(rows: pd.DataFrame, digest: str, folder: Path) -> None:
    """Write the page, which says what other sources than these have made, and its pictures."""
    rows = told(rows)
    confusion_picture(rows, folder / "blind-confusion.png")
    power_picture(rows, folder / "blind-power.png")
    (folder / "blind.md").write_text(page(rows, digest), encoding="utf-8")


def main(arguments: argparse.Namespace) -> None:
    """Run what is missing, then write the page from what is there."""
    digest = sources()
    if not arguments.page:
        done = ROWS.done(digest, keep=arguments.keep)
        asked = [world for world in worlds(arguments.seeds) if arguments.only in ("", world.kind)]
        missing = [world for world in asked if world.key not in done]
        run(missing, digest, arguments.processes, arguments.minutes)
    rows = ROWS.read(digest, keep=arguments.keep)
    if rows.empty:
        raise SystemExit(f"{ROWS.path} has no rows of the present sources; nothing written")
    write(rows, digest, DOCS)


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="Diagnose hidden effects blind.")
    parser.add_argument("seeds", nargs="?", type=int, default=20, help="repetitions of each world")
    parser.add_argument("--minutes", type=float, default=float("inf"), help="start none later")
    parser.add_argument("--only", choices=("", *KINDS), default="", help="worlds of one kind")
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--keep", action="store_true", help="stale rows count as done")
    parser.add_argument("--page", action="store_true", help="write the page from the store only")
    return parser.parse_args()


if __name__ == "__main__":
    main(_arguments())
