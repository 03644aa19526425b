"""Maps of what the simulated torque misses, over two axes of the experiment at a time."""

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.figure import Figure

from frictioncli.arrays import Array, Indices
from frictioncli.diagnosis.documents.reload import Reloaded
from frictioncli.effects.base import EffectTable
from frictioncli.report.binning import group_boundaries, merge_close_values
from frictioncli.report.labels import TEMPERATURE_SYMBOLS
from frictioncli.report.results import JointResults
from frictioncli.report.style import WIDTH

_COLOURS = "RdBu_r"
_EMPTY = "#D9DBDF"
_MOST_SPEEDS = 10
_CLEAR = 98.0
"""Percentile of the cells' misfit at which the colours end."""

_PALE, _MOST_CELLS = 4.0, 90.0
"""They end no nearer to zero than so many standard errors of this percentage of the cells."""

_CELLS = {"temperature": 9, "position": 18, "clock": 24}


@dataclass(frozen=True, slots=True)
class MapAxis:
    """One axis of a map: its label and the edges of its cells."""

    label: str
    values: Array
    edges: Array
    names: tuple[str, ...] = ()

    @property
    def cell(self) -> Indices:
        """Cell of each row, shape (rows,)."""
        return np.searchsorted(self.edges[1:-1], self.values, side="right")


def residual_map_figure(results: JointResults, *, diagnosis: Reloaded) -> Figure:
    """Draw the misfit of both channels over speed, temperature, angle and time.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    diagnosis : Reloaded
        Its diagnosis.
    """
    seen = diagnosis.seen
    sets = [("base model", seen.before)]
    if seen.terms:
        sets.append(("extended model", seen.after))
    scales = _scales(seen.problem.table, results.model.temperature)
    wanted = (("temperature", "speed"), ("clock", "position"), ("position", "speed"))
    columns = [
        (scales[across], scales[up]) for across, up in wanted if across in scales and up in scales
    ]
    figure = Figure(figsize=(WIDTH, 0.6 + 4.2 * len(sets)), layout="constrained")
    grid = figure.subplots(2 * len(sets), len(columns), squeeze=False)
    for number, channel in enumerate(("friction", "load")):
        panels = grid[number * len(sets) : (number + 1) * len(sets)]
        means = [
            [
                cell_means(across, up, misfit[channel], seen.problem.table.pair)
                for across, up in columns
            ]
            for _, misfit in sets
        ]
        limit = colour_limit(means[0])
        meshes = [
            _map(panel, across, up, mean, limit)
            for row, drawn in zip(panels, means, strict=True)
            for panel, (across, up), (mean, _) in zip(row, columns, drawn, strict=True)
        ]
        for row, (name, _) in zip(panels, sets, strict=True):
            row[0].set_title(f"{channel}, {name}: measured − simulated")
        unit = results.unit if channel == "friction" else results.load_unit
        bar = figure.colorbar(meshes[0], ax=list(panels.flat), extend="both", aspect=30, pad=0.01)
        bar.set_label(f"misfit [{unit}]")
        bar.outline.set_visible(False)
    return figure


def cell_means(across: MapAxis, up: MapAxis, misfit: Array, pair: Indices) -> tuple[Array, Array]:
    """Return the mean misfit per cell and its standard error; NaN without data.

    Both have shape (cells up, cells across). The errors are those of the points about their pairs.

    Parameters
    ----------
    across, up : MapAxis
        The axes.
    misfit : ndarray, shape (rows,)
        Measured minus simulated. [N·m]
    pair : ndarray of int, shape (rows,)
        Pair of each row.
    """
    wide, high = len(across.edges) - 1, len(up.edges) - 1
    place = up.cell * wide + across.cell
    count = np.bincount(place, minlength=wide * high).astype(float)
    count[count == 0] = np.nan
    means = np.bincount(place, misfit, minlength=wide * high) / count
    pairs, of_pair = np.unique(pair, return_inverse=True)
    inside = misfit - (np.bincount(of_pair, misfit) / np.bincount(of_pair))[of_pair]
    scatter = np.sqrt(inside @ inside / max(len(misfit) - len(pairs), 1))
    return means.reshape(high, wide), (scatter / np.sqrt(count)).reshape(high, wide)


def colour_limit(maps: list[tuple[Array, Array]]) -> float:
    """Return the misfit at which the colours end: wide enough that noise stays pale. [N·m]."""
    means = np.abs(np.concatenate([mean.ravel() for mean, _ in maps]))
    errors = np.concatenate([error.ravel() for _, error in maps])
    widest = np.nanpercentile(means, _CLEAR), _PALE * np.nanpercentile(errors, _MOST_CELLS)
    return max(*map(float, widest), 1e-9)


def _map(panel: Axes, across: MapAxis, up: MapAxis, mean: Array, limit: float) -> QuadMesh:
    high = np.arange(len(up.edges)) if up.names else up.edges
    mesh = panel.pcolormesh(
        across.edges, high, mean, cmap=_COLOURS, vmin=-limit, vmax=limit, rasterized=True
    )
    panel.set_facecolor(_EMPTY)
    panel.grid(visible=False)
    panel.set_xlabel(across.label)
    panel.set_ylabel(up.label)
    if up.names:
        panel.set_yticks(np.arange(len(up.names)) + 0.5, up.names)
    return mesh


def _scales(table: EffectTable, temperature: str) -> dict[str, MapAxis]:
    symbol = TEMPERATURE_SYMBOLS[temperature]
    wanted = {
        "temperature": (f"temperature {symbol} [°C]", table.temperature),
        "clock": ("time [h]", table.clock / 3600.0),
    }
    scales = {
        name: MapAxis(label, values, np.linspace(values.min(), values.max(), _CELLS[name] + 1))
        for name, (label, values) in wanted.items()
        if np.ptp(values) > 0
    }
    angles = np.unique(table.position)
    half = float(np.min(np.diff(angles), initial=10.0)) / 2
    ends = angles[:1] - half, angles[-1:] + half
    edges = np.concatenate([ends[0], group_boundaries(angles, _CELLS["position"]), ends[1]])
    scales["position"] = MapAxis("joint angle φ [deg]", table.position, edges)
    scales["speed"] = _speed_scale(table.speed)
    return scales


def _speed_scale(speed: Array) -> MapAxis:
    """Return the speeds as rows of equal height; many of them are put together."""
    known = np.unique(merge_close_values(speed))
    groups = np.array_split(known, min(len(known), _MOST_SPEEDS))
    names = tuple(
        f"{group[0]:.3g}" if len(group) == 1 else f"{group[0]:.3g}–{group[-1]:.3g}"
        for group in groups
    )
    edges = np.array([0.0, *group_boundaries(known, _MOST_SPEEDS), np.inf])
    return MapAxis("speed [deg/s]", speed, edges, names)
