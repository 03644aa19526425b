"""Does ``diagnose`` find what is hidden, and nothing else? Writes docs/blind.md and its pictures.

Every world is simulated by :mod:`frictioncli.simulator`, which shares no formula with the
catalogue, and diagnosed blind. Results are kept in ``build/blind.csv``; a second call goes on where
the first one stopped, and repeats what changed sources have made stale.

Usage: OMP_NUM_THREADS=1 python -m tests.studies.blind [SEEDS] [--minutes M] [--only KIND]
       [--processes N] [--keep] [--page]
"""

import argparse
import csv
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
from tests.studies.blind_worlds import KEY, KINDS, ROOT, World, sources, worlds

STORE = ROOT / "build" / "blind.csv"
DOCS = ROOT / "docs"


def stored(digest: str, *, keep: bool) -> pd.DataFrame:
    """Return the last row of each world, as text; stale ones only if they are to be kept."""
    if not STORE.exists():
        return pd.DataFrame(columns=list(COLUMNS), dtype=str)
    rows = pd.read_csv(STORE, dtype=str, keep_default_na=False).reindex(columns=list(COLUMNS))
    rows = rows[rows["sources"].fillna("") != ""]
    fresh = rows["sources"] == digest
    if not keep:
        rows, fresh = rows[fresh], fresh[fresh]
    # a row of these sources goes before a later one of others
    order = fresh.astype(int).sort_values(kind="stable").index
    return rows.loc[order].fillna("").drop_duplicates(list(KEY), keep="last", ignore_index=True)


def run(missing: Iterable[World], digest: str, processes: int, minutes: float) -> None:
    """Examine worlds and store their rows; hand out none any more after so many minutes."""
    until = time.monotonic() + 60.0 * minutes
    _prepare_store()
    waiting = iter(missing)
    with (
        ProcessPoolExecutor(processes) as pool,
        STORE.open("a", encoding="utf-8", newline="") as stream,
    ):
        writer = csv.DictWriter(stream, COLUMNS)
        tasks: set[Future[dict[str, object]]] = set()
        while True:
            if time.monotonic() < until:
                free = processes - len(tasks)
                tasks |= {pool.submit(examined, world, digest) for world in islice(waiting, free)}
            if not tasks:
                break
            done, tasks = wait(tasks, return_when=FIRST_COMPLETED)
            for task in done:
                writer.writerow(task.result())
            stream.flush()


def _prepare_store() -> None:
    """Give the store the columns of this study; rows of an earlier one keep what they have."""
    STORE.parent.mkdir(exist_ok=True)
    header = ",".join(COLUMNS)
    if STORE.exists():
        with STORE.open(encoding="utf-8") as stream:
            if stream.readline().strip() == header:
                return
        rows = pd.read_csv(STORE, dtype=str, keep_default_na=False)
        rows.reindex(columns=list(COLUMNS)).to_csv(STORE, index=False)
    else:
        STORE.write_text(header + "\n", encoding="utf-8")


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
        rows = stored(digest, keep=arguments.keep)
        done = set(zip(*(rows[name] for name in KEY), strict=True))
        asked = [world for world in worlds(arguments.seeds) if arguments.only in ("", world.kind)]
        missing = [world for world in asked if world.key not in done]
        run(missing, digest, arguments.processes, arguments.minutes)
    rows = stored(digest, keep=arguments.keep)
    if rows.empty:
        raise SystemExit(f"{STORE} has no rows of the present sources; nothing written")
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
