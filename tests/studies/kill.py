"""Runs and challenges killed at random moments; writes their counts into docs/robustness.md.

Usage: python -m tests.studies.kill [KILLS] [--challenges KILLS] [--seed SEED]
"""

import argparse
import random
import shutil
import tempfile
import time
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from tests.robustness.kills import Worlds, killed_run
from tests.robustness.runs import check_readable, digests, finished, outputs, started
from tests.studies.robustness_page import put

LEVELS = (25, 32, 39, 46, 53)
PLANTED = ("--effect", "direction_asymmetry:2", "--effect", "stroke_bump:2")
TABLE = "challenge.parquet"


def main() -> None:
    """Kill, check, run again, check; over and over."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("kills", type=int, nargs="?", default=60)
    parser.add_argument("--challenges", type=int, default=20)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    draw = random.Random(asked.seed)
    with tempfile.TemporaryDirectory() as folder:
        worlds = Worlds(Path(folder), LEVELS)
        if asked.kills:
            put("kill", _runs(worlds, asked.kills, draw))
        if asked.challenges:
            put("kill challenge", _challenges(worlds, asked.challenges, draw))


def _runs(worlds: Worlds, kills: int, draw: random.Random) -> str:
    hit = mixed = left = 0
    while hit < kills:
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
        print(f"run: {hit} of {kills}, after {seconds:.2f} s", flush=True)
    return (
        f"{hit} runs killed while they worked; {mixed} of them with some outputs made anew and"
        f" others not, {left} with drafts or a lock left behind. No output was damaged, and every"
        " next run completed with the bytes of an undisturbed one."
    )


def _challenges(worlds: Worlds, kills: int, draw: random.Random) -> str:
    """Kill ``challenge`` and call it again: rows that were there stay, all others are made."""
    work = worlds.folder / "challenge"
    words = ("challenge", worlds.logs, "-w", work, *PLANTED)
    begin = time.monotonic()
    first = finished(*words)
    assert first.returncode == 0, first.stderr
    duration = time.monotonic() - begin
    whole, rows = _without_table(work), _rows(work)
    hit = part = left = 0
    while hit < kills:
        shutil.rmtree(work)
        seconds = draw.uniform(0.1, 1.0) * duration
        process = started(*words)
        time.sleep(seconds)
        hit += process.poll() is None
        process.kill()
        process.communicate()
        for path in outputs(work) if work.exists() else ():
            check_readable(path)
        known = _rows(work) if (work / TABLE).exists() else rows.slice(0, 0)
        assert _same(known, rows.slice(0, known.num_rows))
        part += 0 < known.num_rows < rows.num_rows
        left += work.exists() and any(name.startswith(".") for name in digests(work))
        spent = _seconds(work, known.num_rows)
        again = finished(*words)
        assert again.returncode == 0, again.stderr
        assert _without_table(work) == whole
        assert _same(_rows(work), rows)
        # what was known was not done again
        assert _seconds(work, known.num_rows) == spent
        print(f"challenge: {hit} of {kills}, after {seconds:.2f} s", flush=True)
    return (
        f"{hit} challenges killed while they worked; {part} of them with some rows of their table"
        f" written, {left} with drafts or a lock left behind. No output was damaged; every next"
        " call kept the rows that were there and completed with the rows and outputs of an"
        " undisturbed one."
    )


def _without_table(work: Path) -> dict[str, str]:
    """Return the digests of all outputs but the table, which states processor times."""
    return {name: digest for name, digest in digests(work).items() if name != TABLE}


def _rows(work: Path) -> pa.Table:
    return pq.read_table(work / TABLE).drop_columns("seconds").replace_schema_metadata()


def _same(one: pa.Table, other: pa.Table) -> bool:
    """Return whether two tables hold the same; the order of their dictionaries may differ."""
    return one.column_names == other.column_names and one.to_pylist() == other.to_pylist()


def _seconds(work: Path, count: int) -> list[float | None]:
    if not count:
        return []
    return pq.read_table(work / TABLE, columns=["seconds"]).column(0).to_pylist()[:count]


if __name__ == "__main__":
    main()
