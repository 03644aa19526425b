"""Maps of the residuals of the simulated torque over two variables of the experiment."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.figure import Figure

from frictioncli.arrays import Array, Indices
from frictioncli.diagnosis.documents.reload import Reloaded
from frictioncli.effects.base import EffectTable
from frictioncli.report.binning import group_boundaries, is_warming, merge_close_values
from frictioncli.report.labels import TEMPERATURE_SYMBOLS
from frictioncli.report.panel import Panel, name_ticks
from frictioncli.report.results import JointResults
from frictioncli.report.style import MODEL, WIDTH

_COLOURS = "RdBu_r"
_EMPTY = "#D9DBDF"
_MOST_SPEEDS = 10
_LIMIT_PERCENTILE = 98.0
"""Percentile of the cells' absolute residuals at which the colour scale ends."""

_LEAST_LIMIT, _ERROR_PERCENTILE = 4.0, 90.0
"""Least limit of the colour scale, in standard errors at this percentile of the cells."""

_ABOVE, _MAP, _BELOW = 0.3, 1.35, 0.5
"""Heights of a title, of a map, and of what is written below it. [inch]"""

_LEFT, _RIGHT, _CHARACTER = 0.45, 0.85, 0.075
"""Widths of a label beside its numbers, of the colour bar, and of a character. [inch]"""

_BETWEEN = 0.15
"""Gap between two maps, as a share of their width."""

_CELL_COUNTS = {"temperature": 9, "position": 18, "clock": 24}


@dataclass(frozen=True, slots=True)
class MapAxis:
    """One axis of a map.

    Attributes
    ----------
    label : str
        Label with unit.
    values : ndarray, shape (rows,)
        Values of the variable.
    edges : ndarray, shape (cells + 1,)
        Edges of the cells.
    names : tuple of str
        Names of the cells, if these are to be drawn with equal width.
    ticks : tuple of (float, str)
        Places and texts of the ticks, where these are not the values.
    fold : float
        Where the axis turns from rising to falling temperature; NaN for other axes.
    """

    label: str
    values: Array
    edges: Array
    names: tuple[str, ...] = ()
    ticks: tuple[tuple[float, str], ...] = ()
    fold: float = float("nan")

    @property
    def cell(self) -> Indices:
        """Index of the cell of each row."""
        return np.searchsorted(self.edges[1:-1], self.values, side="right")


def residual_map_figure(results: JointResults, *, diagnosis: Reloaded) -> Figure:
    """Draw the residuals of both channels over speed, temperature, angle and time.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    diagnosis : Reloaded
        The joint's diagnosis.
    """
    seen = diagnosis.seen
    models = [("base model", seen.before)]
    if seen.terms:
        models.append(("extended model", seen.after))
    axes = map_axes(seen.problem.table, results.model.temperature)
    wanted = (("temperature", "speed"), ("clock", "position"), ("position", "speed"))
    named = [(across, up) for across, up in wanted if across in axes and up in axes]
    pairs = [(axes[across], axes[up]) for across, up in named]
    height = 2 * (_ABOVE + len(pairs) * (_MAP + _BELOW))
    figure = Figure(figsize=(WIDTH, height))
    for index, channel in enumerate(("friction", "load")):
        panels, bar_panel = _placed(figure, [up for _, up in pairs], len(models), index)
        means = [
            [
                cell_means(across, up, misfit[channel], seen.problem.table.pair)
                for _, misfit in models
            ]
            for across, up in pairs
        ]
        limit = colour_limit([drawn[0] for drawn in means])
        meshes = [
            _draw_map(panel, across, up, mean, limit)
            for row, (across, up), drawn in zip(panels, pairs, means, strict=True)
            for panel, (mean, _) in zip(row, drawn, strict=True)
        ]
        for row, (across_name, up_name) in zip(panels, named, strict=True):
            for panel, (model, _) in zip(row, models, strict=True):
                # the chart that looks into the data finds the map under the pointer by it
                panel.patch.set_gid(f"cells-{across_name}-{up_name}-{channel}-{model.split()[0]}")
        for panel, (name, _) in zip(panels[0], models, strict=True):
            panel.set_title(f"{channel}, {name}")
        for panel in (panel for row in panels for panel in row[1:]):
            panel.set_ylabel("")
        unit = results.unit if channel == "friction" else results.load_unit
        bar = figure.colorbar(meshes[0], cax=bar_panel, extend="both", format="{x:g}")
        bar.set_label(f"measured − simulated [{unit}]")
        bar.outline.set_visible(False)
    return figure


def _placed(
    figure: Figure, upward: Sequence[MapAxis], columns: int, index: int
) -> tuple[list[list[Axes]], Axes]:
    """Return a channel's panels, a row per map and a column per model, and its colour bar's.

    Their places are known beforehand: measuring every label would take longer than drawing them.
    """
    width, height = figure.get_size_inches()
    longest = max(len(name) for up in upward for name in up.names or ("−100",))
    left = _LEFT + _CHARACTER * longest
    top = height * (1 - index / 2) - _ABOVE
    bottom = top - len(upward) * (_MAP + _BELOW) + _BELOW
    sides = {"left": left / width, "right": 1 - _RIGHT / width}
    ends = {"top": top / height, "bottom": bottom / height}
    grid = figure.add_gridspec(
        len(upward), columns, **sides, **ends, hspace=_BELOW / _MAP, wspace=_BETWEEN
    )
    panels = [
        list(row)
        for row in grid.subplots(
            sharey="row", squeeze=False, subplot_kw={"axes_class": Panel, "layouts": {}}
        )
    ]
    bar = figure.add_axes(
        (sides["right"] + 0.02, ends["bottom"], 0.022, ends["top"] - ends["bottom"])
    )
    return panels, bar


def cell_means(across: MapAxis, up: MapAxis, misfit: Array, pair: Indices) -> tuple[Array, Array]:
    """Return the mean residual per cell and its standard error.

    The standard errors are those of the scatter within pairs.

    Parameters
    ----------
    across, up : MapAxis
        Horizontal and vertical axis.
    misfit : ndarray, shape (rows,)
        Measured minus simulated torque. [N·m]
    pair : ndarray of int, shape (rows,)
        Pair of each row.

    Returns
    -------
    mean, error : ndarray, shape (cells up, cells across)
        NaN in cells without data. [N·m]
    """
    columns, rows = len(across.edges) - 1, len(up.edges) - 1
    cell = up.cell * columns + across.cell
    count = np.bincount(cell, minlength=columns * rows).astype(float)
    count[count == 0] = np.nan
    means = np.bincount(cell, misfit, minlength=columns * rows) / count
    pairs, of_pair = np.unique(pair, return_inverse=True)
    within = misfit - (np.bincount(of_pair, misfit) / np.bincount(of_pair))[of_pair]
    scatter = np.sqrt(within @ within / max(len(misfit) - len(pairs), 1))
    return means.reshape(rows, columns), (scatter / np.sqrt(count)).reshape(rows, columns)


def colour_limit(maps: list[tuple[Array, Array]]) -> float:
    """Return the limit of the colour scale, large enough that noise is pale [N·m].

    Parameters
    ----------
    maps : list of (ndarray, ndarray)
        Mean and standard error per cell of each map. [N·m]
    """
    means = np.abs(np.concatenate([mean.ravel() for mean, _ in maps]))
    errors = np.concatenate([error.ravel() for _, error in maps])
    limits = (
        np.nanpercentile(means, _LIMIT_PERCENTILE),
        _LEAST_LIMIT * np.nanpercentile(errors, _ERROR_PERCENTILE),
    )
    return max(*map(float, limits), 1e-9)


def _draw_map(panel: Axes, across: MapAxis, up: MapAxis, mean: Array, limit: float) -> QuadMesh:
    high = np.arange(len(up.edges)) if up.names else up.edges
    mesh = panel.pcolormesh(
        across.edges, high, mean, cmap=_COLOURS, vmin=-limit, vmax=limit, rasterized=True
    )
    panel.set_facecolor(_EMPTY)
    panel.grid(visible=False)
    panel.set_xlabel(across.label)
    panel.set_ylabel(up.label)
    if up.names:
        name_ticks(panel.yaxis, np.arange(len(up.names)) + 0.5, up.names)
    if across.ticks:
        name_ticks(panel.xaxis, *zip(*across.ticks, strict=True))
        panel.axvline(across.fold, color=MODEL, linewidth=0.9)
    return mesh


def map_axes(table: EffectTable, temperature: str) -> dict[str, MapAxis]:
    """Return the axes of the maps that these data have.

    Parameters
    ----------
    table : EffectTable
        Rows of the runs that the maps show.
    temperature : {"motor", "housing", "mean"}
        Temperature input of the model.

    Returns
    -------
    dict
        Of ``clock``, ``temperature``, ``position`` and ``speed``, those that vary and the last two.
    """
    symbol = TEMPERATURE_SYMBOLS[temperature]
    axes = {}
    hours = table.clock / 3600.0
    if np.ptp(hours) > 0:
        edges = np.linspace(hours.min(), hours.max(), _CELL_COUNTS["clock"] + 1)
        axes["clock"] = MapAxis("time [h]", hours, edges)
    if np.ptp(table.temperature) > 0:
        axes["temperature"] = _temperature_axis(table, symbol)
    angles = np.unique(table.position)
    half = float(np.min(np.diff(angles), initial=10.0)) / 2
    ends = angles[:1] - half, angles[-1:] + half
    edges = np.concatenate([ends[0], group_boundaries(angles, _CELL_COUNTS["position"]), ends[1]])
    axes["position"] = MapAxis("joint angle φ [deg]", table.position, edges)
    axes["speed"] = _speed_axis(table.speed)
    return axes


def _temperature_axis(table: EffectTable, symbol: str) -> MapAxis:
    """Return the axis of temperature: rising from left to right, then falling.

    With a thermal lag the misfits of both have opposite signs; in common cells they would cancel.
    """
    temperature, count = table.temperature, _CELL_COUNTS["temperature"]
    low, high = float(temperature.min()), float(temperature.max())
    warming = is_warming(table)
    if warming.all() or not warming.any():
        return MapAxis(f"temperature {symbol} [°C]", temperature, np.linspace(low, high, count + 1))
    folded = np.where(warming, temperature, 2 * high - temperature)
    middle = (low + high) / 2
    ticks = [(at, f"{at:.0f}") for at in (low, middle, high)]
    ticks += [(2 * high - at, f"{at:.0f}") for at in (middle, low)]
    return MapAxis(
        f"{symbol} [°C], heating | cooling",
        folded,
        np.linspace(low, 2 * high - low, 2 * count + 1),
        ticks=tuple(ticks),
        fold=high,
    )


def _speed_axis(speed: Array) -> MapAxis:
    """Return the axis of speeds, with cells of equal height; many speeds are grouped."""
    known = np.unique(merge_close_values(speed))
    groups = np.array_split(known, min(len(known), _MOST_SPEEDS))
    names = tuple(
        f"{group[0]:.3g}" if len(group) == 1 else f"{group[0]:.3g}–{group[-1]:.3g}"
        for group in groups
    )
    edges = np.array([0.0, *group_boundaries(known, _MOST_SPEEDS), np.inf])
    return MapAxis("speed [deg/s]", speed, edges, names)
