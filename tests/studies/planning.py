"""Does a plan settle what a thin experiment leaves open? Writes docs/planning.md's table.

Thin experiments on simulated joints are diagnosed; where the verdict is ambiguous, the plan, the
thin experiment again and blocks at random, all of the same length, are simulated on the same joint
and diagnosed together with it. Rows are kept in ``build/planning.csv``; a second call goes on where
the first one stopped, and repeats what changed sources have made stale.

Usage: OMP_NUM_THREADS=1 python -m tests.studies.planning [SEEDS] [--minutes M] [--keep] [--page]
"""

import argparse
import time

from tests.studies.planning_examined import COLUMNS, examined
from tests.studies.planning_page import page
from tests.studies.planning_worlds import KEY, sources, worlds
from tests.studies.rows import ROOT, Rows

ROWS = Rows(ROOT / "build" / "planning.csv", COLUMNS, KEY)
PAGE = ROOT / "docs" / "planning.md"


def run(seeds: int, minutes: float, digest: str, done: set[tuple[str, ...]]) -> None:
    """Examine the worlds that are not done; begin none after so many minutes."""
    until = time.monotonic() + 60.0 * minutes
    with ROWS.adding() as add:
        for world in worlds(seeds):
            if time.monotonic() > until:
                break
            if world.key not in done:
                add(examined(world, digest))


def main(arguments: argparse.Namespace) -> None:
    """Run what is missing, then write the page from what is there."""
    digest = sources()
    if not arguments.page:
        done = ROWS.done(digest, keep=arguments.keep)
        run(arguments.seeds, arguments.minutes, digest, done)
    rows = ROWS.read(digest, keep=arguments.keep)
    if rows.empty:
        raise SystemExit(f"{ROWS.path} has no rows of the present sources; nothing written")
    PAGE.write_text(page(rows, digest, PAGE.read_text(encoding="utf-8")), encoding="utf-8")


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="Plan for thin experiments.")
    parser.add_argument("seeds", nargs="?", type=int, default=3, help="repetitions of each world")
    parser.add_argument("--minutes", type=float, default=float("inf"), help="start none later")
    parser.add_argument("--keep", action="store_true", help="stale rows count as done")
    parser.add_argument("--page", action="store_true", help="write the page from the store only")
    return parser.parse_args()


if __name__ == "__main__":
    main(_arguments())
