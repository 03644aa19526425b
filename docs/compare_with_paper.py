"""Print what the source paper published beside what a work folder gives.

Usage: python docs/compare_with_paper.py RUN
"""

import shutil
import sys
import tempfile
from pathlib import Path

import numpy as np
import pandas as pd

from frictioncli import schemas, tables
from frictioncli.model.document import FrictionModel, read_models
from frictioncli.model.friction import PUBLISHED, carried_to_temperature, friction_torque
from frictioncli.model.settings import FitSettings
from frictioncli.model.zero_load import friction_at_zero_load
from frictioncli.stages.evaluate import evaluate
from frictioncli.stages.fit import fit
from frictioncli.stages.simulate import simulate
from frictioncli.workfiles import EVALUATION, MODEL, SCHEDULE, TORQUES

HEADER = ("what", "published", "here, by the paper's method", "here, by the default fit")
REFERENCE_TEMPERATURE = 20.0

Row = tuple[str, str, str, str]


def comparison(work: Path) -> list[Row]:
    """Return rows of (what, published, paper's method, default) for a folder ``run`` has filled."""
    default = _column(work)
    with tempfile.TemporaryDirectory() as folder:
        again = Path(folder)
        shutil.copy(work / TORQUES, again)
        fit(again, FitSettings(method="paper"))
        simulate(again)
        evaluate(again)
        paper = _column(again)
    return [
        (what, published, one, other)
        for (what, published, one), (_, _, other) in zip(paper, default, strict=True)
    ]


def _column(work: Path) -> list[tuple[str, str, str]]:
    """Return rows of (what, published, found) for one model and all that follows from it."""
    torques = tables.read(work / TORQUES, schemas.TORQUES)
    model = read_models(work / MODEL)[0]
    pairs = friction_at_zero_load(torques, model.friction.alpha)
    schedule = tables.read(work / SCHEDULE, schemas.SCHEDULE)
    evaluation = tables.read(work / EVALUATION, schemas.EVALUATION)
    rows = [
        ("heating, 25 to 65 °C", "about 100 min", _durations(pairs, "heat-up")),
        ("natural cooling, 65 to 25 °C", "about 300 min", _durations(pairs, "cool-down")),
        ("branches of heating and cooling differ (Figs 5, 6)", "yes", _loop(pairs)),
    ]
    for name, entry in model.parameters.items():
        published = f"{getattr(PUBLISHED, name):g} {entry.unit}"
        interval = entry.ci95 or (entry.estimate, entry.estimate)
        found = f"{entry.estimate:.3g} ({interval[0]:.3g} to {interval[1]:.3g})"
        rows.append((f"{name} (Fig. 7)", published, found))
    rows += [
        ("share of friction that temperature takes (Fig. 5)", "up to half", _share(pairs)),
        ("low speeds at 20 °C (Fig. 8)", "no Stribeck rise", _low_speeds(pairs, model)),
        ("corrections at k = 5, tmax = 60 min, heating", "6", _corrections(schedule, "heat-up")),
        ("corrections at k = 5, tmax = 60 min, cooling", "6", _corrections(schedule, "cool-down")),
        ("epsilon at seven or eight corrections (Fig. 11)", "<= 2 N·m", _epsilon(evaluation)),
        ("epsilon without correction", "not given", _baseline(evaluation)),
        ("time between corrections, cooling to heating", "3 times", _rarity(schedule)),
    ]
    return rows


def markdown(rows: list[Row]) -> str:
    """Return the rows as a table."""
    lines = [HEADER, tuple("---" for _ in HEADER), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def _per_run(values: pd.Series, form: str) -> str:
    return ", ".join(format(value, form) for value in values)


def _durations(pairs: pd.DataFrame, phase: str) -> str:
    times = pairs[pairs["phase"] == phase].groupby("run")["time"]
    return _per_run((times.max() - times.min()) / 60, ".0f") + " min"


def _loop(pairs: pd.DataFrame) -> str:
    """Return heating minus cooling at 45 °C and the speed nearest to 67.5 deg/s."""
    told = []
    for _, run in pairs.groupby("run"):
        speed = run["speed"].iloc[(run["speed"] - 67.5).abs().argmin()]
        at = {}
        for phase in ("heat-up", "cool-down"):
            branch = run[(run["phase"] == phase) & (run["speed"] == speed)]
            branch = branch.sort_values("motor_temperature")
            at[phase] = np.interp(45.0, branch["motor_temperature"], branch["friction_torque"])
        told.append(at["heat-up"] - at["cool-down"])
    return f"by {_per_run(pd.Series(told), '+.1f')} N·m at 45 °C, 67.5 deg/s"


def _share(pairs: pd.DataFrame) -> str:
    fastest = pairs[(pairs["speed"] == pairs["speed"].max()) & (pairs["phase"] != "sweep")]
    friction = fastest.groupby("run")["friction_torque"]
    return _per_run(100 * (1 - friction.min() / friction.max()), ".0f") + " %"


def _low_speeds(pairs: pd.DataFrame, model: FrictionModel) -> str:
    """Return how far friction below 15 deg/s lies from the model."""
    friction = model.friction
    sweep = pairs[pairs["phase"] == "sweep"].sort_values("speed")
    carried = carried_to_temperature(
        friction,
        friction=sweep["friction_torque"],
        speed=sweep["speed"],
        temperature=sweep["motor_temperature"],
        target=REFERENCE_TEMPERATURE,
    )
    law = friction_torque(
        friction, load=0.0, speed=sweep["speed"], temperature=REFERENCE_TEMPERATURE
    )
    slow = (sweep["speed"] < 15).to_numpy()
    rising = pd.Series(carried).groupby(sweep["run"].to_numpy()).is_monotonic_increasing.all()
    grows = "grows from the lowest speed on" if rising else "does not grow throughout"
    offset = (carried - law)[slow]
    return f"{grows}; {offset.min():+.1f} to {offset.max():+.1f} N·m off the model below 15 deg/s"


def _corrections(schedule: pd.DataFrame, phase: str) -> str:
    counts = schedule[schedule["phase"] == phase].groupby("run")["corrected"].sum()
    return _per_run(counts, ".0f")


def _epsilon(evaluation: pd.DataFrame) -> str:
    cells = evaluation[
        (evaluation["criterion"] == "first_degree") & evaluation["corrections"].isin([7, 8])
    ]
    return _by_phase(cells)


def _baseline(evaluation: pd.DataFrame) -> str:
    return _by_phase(evaluation[evaluation["criterion"] == "none"])


def _by_phase(cells: pd.DataFrame) -> str:
    told = []
    for phase, name in (("heat-up", "heating"), ("cool-down", "cooling")):
        medians = cells[cells["phase"] == phase].groupby("run")["epsilon"].median()
        told.append(f"{name} {_per_run(medians, '.2f')}")
    return "; ".join(told) + " N·m"


def _rarity(schedule: pd.DataFrame) -> str:
    apart = {}
    for (run, phase), part in schedule.groupby(["run", "phase"]):
        apart[run, phase] = np.ptp(part["time"]) / part["corrected"].sum()
    runs = sorted({run for run, _ in apart})
    ratios = [apart[run, "cool-down"] / apart[run, "heat-up"] for run in runs]
    return _per_run(pd.Series(ratios), ".1f") + " times"


if __name__ == "__main__":
    print(markdown(comparison(Path(sys.argv[1]))))
