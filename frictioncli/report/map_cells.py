"""Cells of the residual maps by move and angle, so that the chart can show what lies in one."""

from itertools import pairwise
from typing import Any

import numpy as np

from frictioncli.diagnosis.documents.reload import Misfits
from frictioncli.report.residual_maps import MapAxis, map_axes

_OUTSIDE = -1


def map_cells(seen: Misfits, temperature: str) -> dict[str, Any]:
    """Return what the script needs to find the points of a cell of the residual maps.

    Parameters
    ----------
    seen : Misfits
        The runs that the maps show.
    temperature : {"motor", "housing", "mean"}
        Temperature input of the model.

    Returns
    -------
    dict
        By axis, except the angle: ``texts``, one per cell, and ``move``, the number of the cell of
        each pair in its order. Of the angle: ``texts`` and ``edges`` [deg].
    """
    table = seen.problem.table
    first = np.unique(table.pair, return_index=True)[1]
    told: dict[str, Any] = {}
    for name, axis in map_axes(table, temperature).items():
        told[name] = {"texts": _texts(name, axis)}
        if name == "position":
            told[name]["edges"] = [round(float(edge), 4) for edge in axis.edges]
        else:
            told[name]["move"] = [int(cell) for cell in axis.cell[first]]
    return told


def outside(cells: dict[str, Any], count: int) -> dict[str, Any]:
    """Return the cells with so many pairs more, which the maps do not show.

    Parameters
    ----------
    cells : dict
        As :func:`map_cells` returns them.
    count : int
        Number of pairs that follow.
    """
    more = [_OUTSIDE] * count
    return {
        name: own | ({"move": [*own["move"], *more]} if "move" in own else {})
        for name, own in cells.items()
    }


def _texts(name: str, axis: MapAxis) -> list[str]:
    """Return the limits of each cell in words."""
    if axis.names:
        return [f"{speed} deg/s" for speed in axis.names]
    unit = {"clock": "h", "temperature": "°C", "position": "deg"}[name]
    texts = []
    for low, high in pairwise(axis.edges):
        way = ""
        if np.isfinite(axis.fold):
            way = "cooling, " if (low + high) / 2 > axis.fold else "heating, "
        if way == "cooling, ":
            low, high = 2 * axis.fold - high, 2 * axis.fold - low
        digits = 2 if name == "clock" else 1
        texts.append(f"{way}{low:.{digits}f} to {high:.{digits}f} {unit}")
    return texts
