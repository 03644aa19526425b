"""Damaged logs by the hundred thousand: each is read or refused, and what is read is true.

Input ``n`` is made from the number n alone (:mod:`tests.studies.fuzz_damage`). Counts are kept in
``build/fuzz.json``; a second call goes on where the first one stopped, and begins anew when the
program has changed. Writes its table into docs/robustness.md.

Usage: python -m tests.studies.fuzz [--inputs N] [--minutes M] [--processes P] [--only NUMBER]
"""

import argparse
import hashlib
import json
import os
import time
from collections import Counter
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path

from tests.studies.fuzz_layouts import layouts
from tests.studies.fuzz_process import GOOD, Finding, examine_here, examined
from tests.studies.robustness_page import put

ROOT = Path(__file__).parents[2]
STORE = ROOT / "build" / "fuzz.json"
ROUND = 1_000
INPUTS = 100_000


@dataclass(slots=True)
class Tally:
    """What became of the inputs so far: (layout, outcome) -> how many, and what went wrong."""

    inputs: int = 0
    counts: Counter[tuple[str, str]] = field(default_factory=Counter)
    findings: list[Finding] = field(default_factory=list)


def sources() -> str:
    """Return what the results depend on: all that reads and inspects logs, and the study."""
    digest = hashlib.sha256()
    package = ROOT / "frictioncli"
    files = [*package.glob("*.py"), *(ROOT / "tests" / "studies").glob("fuzz*.py")]
    for part in ("logs", "inspection", "pairs"):
        files += chain((package / part).rglob("*.py"), (package / part).rglob("*.c"))
    for path in sorted(files):
        digest.update(path.read_bytes())
    return digest.hexdigest()


def stored(digest: str) -> Tally:
    """Return the tally of these sources; an empty one where there is none."""
    if not STORE.exists():
        return Tally()
    kept = json.loads(STORE.read_text(encoding="utf-8"))
    if kept["sources"] != digest:
        return Tally()
    counts = Counter({(layout, outcome): n for layout, outcome, n in kept["counts"]})
    return Tally(kept["inputs"], counts, [Finding(*one) for one in kept["findings"]])


def store(tally: Tally, digest: str) -> None:
    """Keep the tally."""
    STORE.parent.mkdir(exist_ok=True)
    counts = [[*key, n] for key, n in sorted(tally.counts.items())]
    kept = {
        "sources": digest,
        "inputs": tally.inputs,
        "counts": counts,
        "findings": [[f.number, f.layout, f.damage, f.outcome, f.text] for f in tally.findings],
    }
    STORE.write_text(json.dumps(kept, indent=1), encoding="utf-8")


def table(tally: Tally) -> str:
    """Return the counts as Markdown."""
    outcomes = [*GOOD, *sorted({outcome for _, outcome in tally.counts} - set(GOOD))]
    names = [layout.name for layout in layouts()]
    lines = [
        f"{tally.inputs:,} inputs; {len(tally.findings)} findings.",
        "",
        "| layout | " + " | ".join(outcomes) + " |",
        "|---|" + "---:|" * len(outcomes),
    ]
    for name in names:
        cells = [f"{tally.counts[name, outcome]:,}" for outcome in outcomes]
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    for one in tally.findings[:20]:
        lines += ["", f"- input {one.number}, {one.layout}, {one.damage}: {one.outcome}"]
    return "\n".join(lines)


def main() -> None:
    """Run until the inputs or the minutes are used up."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--inputs", type=int, default=INPUTS)
    parser.add_argument("--minutes", type=float, default=float("inf"))
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--only", type=int, help="examine one input and show what happens")
    asked = parser.parse_args()
    if asked.only is not None:
        print(examine_here(asked.only))
        return
    digest = sources()
    tally = stored(digest)
    until = time.monotonic() + 60 * asked.minutes
    while tally.inputs < asked.inputs and time.monotonic() < until:
        end = min(tally.inputs + ROUND, asked.inputs)
        for one in examined(range(tally.inputs, end), asked.processes):
            tally.counts[one.layout, one.outcome] += 1
            if one.outcome not in GOOD:
                tally.findings.append(one)
                print(f"{one.number} {one.layout}, {one.damage}: {one.outcome}\n  {one.text}")
        tally.inputs = end
        store(tally, digest)
        print(f"{tally.inputs:,} inputs, {len(tally.findings)} findings", flush=True)
    put("fuzz", table(tally))
    if tally.findings:
        raise SystemExit(1)


if __name__ == "__main__":
    main()
