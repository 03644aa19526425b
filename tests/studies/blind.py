"""Does ``diagnose`` find what is hidden, and nothing else? Writes docs/blind.md and its pictures.

Every joint is simulated by :mod:`frictioncli.simulator`, which shares no formula with the
catalogue, does many small things besides, and is diagnosed blind. Results are kept in
``build/blind.csv``; a second call goes on where the first one stopped, and repeats what changed
sources have made stale.

Usage: OMP_NUM_THREADS=1 python -m tests.studies.blind [--worlds N] [--minutes M]
       [--kinds K ...] [--effects E ...] [--seeds S ...] [--sizes S ...] [--jobs N] [--write]
"""

import argparse
import time
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from itertools import islice
from pathlib import Path

from tests.studies.blind_examined import COLUMNS, examined
from tests.studies.blind_figures import confusion_picture, power_picture
from tests.studies.blind_gates import gate_table
from tests.studies.blind_line import line
from tests.studies.blind_page import page
from tests.studies.blind_rows import Joint, joint_of, joints_of
from tests.studies.blind_worlds import KEY, KINDS, World, plan, sources
from tests.studies.rows import ROOT, Rows

STORE = ROOT / "build" / "blind.csv"
DOCS = ROOT / "docs"


def run(rows: Rows, missing: Iterable[World], digest: str, jobs: int, minutes: float) -> None:
    """Examine joints, store their rows and print a line each; start none after so many minutes."""
    until = time.monotonic() + 60.0 * minutes
    waiting = iter(missing)
    with rows.adding() as add:
        if jobs == 1:
            for world in waiting:
                if time.monotonic() > until:
                    break
                _keep(add, examined(world, digest))
            return
        with ProcessPoolExecutor(jobs) as pool:
            tasks: set[Future[dict[str, object]]] = set()
            while True:
                if time.monotonic() < until:
                    free = jobs - len(tasks)
                    tasks |= {pool.submit(examined, one, digest) for one in islice(waiting, free)}
                if not tasks:
                    break
                done, tasks = wait(tasks, return_when=FIRST_COMPLETED)
                for task in done:
                    _keep(add, task.result())


def _keep(add: Callable[[dict[str, object]], None], row: dict[str, object]) -> None:
    add(row)
    print(line(joint_of({name: str(row.get(name, "")) for name in COLUMNS})), flush=True)


def chosen(arguments: argparse.Namespace) -> list[World]:
    """Return the joints of the plan that are asked for."""
    return [
        world
        for world in plan()
        if (not arguments.kinds or world.kind in arguments.kinds)
        and (not arguments.effects or set(arguments.effects) & set(world.hidden.split("+")))
        and (not arguments.seeds or world.seed in arguments.seeds)
        and (not arguments.sizes or world.size in arguments.sizes)
        and (not arguments.path or world.path == arguments.path)
        and (not arguments.protocol or world.protocol == arguments.protocol)
    ][: arguments.worlds]


def main(arguments: argparse.Namespace) -> None:
    """Run what is missing of what is asked for, print the gates, and write the page if wanted."""
    digest = sources()
    rows = Rows(arguments.store, COLUMNS, KEY)
    worlds = chosen(arguments)
    done = rows.done(digest, keep=arguments.keep)
    missing = [world for world in worlds if world.key not in done]
    run(rows, missing, digest, arguments.jobs, arguments.minutes)
    found = rows.read(digest, keep=arguments.keep)
    asked = {world.key for world in worlds}
    joints = [one for one in joints_of(found) if one.world.key in asked]
    if not joints:
        raise SystemExit(f"{rows.path} has no rows of the present sources; nothing written")
    print(f"\n{len(joints)} joints\n{gate_table(joints)}")
    if arguments.write:
        write(joints, stale=int((found["sources"] != digest).sum()), folder=DOCS)


def write(joints: Sequence[Joint], *, stale: int, folder: Path) -> None:
    """Write the page and its pictures."""
    confusion_picture(joints, folder / "blind-confusion.png")
    power_picture(joints, folder / "blind-power.png")
    (folder / "blind.md").write_text(page(joints, stale), encoding="utf-8")


def arguments_of(words: Sequence[str] | None = None) -> argparse.Namespace:
    """Return the arguments of the command line."""
    parser = argparse.ArgumentParser(description="Diagnose hidden effects blind.")
    parser.add_argument("--worlds", type=int, help="greatest number of joints; else the plan's")
    parser.add_argument("--kinds", nargs="+", choices=KINDS, help="joints of these kinds")
    parser.add_argument("--effects", nargs="+", help="joints in which any of these is hidden")
    parser.add_argument("--seeds", nargs="+", type=int, help="these repetitions")
    parser.add_argument("--sizes", nargs="+", type=float, help="these sizes [N·m]")
    parser.add_argument("--path", choices=("bins", "logs"), help="torques per bin, or logs")
    parser.add_argument("--protocol", choices=("paper", "enriched"))
    parser.add_argument("--minutes", type=float, default=float("inf"), help="start none later")
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    parser.add_argument("--keep", action="store_true", help="stale rows count as done")
    parser.add_argument("--store", type=Path, default=STORE, help="file of the rows")
    parser.add_argument("--write", action="store_true", help="write docs/blind.md")
    return parser.parse_args(words)


if __name__ == "__main__":
    main(arguments_of())
