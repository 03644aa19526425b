"""How often does ``compare`` find a change, and how often one that is not there?

Usage: python -m tests.studies.wear MINUTES

Every joint is compared blind: the program sees torques, never what was done to the joint. Rows are
kept in ``build/wear.csv`` and not done again; docs/compare.md gets the tables of what is there.
"""

import csv
import hashlib
import sys
import time
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path

import pandas as pd

from frictioncli.comparison.compare import Comparison, compare_runs
from frictioncli.comparison.run_history import ComparedFolder, run_history_of
from frictioncli.comparison.settings import ComparisonSettings, Threshold
from frictioncli.model.fitting import fit_joint
from frictioncli.model.settings import FitSettings
from tests.studies.wear_page import write_page
from tests.studies.wear_world import Life, torques_of

ROOT = Path(__file__).parents[2]
ROWS = ROOT / "build" / "wear.csv"

_FIRST_SEED = 1000
"""Seeds below were looked at while the method was made."""

_METHOD = (
    "noise_averaged_fit",
    "causes",
    "compare",
    "run_levels",
    "day_to_day",
    "settings",
)
"""Modules that rows depend on."""

_SETTINGS = ComparisonSettings(fail_above=Threshold(3.0, "%"))

_PLAN = (
    (4, Life(kind="unchanged")),
    (2, Life(kind="wear", change=0.05)),
    (1, Life(kind="unchanged", joint_kind="plain")),
    (1, Life(kind="wear", change=0.05, joint_kind="plain")),
    (1, Life(kind="dry wear", change=0.05)),
    (1, Life(kind="viscous wear", change=0.05)),
    (1, Life(kind="sudden", change=0.05)),
    (1, Life(kind="season")),
    (1, Life(kind="payload", change=1.0)),
    (1, Life(kind="sensor", change=0.05)),
    (2, Life(kind="unchanged", runs=3)),
    (2, Life(kind="unchanged", runs=5)),
    (1, Life(kind="wear", change=0.05, runs=5)),
    (2, Life(kind="unchanged", runs=2)),
    (2, Life(kind="unchanged", runs=2, even=True)),
    (1, Life(kind="wear", change=0.10, runs=2, even=True)),
    (1, Life(kind="wear", change=0.20, runs=2, even=True)),
)
"""How many joints of each kind make up a round."""


def lives() -> Iterator[Life]:
    """Yield joints, round after round: balanced wherever it is cut short."""
    rounds = 0
    while True:
        for count, life in _PLAN:
            for number in range(count):
                seed = _FIRST_SEED + rounds * count + number
                yield Life(**asdict(life) | {"seed": seed})
        rounds += 1


def examined(life: Life) -> dict[str, object]:
    """Return what the program says of a joint, and of its first and last run alone."""
    torques = torques_of(life)
    row = _key(life) | {"sources": sources()} | _said(_compared(torques), "")
    if life.runs > 2:
        ends = torques[torques["run"].isin([torques["run"].min(), torques["run"].max()])]
        row |= _said(_compared(ends), "ends_")
    return row


def _key(life: Life) -> dict[str, object]:
    return {f"life_{name}": value for name, value in asdict(life).items()}


def _compared(torques: pd.DataFrame) -> Comparison:
    # of the folder's model only the temperature is used here: one run will do
    first = torques[torques["run"] == torques["run"].min()]
    model = fit_joint(first, {}, FitSettings())
    folder = ComparedFolder(name="joint", torques=torques, model=model, started_at={}, ambient={})
    return compare_runs(run_history_of([folder]), _SETTINGS)


def _said(found: Comparison, prefix: str) -> dict[str, object]:
    causes = ";".join("|".join(cause.effects) for cause in found.causes)
    row = {
        "verdict": found.verdict,
        "exceeded": found.exceeded,
        "change": found.trend.value,
        "low": found.trend.low,
        "high": found.trend.high,
        "p_trend": found.trend.p_value,
        "p_last": None if found.last_run is None else found.last_run.p_value,
        "load": None if found.load is None else found.load.value,
        "scatter": found.day_to_day,
        "causes": causes,
        "cause_change": found.causes[0].change.value if found.causes else None,
    }
    return {f"{prefix}{name}": value for name, value in row.items()}


def sources() -> str:
    """Return a digest of the method and the worlds."""
    files = [ROOT / "frictioncli" / "comparison" / f"{name}.py" for name in _METHOD]
    files.append(Path(__file__).with_name("wear_world.py"))
    return hashlib.sha256(b"\0".join(file.read_bytes() for file in files)).hexdigest()[:12]


def kept() -> pd.DataFrame:
    """Return the rows of the present sources."""
    if not ROWS.exists():
        return pd.DataFrame()
    rows = pd.read_csv(ROWS, keep_default_na=False, na_values=[""])
    return rows[rows["sources"] == sources()]


def main(minutes: float) -> None:
    """Examine joints for so long, then write the page."""
    end = time.monotonic() + 60 * minutes
    before = kept()
    done = {tuple(row) for row in before[list(KEY)].to_numpy().tolist()} if len(before) else set()
    for life in lives():
        if time.monotonic() > end:
            break
        if tuple(_key(life).values()) not in done:
            _append(examined(life))
    rows = kept()
    if len(rows):
        write_page(rows)


def _append(row: dict[str, object]) -> None:
    ROWS.parent.mkdir(exist_ok=True)
    new = not ROWS.exists()
    with ROWS.open("a", encoding="utf-8", newline="") as stream:
        writer = csv.DictWriter(stream, fieldnames=COLUMNS, restval="")
        if new:
            writer.writeheader()
        writer.writerow(row)


KEY = tuple(_key(Life(kind="unchanged")))
_SAID = (
    *("verdict", "exceeded", "change", "low", "high", "p_trend", "p_last", "load", "scatter"),
    *("causes", "cause_change"),
)
COLUMNS = (*KEY, "sources", *_SAID, *(f"ends_{name}" for name in _SAID))

if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else 0.0)
