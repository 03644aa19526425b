# ruff: noqa: TID251
"""Figure that defends a diagnosis: misfit over the quantities in which the findings show."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frictioncli.diagnosis.documents.reload import Reloaded
from frictioncli.diagnosis.search.largest_structure import largest_structure
from frictioncli.report.binning import bin_means, bin_numbers, residual_series
from frictioncli.report.evidence_figure import AXES
from frictioncli.report.style import style_context
from frictioncli.wording import in_words

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
        (" or ".join(map(in_words, cause.effects)), cause.seen_in, cause.channel)
        for cause in document.modelled_causes
    ]
    if document.structure is not None:
        axis = document.structure.axis[0]
        named.append(("structure without a name", axis, document.structure.channel))
    named += [
        (f"{' or '.join(map(in_words, cause.effects))}, not named", cause.seen_in, cause.channel)
        for cause in document.visible
    ]
    if not named:
        problem = found.seen.problem
        load = None if problem.has_load_channel else found.seen.before["load"]
        most = largest_structure(problem, found.seen.before["friction"], load)
        named = [("nothing found (axis of the largest means)", most.axis, most.channel)]
    return named[:_MOST]


def draw(found: Reloaded) -> Figure:
    """Return the figure of a joint: a row per finding, before and after the extension."""
    with style_context():
        return _drawn(found)


def _drawn(found: Reloaded) -> Figure:
    shown = findings(found)
    stages = [("base model", found.seen.before)]
    if found.seen.terms:
        stages.append(("extended model", found.seen.after))
    figure = Figure(figsize=(max(4.6 * len(stages), 6.0), 2.9 * len(shown)), layout="constrained")
    grid = figure.subplots(len(shown), len(stages), squeeze=False, sharey="row")
    for panels, (title, axis, channel) in zip(grid, shown, strict=True):
        for panel, (model, misfit) in zip(panels, stages, strict=True):
            _panel(panel, found, _COLUMNS.get(axis, axis), misfit[channel], channel)
            panel.set_title(f"{title}: {model}" if panel is panels[0] else model)
        if panels[-1].get_legend_handles_labels()[1]:
            panels[-1].legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
        panels[0].set_ylabel(f"{channel}\nmeasured − simulated [{found.document.unit_of(channel)}]")
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
    panel.set_xlabel(label)
