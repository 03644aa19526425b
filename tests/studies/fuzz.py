"""Damaged inputs by the hundred thousand: each is read or refused, and what is read is true.

Input ``n`` of a form is made from the number n alone (:mod:`tests.studies.fuzz_damage` for logs,
:mod:`tests.studies.fuzz_forms` for all others). Counts are kept in ``build/fuzz*.json``; a second
call goes on where the first one stopped, and begins anew when the program has changed. Inputs that
something was found with are kept as files and tried first. Writes its tables into
docs/robustness.md.

Usage: python -m tests.studies.fuzz [FORM...] [--inputs N] [--minutes M] [--processes P]
       [--only NUMBER]

``--inputs`` and ``--minutes`` hold for each form; without a form all are tried.
"""

import argparse
import hashlib
import json
import os
import tempfile
import time
from collections import Counter
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path

from tests.studies.fuzz_corpus import corpus, tried_again
from tests.studies.fuzz_forms import FORMS, prepare
from tests.studies.fuzz_layouts import layouts
from tests.studies.fuzz_process import GOOD, Finding, examine_here, examined
from tests.studies.robustness_page import put, row

ROOT = Path(__file__).parents[2]
LOGS = "logs"
ALL = (LOGS, *FORMS)
ROUND = 100
ROUNDS = {LOGS: 1_000, "work": 20, "options": 20}
"""Inputs after which the counts are kept; fewer of those that take long."""
INPUTS = 100_000


@dataclass(slots=True)
class Tally:
    """What became of the inputs so far: (layout, outcome) -> how many, and what went wrong."""

    inputs: int = 0
    counts: Counter[tuple[str, str]] = field(default_factory=Counter)
    findings: list[Finding] = field(default_factory=list)


def store_of(form: str) -> Path:
    """Return the file with the counts of a form."""
    return ROOT / "build" / ("fuzz.json" if form == LOGS else f"fuzz-{form}.json")


def sources(form: str) -> str:
    """Return what the results depend on: of logs, all that reads and inspects; and the study."""
    digest = hashlib.sha256()
    package = ROOT / "frictioncli"
    files = [*package.glob("*.py"), *(ROOT / "tests" / "studies").glob("fuzz*.py")]
    for part in ("logs", "inspection", "pairs") if form == LOGS else ("",):
        files += chain((package / part).rglob("*.py"), (package / part).rglob("*.c"))
    for path in sorted(files):
        digest.update(path.read_bytes())
    return digest.hexdigest()


def stored(form: str, digest: str | None = None) -> Tally:
    """Return the tally of a form, an empty one where there is none of these sources."""
    if not store_of(form).exists():
        return Tally()
    kept = json.loads(store_of(form).read_text(encoding="utf-8"))
    if digest is not None and kept["sources"] != digest:
        return Tally()
    counts = Counter({(layout, outcome): n for layout, outcome, n in kept["counts"]})
    return Tally(kept["inputs"], counts, [Finding(*one) for one in kept["findings"]])


def store(form: str, tally: Tally, digest: str) -> None:
    """Keep the tally."""
    store_of(form).parent.mkdir(exist_ok=True)
    counts = [[*key, n] for key, n in sorted(tally.counts.items())]
    kept = {
        "sources": digest,
        "inputs": tally.inputs,
        "counts": counts,
        "findings": [[f.number, f.layout, f.damage, f.outcome, f.text] for f in tally.findings],
    }
    store_of(form).write_text(json.dumps(kept, indent=1), encoding="utf-8")


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


def forms_table() -> str:
    """Return the counts of all forms but logs as Markdown."""
    lines = [
        "| form | inputs | read or done | refused | findings | repeated by |",
        "|---|---:|---:|---:|---:|---|",
    ]
    for form in FORMS:
        tally = stored(form)
        if not tally.inputs and (former := row("forms", f"| {form} |")):
            lines.append(former)  # not tried here
            continue
        good = [tally.counts[form, outcome] for outcome in GOOD]
        cells = [tally.inputs, *good, len(tally.findings)]
        counts = " | ".join(f"{count:,}" for count in cells)
        call = f'`make fuzz FUZZ="{form} --inputs {tally.inputs}"`'
        lines.append(f"| {form} | {counts} | {call} |")
    return "\n".join(lines)


def tried(form: str, inputs: int, minutes: float, processes: int, base: Path) -> Tally:
    """Try inputs of a form until they or the minutes are used up."""
    digest = sources(form)
    tally = stored(form, digest)
    until = time.monotonic() + 60 * minutes
    while tally.inputs < inputs and time.monotonic() < until:
        end = min(tally.inputs + ROUNDS.get(form, ROUND), inputs)
        for one in examined(range(tally.inputs, end), processes, form, base):
            tally.counts[one.layout, one.outcome] += 1
            if one.outcome not in GOOD:
                tally.findings.append(one)
                print(f"{form} {one.number} {one.damage}: {one.outcome}\n  {one.text[-900:]}")
        tally.inputs = end
        store(form, tally, digest)
        print(f"{form}: {tally.inputs:,} inputs, {len(tally.findings)} findings", flush=True)
    return tally


def main() -> None:
    """Try what is kept, then every form."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("forms", nargs="*", choices=[*ALL, []], default=ALL)
    parser.add_argument("--inputs", type=int, default=INPUTS)
    parser.add_argument("--minutes", type=float, default=float("inf"))
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--only", type=int, help="examine one input and show what happens")
    asked = parser.parse_args()
    wrong = [text for text in map(tried_again, corpus()) if text]
    print(f"{len(corpus())} inputs of former findings, {len(wrong)} findings", *wrong, sep="\n")
    with tempfile.TemporaryDirectory(prefix="fuzz-base-") as name:
        base = Path(name)
        if set(asked.forms) - {LOGS}:
            prepare(base, rich="work" in asked.forms)
        if asked.only is not None:
            for form in asked.forms:
                print(examine_here(asked.only, form, base))
            return
        found = 0
        for form in asked.forms:
            tally = tried(form, asked.inputs, asked.minutes, asked.processes, base)
            found += len(tally.findings)
            if form == LOGS:
                put("fuzz", table(tally))
    put("forms", forms_table())
    if found or wrong:
        raise SystemExit(1)


if __name__ == "__main__":
    main()
