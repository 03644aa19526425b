"""How often do the 95 % intervals of ``fit`` hold the truth? Writes docs/coverage.md.

Usage: python -m tests.studies.coverage [REPETITIONS]
"""

import sys
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
import pandas as pd

from frictioncli.model.fitting import fit_joint
from frictioncli.model.settings import FitSettings
from tests.equation_16 import TRUTH, cycle_temperatures, torques

WORLDS: Mapping[str, Mapping[str, float]] = {
    "points only": {"pair": 0.0, "drift": 0.0},
    "points and pairs": {"drift": 0.0},
    "drift of 0.2 N·m over 20 min": {},
    "drift of 0.6 N·m over 20 min": {"drift": 0.6},
    "drift of 0.3 N·m over 2 h": {"drift": 0.3, "drift_time": 7200.0},
    "drift of 0.5 N·m over 5 min": {"drift": 0.5, "drift_time": 300.0},
}
DAYS: Mapping[str, tuple[int, str]] = {
    "2 cycles": (2, "cycle"),
    "3 cycles": (3, "cycle"),
    "6 cycles": (6, "cycle"),
    "18 short days": (18, "short"),
}
"""Number and kind of the runs of a log."""

SHARES = (0.0, 0.006, 0.02)
"""Standard deviations by which friction of the runs differs."""

REPETITIONS = 300
TARGET = Path(__file__).parents[2] / "docs" / "coverage.md"


def held(task: tuple[str, int]) -> tuple[list[bool], list[bool], list[float]]:
    """Return, per parameter, whether our and the independent-noise interval hold the truth."""
    world, seed = task
    table = torques(seed, **WORLDS[world])
    model = fit_joint(table, {}, FitSettings())
    ours, widths = [], []
    for name, truth in TRUTH.items():
        low, high = model.parameters[name].ci95 or (np.nan, np.nan)
        ours.append(bool(low <= truth <= high))
        widths.append((high - low) / truth)
    return ours, independent(table, model.friction), widths


def independent(table, estimate) -> list[bool]:
    """Return whether the textbook intervals sigma^2 (J'J)^-1 of all rows hold the truth."""
    root = np.sqrt(table["speed"].to_numpy())
    warm = table["motor_temperature"].to_numpy()
    decay = np.exp(-estimate.delta * warm)
    load = np.square(table["load_torque"].to_numpy())
    columns = np.column_stack(
        [np.ones_like(root), load, root, root * decay, -estimate.gamma * warm * decay * root]
    )
    model = estimate.tau_c + estimate.alpha * load + (estimate.beta + estimate.gamma * decay) * root
    residual = table["friction_torque"].to_numpy() - model
    variance = residual @ residual / (len(residual) - 5)
    reach = 1.96 * np.sqrt(variance * np.diag(np.linalg.inv(columns.T @ columns)))
    found = [getattr(estimate, name) for name in TRUTH]
    return [
        bool(abs(value - truth) <= half)
        for value, truth, half in zip(found, TRUTH.values(), reach, strict=True)
    ]


def days(world: str, share: float, seed: int) -> pd.DataFrame:
    """Return torques of several runs, each with friction that is larger by a share of its own."""
    count, kind = DAYS[world]
    generator = np.random.default_rng([seed, count])
    parts = []
    for day in range(count):
        factor = 1 + share * generator.standard_normal()
        truth = {name: factor * value for name, value in TRUTH.items()} | {"delta": TRUTH["delta"]}
        temperatures = thinned_cycle() if kind == "cycle" else short_day(generator)
        own = torques(
            int(generator.integers(2**31)), truth=truth, temperatures=temperatures, drift=0.1
        )
        parts.append(own.assign(run=f"day{day + 1:02d}"))
    return pd.concat(parts, ignore_index=True)


def thinned_cycle() -> tuple[np.ndarray, ...]:
    """Return every fourth temperature of the paper's cycle, its time and its phase."""
    temperature, time, phase = cycle_temperatures()
    return temperature[::4], time[::4], phase[::4]


def short_day(generator: np.random.Generator) -> tuple[np.ndarray, ...]:
    """Return temperatures of 50 min in which the joint grows warmer by 10 to 18 °C."""
    course = 1 - np.exp(-np.linspace(0.0, 2.0, 6))
    first, rise = generator.uniform(16, 32), generator.uniform(10, 18)
    return first + rise * course / course[-1], 600.0 * np.arange(6.0), np.repeat("heat-up", 6)


def held_of_days(task: tuple[str, float, int]) -> tuple[list[float], list[float]]:
    """Return, per parameter, whether the interval holds the mean over days, and its width."""
    model = fit_joint(days(*task), {}, FitSettings())
    intervals = [model.parameters[name].ci95 or (np.nan, np.nan) for name in TRUTH]
    pairs = list(zip(intervals, TRUTH.values(), strict=True))
    inside = [
        float(low <= truth <= high) if np.isfinite(low) else np.nan for (low, high), truth in pairs
    ]
    return inside, [(high - low) / truth for (low, high), truth in pairs]


def main(repetitions: int) -> None:
    """Run the study and write its table."""
    names = list(TRUTH)
    lines = [
        "# Do the intervals hold?",
        "",
        "Share of 95 % intervals of `fit` that contain the true value, and the same for the",
        "textbook formula, which takes all rows as independent. Each line is from",
        f"{repetitions} thermal cycles simulated by `tests/equation_16.py`: the paper's cycle at",
        "four speeds with 34 angle bins, with noise of 0.3 N·m per point and, unless stated",
        "otherwise, 0.25 N·m per pair. Widths are relative to the true value, in the order of the",
        "columns. `make coverage` writes this page.",
        "",
        "| noise | " + " | ".join(names) + " | median width |",
        "|---|" + "---|" * (len(names) + 1),
    ]
    with ProcessPoolExecutor() as pool:
        for world in WORLDS:
            tasks = [(world, seed) for seed in range(repetitions)]
            results = list(pool.map(held, tasks, chunksize=10))
            ours = np.mean([result[0] for result in results], axis=0)
            textbook = np.mean([result[1] for result in results], axis=0)
            widths = np.nanmedian([result[2] for result in results], axis=0)
            wide = ", ".join(f"{width:.1%}" for width in widths)
            lines += [
                f"| {world} | " + " | ".join(f"{share:.2f}" for share in ours) + f" | {wide} |",
                "| same, textbook | " + " | ".join(f"{share:.2f}" for share in textbook) + " | |",
            ]
            print("\n".join(lines[-2:]), flush=True)
        lines += [
            "",
            "The same for logs of several runs. From run to run friction is larger or smaller as a",
            "whole, by a normal share of the standard deviation in the second column; the truth is",
            "the mean over all runs that could be. Cycles have every fourth temperature of the",
            "paper's; a short day has six rounds of the four speeds in 50 min, in which the joint",
            "grows warmer by 10 to 18 °C, from 16 to 32 °C on. The drift is 0.1 N·m over 20 min.",
            f"Each line is from {repetitions // 3} logs.",
            "",
            "| runs | differ by | " + " | ".join(names) + " | median width |",
            "|---|---|" + "---|" * (len(names) + 1),
        ]
        for world in DAYS:
            for share in SHARES:
                every = [(world, share, seed) for seed in range(repetitions // 3)]
                found = np.array(list(pool.map(held_of_days, every, chunksize=5)))
                shares = " | ".join(f"{one:.2f}" for one in np.nanmean(found[:, 0], axis=0))
                wide = ", ".join(f"{one:.1%}" for one in np.nanmedian(found[:, 1], axis=0))
                lines.append(f"| {world} | {share:.1%} | {shares} | {wide} |")
                print(lines[-1], flush=True)
    TARGET.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else REPETITIONS)
