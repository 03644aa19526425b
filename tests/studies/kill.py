"""Runs killed at random moments; writes its count into docs/robustness.md.

Usage: python -m tests.studies.kill [KILLS] [--seed SEED]
"""

import argparse
import random
import tempfile
from pathlib import Path

from tests.robustness.kills import Worlds, killed_run
from tests.robustness.runs import digests, outputs
from tests.studies.robustness_page import put

LEVELS = (25, 32, 39, 46, 53)


def main() -> None:
    """Kill, check, run again, check; over and over."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("kills", type=int, nargs="?", default=60)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    draw = random.Random(asked.seed)
    hit = mixed = left = 0
    with tempfile.TemporaryDirectory() as folder:
        worlds = Worlds(Path(folder), LEVELS)
        while hit < asked.kills:
            seconds = draw.uniform(0.1, 1.0) * worlds.duration
            work, running = killed_run(worlds, seconds, fresh=draw.random() < 0.5)
            worlds.check(work)
            found = digests(work) if work.exists() else {}
            names = [p.relative_to(work).as_posix() for p in outputs(work)] if found else []
            changed = [name for name in names if found[name] == worlds.after[name]]
            mixed += 0 < len(changed) < len(worlds.after)
            left += any(name.startswith(".") for name in found)
            worlds.check_next_run(work)
            hit += running
            print(f"{hit} of {asked.kills}, after {seconds:.2f} s", flush=True)
    put(
        "kill",
        f"{hit} runs killed while they worked; {mixed} of them with some outputs made anew and"
        f" others not, {left} with drafts or a lock left behind. No output was damaged, and every"
        " next run completed with the bytes of an undisturbed one.",
    )


if __name__ == "__main__":
    main()
