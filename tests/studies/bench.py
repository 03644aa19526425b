"""Measure the works whose speed and memory are promised; write docs/benchmarks.md.

Rounds that are stored for the present package are not repeated, so that a second call goes on where
the first one stopped. The page is written from what is stored.

Usage: python -m tests.studies.bench [--only NAME ...] [--rounds N] [--small] [--again]
       [--page] [--data FOLDER] [--store FOLDER]
"""

import argparse
from itertools import chain
from pathlib import Path

from tests.studies import (
    bench_fit,
    bench_ingest,
    bench_motion,
    bench_page,
    bench_schedule,
    bench_start,
)
from tests.studies.bench_rounds import STORE, measure, stored
from tests.studies.benching import Work

STUDIES = [bench_ingest, bench_motion, bench_fit, bench_schedule, bench_start]

ROUNDS = 5


def works(small: bool) -> list[Work]:
    """Return the works of all studies; ``small`` ones are for a quick look."""
    return list(chain.from_iterable(study.works(small) for study in STUDIES))


def main() -> int:
    """Measure what is asked for, print it, and write the page; 1 if something disagreed."""
    asked = _arguments()
    store = asked.store / "small" if asked.small else asked.store
    known = works(asked.small)
    chosen = [] if asked.page else [w for w in known if not asked.only or w.name in asked.only]
    for work in chosen:
        if asked.again:
            (store / f"{work.name}.jsonl").unlink(missing_ok=True)
        measured = measure(work, rounds=asked.rounds, store=store, data=asked.data)
        print(bench_page.section(work, measured), flush=True)
    if not asked.small and asked.store == STORE:
        bench_page.write(known, store)
    return int(any(stored(work, store).faults for work in known))


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    names = sorted({work.name for small in (False, True) for work in works(small)})
    parser.add_argument("--only", nargs="+", choices=names, metavar="NAME", help=", ".join(names))
    parser.add_argument("--rounds", type=int, default=ROUNDS, help="Rounds of each work.")
    parser.add_argument("--small", action="store_true", help="Small inputs, no page.")
    parser.add_argument("--again", action="store_true", help="Forget the stored rounds first.")
    parser.add_argument("--page", action="store_true", help="Measure nothing, write the page.")
    parser.add_argument("--data", type=Path, help="Folder for inputs; some are large.")
    parser.add_argument("--store", type=Path, default=STORE, help="Folder of the rows.")
    return parser.parse_args()


if __name__ == "__main__":
    raise SystemExit(main())
