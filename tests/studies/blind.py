"""Does ``diagnose`` find what is hidden, and nothing else? Writes docs/blind.md.

Every world is simulated by :mod:`frictioncli.simulator`, which shares no formula with the
catalogue, and diagnosed blind. Results are kept in ``build/blind.csv``; a second call goes on where
the first one stopped.

Usage: python -m tests.studies.blind [SEEDS]
"""

import csv
import sys
import time
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from frictioncli.diagnosis.diagnose import diagnose_joint
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.effects import BY_NAME
from frictioncli.simulator.settings import SynthesisSettings
from frictioncli.simulator.tabular import simulate_world

ROOT = Path(__file__).parents[2]
STORE = ROOT / "build" / "blind.csv"
PAGE = ROOT / "docs" / "blind.md"
NOISES = ("white", "pair", "drift90", "drift97", "drift99", "outliers", "heteroscedastic")
UNLISTED = (
    "speed_resonance",
    "stroke_bump",
    "cooling_fan",
    "position_temperature",
    "lifting_loss",
)
COLUMNS = ("kind", "noise", "protocol", "hidden", "size", "seed", "verdict", "sets", "gain", "time")


@dataclass(frozen=True)
class World:
    """One hidden experiment: what is planted, under which noise and programme."""

    kind: str
    noise: str
    protocol: str
    hidden: str
    size: float
    seed: int

    @property
    def key(self) -> tuple[str, ...]:
        """What identifies the world in the store."""
        return tuple(
            str(value)
            for value in (self.kind, self.noise, self.protocol, self.hidden, self.size, self.seed)
        )


def worlds(seeds: int) -> list[World]:
    """Return the worlds of the study, most telling first."""
    found = []
    for seed in range(seeds):
        found += [World("clean", noise, "paper", "", 0.0, seed) for noise in NOISES]
        found += [
            World("single", "default", "paper", name, size, seed)
            for name in BY_NAME
            for size in (0.5, 1.0)
        ]
        found += [
            World("pair", "default", "paper", f"thermal_lag+{name}", 1.0, seed)
            for name in BY_NAME
            if name != "thermal_lag"
        ]
        found += [World("unlisted", "default", "paper", name, 1.0, seed) for name in UNLISTED]
    return found


def examined(world: World) -> list[object]:
    """Simulate one world, diagnose it and return its row."""
    began = time.perf_counter()
    hidden = [name for name in world.hidden.split("+") if name]
    settings = SynthesisSettings(
        seed=1000 + world.seed,
        joint_kind="plain",
        noise_kind=world.noise,
        protocol=world.protocol,
        effects=tuple(f"{name}:{world.size}" for name in hidden),
    )
    torques = simulate_world(settings).torques
    diagnosis = diagnose_joint(torques, "motor", "N·m", DiagnosisSettings())
    sets = ";".join("|".join(cause.effects) for cause in diagnosis.causes)
    gain = "" if diagnosis.gain is None else f"{diagnosis.gain.reduction:.4f}"
    spent = f"{time.perf_counter() - began:.1f}"
    return [*world.key, diagnosis.verdict, sets, gain, spent]


def main(seeds: int) -> None:
    """Run what is missing, then write the page."""
    STORE.parent.mkdir(exist_ok=True)
    if not STORE.exists():
        STORE.write_text(",".join(COLUMNS) + "\n", encoding="utf-8")
    with STORE.open(encoding="utf-8", newline="") as stream:
        done = {tuple(row[:6]) for row in csv.reader(stream)}
    missing = [world for world in worlds(seeds) if world.key not in done]
    with ProcessPoolExecutor() as pool, STORE.open("a", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream)
        for task in as_completed([pool.submit(examined, world) for world in missing]):
            writer.writerow(task.result())
            stream.flush()
    PAGE.write_text(page(pd.read_csv(STORE, keep_default_na=False)), encoding="utf-8")


def page(rows: pd.DataFrame) -> str:
    """Return the page: what was found of what was hidden."""
    rows = rows.assign(found=rows["verdict"] != "no_evidence")
    lines = [
        "# Blind study",
        "",
        f"{len(rows)} simulated joints of two days each, diagnosed blind. The joint is exactly the",
        "base model (joint kind `plain`) with one or two effects planted, or none, measured with",
        "the paper's programme. `make blind` writes this page. Sizes are RMS torque before the",
        "base model takes its share; much of many effects is taken by it there.",
        "",
        "## Nothing hidden",
        "| noise | joints | any finding |",
        "|---|---|---|",
    ]
    for noise, part in rows[rows["kind"] == "clean"].groupby("noise"):
        lines.append(f"| {noise} | {len(part)} | {part['found'].mean():.0%} |")
    lines += [
        "",
        "## One effect",
        "| hidden | size [N·m] | joints | found | truth in a set, if found | alone in it |"
        " wrong single name | gain, median |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for (name, size), group in rows[rows["kind"] == "single"].groupby(["hidden", "size"]):
        lines.append(_single(str(name), float(size), group))
    lines += [
        "",
        "## A thermal lag and another effect of 1 N·m",
        "| also hidden | joints | lag in a set | other in a set | both |",
        "|---|---|---|---|---|",
    ]
    for name, group in rows[rows["kind"] == "pair"].groupby("hidden"):
        other = str(name).split("+")[1]
        lag, also = _holds(group, "thermal_lag"), _holds(group, other)
        lines.append(
            f"| {other} | {len(group)} | {lag.mean():.0%} | {also.mean():.0%} |"
            f" {(lag & also).mean():.0%} |"
        )
    lines += [
        "",
        "## Effects that the catalogue does not list, 1 N·m",
        "| hidden | joints | unnamed | wrong single name | nothing |",
        "|---|---|---|---|---|",
    ]
    for name, group in rows[rows["kind"] == "unlisted"].groupby("hidden"):
        lines.append(
            f"| {name} | {len(group)} | {(group['verdict'] == 'unnamed').mean():.0%} |"
            f" {(group['verdict'] == 'named').mean():.0%} |"
            f" {(group['verdict'] == 'no_evidence').mean():.0%} |"
        )
    return "\n".join(lines) + "\n"


def _single(name: str, size: float, group: pd.DataFrame) -> str:
    found = group[group["sets"] != ""]
    held = _holds(found, name)
    alone = np.array([name in sets.split(";") for sets in found["sets"]], dtype=bool)
    wrong = np.array(
        [any("|" not in one and one != name for one in sets.split(";")) for sets in found["sets"]],
        dtype=bool,
    )
    gains = pd.to_numeric(found["gain"], errors="coerce")

    def share(values: np.ndarray) -> str:
        return f"{values.mean():.0%}" if len(values) else ""

    gain = f"{gains.median():.0%}" if len(found) else ""
    return (
        f"| {name} | {size:g} | {len(group)} | {group['found'].mean():.0%} | {share(held)} |"
        f" {share(alone)} | {share(wrong)} | {gain} |"
    )


def _holds(group: pd.DataFrame, name: str) -> np.ndarray:
    return np.array(
        [any(name in one.split("|") for one in sets.split(";")) for sets in group["sets"]],
        dtype=bool,
    )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 20)
