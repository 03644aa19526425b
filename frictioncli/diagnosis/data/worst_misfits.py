"""Where the simulated torque misses the measured one most."""

import numpy as np
import pandas as pd

from frictioncli.diagnosis.data.problem import Misfit, Problem

_WORST = 5
"""Number of places with the greatest misfit that are listed."""


def worst_misfits(problem: Problem) -> tuple[Misfit, ...]:
    """Return the greatest mean misfits over temperature or angle, at each speed.

    Parameters
    ----------
    problem : Problem
        The rows, with the base model.
    """
    table = problem.table
    axes = {"temperature": table.temperature, "angle": table.position}
    cells = []
    for channel, values in (("friction", problem.friction_misfit), ("load", problem.load_misfit)):
        for axis, along in axes.items():
            edges = np.unique(np.quantile(along, np.linspace(0, 1, 7)))
            if len(edges) < 2:
                continue
            cell = np.clip(np.searchsorted(edges, along, side="right") - 1, 0, len(edges) - 2)
            frame = pd.DataFrame({"cell": cell, "speed": table.speed, "misfit": values})
            means = frame.groupby(["cell", "speed"])["misfit"].agg(["mean", "size"])
            for (number, speed), row in means[means["size"] >= 10].iterrows():
                low, high = float(edges[number]), float(edges[number + 1])
                cells.append(Misfit(channel, axis, low, high, float(speed), float(row["mean"])))
    return tuple(sorted(cells, key=lambda cell: -abs(cell.misfit))[:_WORST])
