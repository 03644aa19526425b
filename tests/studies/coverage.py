"""How often do the 95 % intervals of ``fit`` hold the truth? Writes docs/coverage.md.

Usage: python -m tests.studies.coverage [REPETITIONS]
"""

import sys
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np

from frictioncli.model.fitting import fit_joint
from frictioncli.model.settings import FitSettings
from tests.equation_16 import TRUTH, torques

WORLDS: Mapping[str, Mapping[str, float]] = {
    "points only": {"pair": 0.0, "drift": 0.0},
    "points and pairs": {"drift": 0.0},
    "drift of 0.2 N·m over 20 min": {},
    "drift of 0.6 N·m over 20 min": {"drift": 0.6},
    "drift of 0.3 N·m over 2 h": {"drift": 0.3, "drift_time": 7200.0},
    "drift of 0.5 N·m over 5 min": {"drift": 0.5, "drift_time": 300.0},
}
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
    TARGET.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else REPETITIONS)
