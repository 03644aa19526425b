"""The page docs/benchmarks.md, from the stored rounds and nothing else."""

import os
import platform
from collections.abc import Iterable
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from tests.studies import bench_growth, minimum
from tests.studies.bench_rounds import ROOT, Measured, stored
from tests.studies.benching import MEGABYTE, Goal, Work

PAGE = ROOT / "docs" / "benchmarks.md"
LIBRARIES = ("numpy", "scipy", "pandas", "pyarrow", "polars", "duckdb", "typer")

_HEAD = """\
# Speed and memory

Measured, not computed: every work is done by several programs in turn, round after round, each in
a fresh process. A ratio is taken inside each round; given are the median and, in brackets, the
least and greatest. *must* is promised, *reach* is aimed at. A check after every round sees to it
that all contestants had the same result. Peak is the memory of the process, or of the largest of
its processes, in MB of 1e6 bytes; inputs are in the page cache. `make bench` measures and writes
this page.

"""

_MINIMUM = """\
## The global minimum

Random joints, each with parameters, temperatures, speeds, loads, weights and noise of its own;
`tests/studies/minimum.py` holds the fit, which is given no start, against a dense grid and seven
polished starts. As low as these, to 1e-9 of the sum of squares: {}.
"""


def write(works: Iterable[Work], store: Path) -> None:
    """Write the page of the works from the rows in ``store``."""
    sections = [section(work, stored(work, store)) for work in works]
    parts = [_HEAD + machine(), *sections, _MINIMUM.format(minimum.text()), bench_growth.section()]
    PAGE.write_text("\n".join(parts).rstrip() + "\n", encoding="utf-8")


def machine() -> str:
    """Return what matters of this machine and its software."""
    processor = next(
        line.partition(":")[2].strip()
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        if line.startswith("model name")
    )
    memory = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") / 2**30
    system = platform.freedesktop_os_release()["PRETTY_NAME"]
    threads = os.environ.get("OMP_NUM_THREADS", "not limited")
    return (
        f"Machine: {processor}, {os.cpu_count()} cores, {memory:.0f} GiB; {system}, Python"
        f" {platform.python_version()}, {', '.join(_versions())}; threads of linear algebra:"
        f" {threads}.\n"
    )


def _versions() -> list[str]:
    found = []
    for name in LIBRARIES:
        try:
            found.append(f"{name} {version(name)}")
        except PackageNotFoundError:
            continue
    return found


def section(work: Work, measured: Measured) -> str:
    """Return the part of the page that tells of one work."""
    lines = [f"## {work.title}", ""]
    lines += [f"**Disagreement:** {fault}\n" for fault in measured.faults]
    if not measured.rounds:
        return "\n".join([*lines, "Not measured for this state of the package.", ""])
    lines += ["| figure | must | reach | median | |", "|---|---|---|---|---|"]
    lines += [_figure(goal, measured) for goal in work.goals]
    lines += [
        "",
        "| contestant | wall [s] | CPU [s] | peak [MB] | command |",
        "|---|---|---|---|---|",
    ]
    for contestant in work.contestants:
        wall, cpu, peak = (measured.median(contestant.name, m) for m in ("wall", "cpu", "peak"))
        lines.append(
            f"| {contestant.name} | {wall:.3g} | {cpu:.3g} | {peak / MEGABYTE:.0f}"
            f" | `{contestant.shown}` |"
        )
    lines += ["", f"{len(measured.rounds)} rounds. {measured.agreed}{_disturbed(measured)}", ""]
    return "\n".join(lines)


def _figure(goal: Goal, measured: Measured) -> str:
    median, low, high = measured.figures(goal)
    sign = "≤" if goal.at_most else "≥"
    reach = "" if goal.reach is None else f"{sign} {_number(goal.reach)}"
    return (
        f"| {goal.text} | {sign} {_number(goal.must)} | {reach}"
        f" | {_number(median)} [{_number(low)} .. {_number(high)}] | {goal.verdict(median)} |"
    )


def _number(value: float) -> str:
    if abs(value) >= 1e4:
        return f"{value:.3g}".replace("e+0", "e")
    return f"{value:.3g}" if abs(value) < 1000 else f"{value:.0f}"


def _disturbed(measured: Measured) -> str:
    if measured.load < 0.5:
        return ""
    return f" Other work ran on the machine (load {measured.load:.1f} before a round)."
