"""Where the simulated torque misses the measured one most."""

import numpy as np
import pandas as pd

from frictioncli.diagnosis.data.problem import Misfit, Problem
from frictioncli.diagnosis.data.temperature_direction import temperature_direction

_WORST = 5
"""Number of places with the greatest misfit that are listed."""

_PHASES = {1.0: "heat-up", -1.0: "cool-down", 0.0: ""}


def worst_misfits(problem: Problem) -> tuple[Misfit, ...]:
    """Return the greatest mean misfits over temperature or angle, at each speed.

    Rising and falling temperature are told apart: with a thermal lag their misfits have opposite
    signs and would cancel in a common mean.

    Parameters
    ----------
    problem : Problem
        The rows, with the base model.
    """
    table = problem.table
    direction = temperature_direction(table)
    axes = {"temperature": table.temperature, "angle": table.position}
    cells = []
    for channel, values in (("friction", problem.friction_misfit), ("load", problem.load_misfit)):
        for axis, along in axes.items():
            edges = np.unique(np.quantile(along, np.linspace(0, 1, 7)))
            if len(edges) < 2:
                continue
            cell = np.clip(np.searchsorted(edges, along, side="right") - 1, 0, len(edges) - 2)
            frame = pd.DataFrame(
                {"cell": cell, "speed": table.speed, "direction": direction, "misfit": values}
            )
            groups = frame.groupby(["cell", "speed", "direction"])["misfit"]
            means = groups.agg(["mean", "size"])
            for (number, speed, way), row in means[means["size"] >= 10].iterrows():
                low, high = float(edges[number]), float(edges[number + 1])
                mean = float(row["mean"])
                cells.append(Misfit(channel, axis, low, high, float(speed), mean, _PHASES[way]))
    return tuple(sorted(cells, key=lambda cell: -abs(cell.misfit))[:_WORST])
