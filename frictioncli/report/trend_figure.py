"""Figure of a comparison: friction over the runs, and its change at reference conditions."""

from collections.abc import Sequence
from datetime import datetime
from html import escape
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.dates import AutoDateLocator, ConciseDateFormatter
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator

from frictioncli.comparison.document import ComparisonDocument, ConditionRecord, RunRecord
from frictioncli.report.figure_files import png, svg
from frictioncli.report.labels import figure_text
from frictioncli.report.panel import name_ticks, stacked
from frictioncli.report.style import (
    FAINT,
    MODEL,
    WIDTH,
    legend_above,
    speed_styles,
    style_context,
)
from frictioncli.report.tooltips import set_tooltips
from frictioncli.wording import change_text, speed_text

_LEVEL = "#2B6CB0"
_BAND = "#BFD4EA"
_LIMIT = "#C44536"
_MOST_TICKS = 12
_ROW = 0.24
"""Height of a reference condition. [inch]"""

_NAME = "trend"


def trend_files(document: ComparisonDocument) -> tuple[str, bytes]:
    """Return the figure of a comparison as an SVG element and as the content of a PNG file.

    Parameters
    ----------
    document : ComparisonDocument
        ``comparison.json``.
    """
    title = f"Friction of joint {document.joint} over {len(document.runs)} runs"
    with style_context(_NAME):
        figure = trend_figure(document)
        return svg(figure, _NAME, escape(title)), png(figure)


def trend_figure(document: ComparisonDocument) -> Figure:
    """Draw friction over the runs, and its change at reference conditions.

    Parameters
    ----------
    document : ComparisonDocument
        ``comparison.json``.
    """
    rows = document.friction
    if not rows:
        figure = Figure(figsize=(WIDTH, 3.6), layout="constrained")
        (panel,) = stacked(figure, 1)
        _draw_runs(panel, document)
        return figure
    below = _ROW * len(rows) + 0.9
    figure = Figure(figsize=(WIDTH, 3.6 + below), layout="constrained")
    above, lower = stacked(figure, 2, (3.6, below))
    _draw_runs(above, document)
    _draw_conditions(lower, rows)
    return figure


def _draw_runs(axes: Axes, document: ComparisonDocument) -> None:
    runs, trend = document.runs, document.trend.percent
    dated = document.trend.per_1000_h is not None
    x: Any = np.arange(1, len(runs) + 1)
    if dated:
        x = [datetime.fromisoformat(run.started_at) for run in runs if run.started_at]
    # time or, without dates, order of the runs, from 0 to 1
    elapsed = np.array([run.days for run in runs] if dated else np.arange(len(runs)), dtype=float)
    elapsed = elapsed / elapsed[-1]
    level = np.array([run.level for run in runs])
    half_width = np.array([run.ci95[1] for run in runs]) - level
    mean_level = float(np.mean(level))
    centred = elapsed - elapsed.mean()
    axes.plot(x, mean_level + trend.estimate * centred, color=MODEL, label="trend")
    limits = [mean_level + slope * centred for slope in trend.ci95]
    axes.fill_between(
        x, np.minimum(*limits), np.maximum(*limits), color=_BAND, alpha=0.5, linewidth=0
    )
    axes.plot(
        x,
        [run.measured for run in runs],
        linestyle="none",
        marker="o",
        color=FAINT,
        markerfacecolor="white",
        label="as measured",
    )
    drawn = axes.errorbar(
        x,
        level,
        yerr=half_width,
        linestyle="none",
        marker="o",
        color=_LEVEL,
        elinewidth=1.2,
        label="at equal ambient conditions",
    )
    set_tooltips(
        drawn.lines[0],
        [f"{run.folder}, {run.run}: {change_text(run.level, run.ci95, '%')}" for run in runs],
    )
    _draw_limits(axes, document, mean_level + trend.estimate * float(centred[0]))
    axes.set_ylabel(f"friction of joint {document.joint} against the mean [%]")
    axes.set_title(
        f"First run to last: {change_text(trend.estimate, trend.ci95, '%')}",
        pad=22,
    )
    if dated:
        locator = AutoDateLocator()
        axes.xaxis.set_major_locator(locator)
        axes.xaxis.set_major_formatter(ConciseDateFormatter(locator))
        axes.set_xlabel("date of the run")
    else:
        _label_run_numbers(axes, runs)
    legend_above(axes)


def _draw_limits(axes: Axes, document: ComparisonDocument, start: float) -> None:
    if document.threshold is None:
        return
    margin = document.margin.value
    for index, limit in enumerate((start - margin, start + margin)):
        label = "threshold, from the first run" if index == 0 else None
        axes.axhline(limit, color=_LIMIT, linestyle=(0, (5, 3)), linewidth=1.2, label=label)


def _label_run_numbers(axes: Axes, runs: Sequence[RunRecord]) -> None:
    axes.set_xlabel("run, in the order given")
    if len(runs) <= _MOST_TICKS:
        axes.xaxis.set_major_locator(FixedLocator(range(1, len(runs) + 1)))


def _draw_conditions(axes: Axes, rows: Sequence[ConditionRecord]) -> None:
    styles = speed_styles(pd.DataFrame({"speed": [row.speed for row in rows], "phase": "sweep"}))
    for index, row in enumerate(rows):
        change = row.percent
        centre = change.estimate
        drawn = axes.errorbar(
            centre,
            index,
            xerr=[[centre - change.ci95[0]], [change.ci95[1] - centre]],
            marker=styles[row.speed].marker,
            color=styles[row.speed].colour,
            markerfacecolor="white" if row.extrapolated else styles[row.speed].colour,
            elinewidth=1.2,
        )
        where = f"{row.temperature:.0f} °C, {speed_text(row.speed)}"
        set_tooltips(drawn.lines[0], [f"{where}: {change_text(centre, change.ci95, '%')}"])
    axes.axvline(0.0, color=MODEL, linewidth=1.0)
    name_ticks(
        axes.yaxis,
        range(len(rows)),
        [figure_text(f"{row.temperature:.0f} °C, {speed_text(row.speed)}") for row in rows],
    )
    axes.invert_yaxis()
    axes.grid(visible=False, axis="y")
    extrapolated = any(row.extrapolated for row in rows)
    note = "\nhollow: not all runs have measured this temperature" if extrapolated else ""
    axes.set_xlabel(f"change of friction at the usual load, first run to last [%]{note}")
    axes.set_title("Change at reference conditions, 95 % intervals")
