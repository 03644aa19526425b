"""Figure of the residuals: measured minus modelled friction torque."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frictioncli.report.labels import TEMPERATURE_LABELS
from frictioncli.report.panel import stacked
from frictioncli.report.results import JointResults, by_speed
from frictioncli.report.style import (
    COOLING,
    HEATING,
    MODEL,
    OTHER_PHASE,
    RASTER_FROM,
    WIDTH,
    legend_above,
)
from frictioncli.wording import speed_text

_ANGLE_BINS = 36
_MOST_NAMED = 4


def residuals(results: JointResults) -> pd.DataFrame:
    """Return the torques with ``residual``, measured minus modelled friction torque.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    key = ["run", "pair"]
    rows = results.friction().merge(results.pairs[[*key, "temperature"]], on=key, how="left")
    modelled = results.predict(
        load=rows["load_torque"], speed=rows["speed"], temperature=rows["temperature"]
    )
    rows = rows.assign(residual=rows["friction_torque"] - modelled)
    return rows.dropna(subset=["residual"])


def residual_figure(results: JointResults) -> Figure:
    """Draw the residuals against speed, temperature and angle.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    rows = residuals(results)
    pairs = rows.groupby(["run", "pair"], as_index=False).agg(
        speed=("speed", "first"),
        temperature=("temperature", "first"),
        phase=("phase", "first"),
        residual=("residual", "mean"),
    )
    has_temperature = bool(pairs["temperature"].notna().any())
    count = 3 if has_temperature else 2
    figure = Figure(figsize=(WIDTH, 0.4 + 2.2 * count), layout="constrained")
    axes = stacked(figure, count)
    if has_temperature:
        axes[1].sharey(axes[0])
    _draw_pairs(axes[0], pairs, "speed")
    axes[0].set_xlabel("speed |φ'| [deg/s]")
    if has_temperature:
        _draw_pairs(axes[1], pairs, "temperature")
        axes[1].set_xlabel(TEMPERATURE_LABELS[results.model.temperature])
    _draw_angle_means(axes[-1], rows, results)
    axes[-1].set_xlabel("joint angle φ [deg]")
    for panel in axes:
        panel.set_ylabel(f"residual [{results.unit}]")
    # above the panels, since points may lie anywhere inside
    legend_above(axes[0])
    if len(axes[-1].get_legend_handles_labels()[1]) <= _MOST_NAMED:
        legend_above(axes[-1])
    for panel in axes:
        panel.axhline(0.0, color=MODEL, linewidth=0.9)
    return figure


def _draw_pairs(panel: Axes, pairs: pd.DataFrame, column: str) -> None:
    for phase, colour, name in (
        ("heat-up", HEATING, "heating"),
        ("cool-down", COOLING, "cooling"),
        ("sweep", OTHER_PHASE, "sweep"),
    ):
        own = pairs[pairs["phase"] == phase]
        if len(own):
            panel.plot(
                own[column],
                own["residual"],
                linestyle="none",
                marker="o",
                markersize=3,
                markeredgewidth=0,
                alpha=0.6,
                color=colour,
                label=name,
                rasterized=len(own) > RASTER_FROM,
            )


def _draw_angle_means(panel: Axes, rows: pd.DataFrame, results: JointResults) -> None:
    edges = np.linspace(rows["position"].min(), rows["position"].max() + 1e-9, _ANGLE_BINS + 1)
    middles = (edges[:-1] + edges[1:]) / 2
    bins = pd.Series(np.digitize(rows["position"], edges) - 1, index=rows.index)
    shown = {float(s) for s in results.thermal_pairs["speed"]} or set(results.styles)
    for speed, own in by_speed(rows):
        if speed in shown:
            means = own.groupby(bins.loc[own.index])["residual"].mean()
            panel.plot(
                middles[means.index.to_numpy()],
                means,
                color=results.style(speed).colour,
                linewidth=1.2,
                label=speed_text(speed),
            )
