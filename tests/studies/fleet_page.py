"""What the study of fleets has measured, as text: results, scaling, and 100,000 joints on paper."""

import statistics
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from tests.studies.bench_page import machine
from tests.studies.fleet_world import DAY_TO_DAY, KINDS, WEAR, Member

_BEGIN, _END = "<!-- measured -->\n", "<!-- /measured -->"

_JOINTS = 100_000
_DAYS = 52
_CORES = (64, 256, 1024)


@dataclass(frozen=True, slots=True, kw_only=True)
class Process:
    """Wall and processor time [s] and peak memory of the largest process [bytes]."""

    wall: float
    cpu: float
    peak: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Costs:
    """What the chain costs on a full-size log.

    Attributes
    ----------
    runs : int
        Its days.
    process : Process
        ``frictioncli run`` as a whole.
    seconds : mapping of str to float
        Processor time per stage. [s]
    logs, results, samples : int
        Size of the logs, of the work folder, and of ``samples.parquet`` in it. [bytes]
    """

    runs: int
    process: Process
    seconds: Mapping[str, float]
    logs: int
    results: int
    samples: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Measures:
    """All that the page tells."""

    members: list[Member]
    rows: pd.DataFrame
    here: Process
    there: Process
    files: int
    scaling: list[tuple[float, float]]
    full: Costs
    growth: Mapping[int, Mapping[str, float]]
    load: float


def write(measures: Measures, page: Path) -> None:
    """Put what was measured between the marks of the page."""
    text = page.read_text(encoding="utf-8")
    before, rest = text.split(_BEGIN)
    after = rest.split(_END)[1]
    parts = [_machine(measures), _results(measures), _scaling(measures), _paper(measures)]
    page.write_text(before + _BEGIN + "\n\n".join(parts) + "\n" + _END + after, encoding="utf-8")


def _machine(measures: Measures) -> str:
    busy = f" Other work ran on it (load {measures.load:.1f})." if measures.load > 2.5 else ""
    return machine().strip() + busy


def _results(measures: Measures) -> str:
    rows = measures.rows.assign(kind=[member.kind for member in measures.members])
    done = rows[rows["status"] == "done"]
    away = (done["change_low"] > 0) | (done["change_high"] < 0)
    worn = done["kind"] == "worn"
    holds = done["change_low"].lt(WEAR) & done["change_high"].gt(WEAR)
    kinds = rows["kind"].value_counts().reindex(KINDS, fill_value=0)
    lines = [
        "## 200 joints, here and on Dask" if len(rows) == 200 else f"## {len(rows)} joints",
        f"{len(rows)} simulated joints of six short runs each: {kinds['sound']} sound,"
        f" {kinds['worn']} whose last run has {WEAR:g} N·m more friction, {kinds['lagging']} whose"
        f" friction is an hour behind the motor's temperature, {kinds['bad']} with logs of no use."
        f" Every run of every joint also has an offset of its own, {DAY_TO_DAY:g} N·m (1 sigma).",
        "",
        f"- Two processes here and two workers of Dask: all {measures.files:,} files equal byte for"
        f" byte. {measures.here.wall:.0f} s here ({measures.here.cpu:.0f} s of processor),"
        f" {measures.there.wall:.0f} s on Dask. Without reports.",
        f"- Failed: {_failed(rows)}.",
        f"- Wear: {int((away & worn).sum())} of {int(worn.sum())} have an interval of `change` that"
        f" excludes 0, {int((holds & worn).sum())} one that holds {WEAR:g} N·m. Of the joints"
        f" without wear {int((away & ~worn).sum())} of {int((~worn).sum())} exclude 0.",
        f"- Verdicts: {_verdicts(done)}.",
    ]
    return "\n".join(lines)


def _failed(rows: pd.DataFrame) -> str:
    bad, failed = rows["kind"] == "bad", rows["status"] == "failed"
    return (
        f"{int((bad & failed).sum())} of {int(bad.sum())} bad joints, each with its reason, and"
        f" {int((failed & ~bad).sum())} of {int((~bad).sum())} others"
    )


def _verdicts(done: pd.DataFrame) -> str:
    told = []
    for kind, own in done.groupby("kind"):
        counts = own["verdict"].value_counts()
        text = ", ".join(f"{count} `{verdict}`" for verdict, count in counts.items())
        told.append(f"{kind}: {text}")
    return "; ".join(told)


def _scaling(measures: Measures) -> str:
    ratios = [one / two for one, two in measures.scaling]
    rounds = ", ".join(f"{one:.0f} s and {two:.0f} s" for one, two in measures.scaling)
    return (
        "## From one process to two\n"
        f"Twenty joints, one process and two, in {len(ratios)} rounds that take turns: {rounds}."
        f" Two are {statistics.median(ratios):.2f} times as fast ({min(ratios):.2f} to"
        f" {max(ratios):.2f})."
    )


def _paper(measures: Measures) -> str:
    full = measures.full
    per_run = {name: seconds / full.runs for name, seconds in full.seconds.items()}
    slopes = _slopes(measures.growth)
    stages = ["ingest", "pair", "separate", "fit", "diagnose", "simulate", "evaluate"]
    header = "| pairs | " + " | ".join(stages) + " |"
    rows = [
        f"| {pairs} | " + " | ".join(f"{seconds.get(stage, 0):.2f}" for stage in stages) + " |"
        for pairs, seconds in measures.growth.items()
    ]
    slope = "| slope | " + " | ".join(f"{slopes.get(stage, 0):.1f}" for stage in stages) + " |"
    linear = sum(per_run[name] for name in ("ingest", "pair", "separate"))
    # what is done once per joint grows with its pairs
    times = _DAYS / full.runs
    fit = {name: full.seconds[name] * times ** slopes[name] for name in ("fit", "evaluate")}
    diagnosis = full.seconds["diagnose"] * times ** slopes["diagnose"]
    base = _DAYS * linear + sum(fit.values()) + full.seconds["report"]
    cases = {
        "13 fleets of four days each": _DAYS / 4 * full_cost(full, slopes, 4),
        "one fleet of all days, no diagnosis": base,
        "one fleet of all days": base + diagnosis,
    }
    lines = [
        "## 100,000 joints with a year of logs, on paper",
        f"A full-size log (`sample_logs/kr10`, {full.runs} days, {full.logs / 1e6:.0f} MB of CSV):"
        f" {full.process.cpu:.0f} s of processor, {full.process.peak / 1e6:.0f} MB of memory, "
        f"{full.results / 1e6:.0f} MB of results, of which {full.samples / 1e6:.0f} MB are samples."
        " How stages grow with the pairs of a joint, processor time [s] and slope of the last"
        " doublings in a double logarithm:",
        "",
        header,
        "|" + " --- |" * (len(stages) + 1),
        *rows,
        slope,
        "",
        f"With a measuring day a week, {_DAYS} a year, {_JOINTS:,} joints have"
        f" {_JOINTS * _DAYS / full.runs * full.logs / 1e12:.0f} TB of CSV and"
        f" {_JOINTS * _DAYS / full.runs * full.results / 1e12:.0f} TB of results. Processor time,"
        f" and wall time on so many cores, each with {full.process.peak / 1e6:.0f} MB for the joint"
        " that it works on:",
        "",
        "| how | s per joint | processor hours |" + "".join(f" {c} cores |" for c in _CORES),
        "|" + " --- |" * (3 + len(_CORES)),
        *(_case(name, seconds) for name, seconds in cases.items()),
    ]
    return "\n".join(lines)


def full_cost(costs: Costs, slopes: Mapping[str, float], runs: int) -> float:
    """Return the processor time of the chain on so many full-size runs of a joint. [s]."""
    times = runs / costs.runs
    return sum(
        seconds * times ** max(slopes.get(name, 0.0), 0.0)
        for name, seconds in costs.seconds.items()
    )


def _slopes(growth: Mapping[int, Mapping[str, float]]) -> dict[str, float]:
    """Return the exponent of each stage's time over the three largest numbers of pairs."""
    largest = sorted(growth)[-3:]
    logs = np.log(largest)
    return {
        stage: float(np.polyfit(logs, [_log(growth[pairs][stage]) for pairs in largest], 1)[0])
        for stage in growth[largest[0]]
    }


def _log(seconds: float) -> float:
    return float(np.log(max(seconds, 1e-3)))


def _case(name: str, seconds: float) -> str:
    hours = seconds * _JOINTS / 3600
    walls = "".join(f" {hours / cores / 24:.1f} days |" for cores in _CORES)
    return f"| {name} | {seconds:,.0f} | {hours:,.0f} |{walls}"
