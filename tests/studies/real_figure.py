# ruff: noqa: TID251
"""Figure that defends a diagnosis: misfit over the quantities in which the findings show."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frictioncli.diagnosis.documents.reload import Reloaded
from frictioncli.diagnosis.documents.remainder import largest_structure
from frictioncli.report.binning import bin_means, bin_numbers, residual_series
from frictioncli.report.evidence_figure import AXES

_MOST = 3
"""Rows of panels."""

_COLUMNS = {"time": "clock"}
"""Columns of the table in which an axis of a structure stands under another name."""

Finding = tuple[str, str, str]
"""Title, column of the table, channel."""


def findings(found: Reloaded) -> list[Finding]:
    """Return what is to be shown: causes and structure first, then what is visible."""
    document = found.document
    named = [
        (" or ".join(cause.effects), cause.seen_in, cause.channel)
        for cause in document.modelled_causes
    ]
    if document.structure is not None:
        axis = document.structure.axis[0]
        named.append(("structure without a name", axis, document.structure.channel))
    named += [
        (f"{' or '.join(cause.effects)}, not named", cause.seen_in, cause.channel)
        for cause in document.visible
    ]
    if not named:
        problem = found.seen.problem
        load = None if problem.has_load_channel else found.seen.before["load"]
        most = largest_structure(problem, found.seen.before["friction"], load)
        named = [("nothing found; the axis of the largest means", most.axis, most.channel)]
    return named[:_MOST]


def draw(found: Reloaded) -> Figure:
    """Return the figure of a joint: a row per finding, before and after the extension."""
    shown = findings(found)
    stages = [("base model", found.seen.before)]
    if found.seen.terms:
        stages.append(("extended model", found.seen.after))
    figure = Figure(figsize=(4.6 * len(stages), 2.7 * len(shown)), layout="constrained")
    grid = figure.subplots(len(shown), len(stages), squeeze=False, sharey="row")
    for panels, (title, axis, channel) in zip(grid, shown, strict=True):
        for panel, (model, misfit) in zip(panels, stages, strict=True):
            _panel(panel, found, _COLUMNS.get(axis, axis), misfit[channel], channel)
            panel.set_title(f"{title}: {model}" if panel is panels[0] else model, fontsize=9)
        panels[0].set_ylabel(
            f"{channel}: measured − simulated [{found.document.unit_of(channel)}]", fontsize=8
        )
    return figure


def _panel(panel: Axes, found: Reloaded, axis: str, misfit: np.ndarray, channel: str) -> None:
    """Draw the mean misfit in bins of an axis with twice its standard error."""
    table = found.seen.problem.table
    label, scale = AXES[axis]
    values = getattr(table, axis)
    rows = pd.DataFrame(
        {
            "bin": bin_numbers(axis, values),
            "pair": table.pair,
            "at": values * scale,
            "mean": misfit,
            "term": 0.0,
        }
    )
    for series in residual_series(table, axis, channel):
        means = bin_means(rows[series.rows])
        panel.errorbar(
            means.at,
            means.mean,
            yerr=2 * np.nan_to_num(means.error),
            fmt="o",
            markersize=4,
            color=series.colour,
            markerfacecolor=series.colour if series.filled else "white",
            capsize=2,
            label=series.name or None,
        )
    panel.axhline(0.0, color="#555555", linewidth=0.8)
    panel.set_xlabel(label, fontsize=8)
    panel.tick_params(labelsize=8)
    if panel.get_legend_handles_labels()[1]:
        panel.legend(fontsize=7)
