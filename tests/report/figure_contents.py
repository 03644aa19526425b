# ruff: noqa: TID251
"""What figures show: their lines and texts, to be compared with the data."""

import numpy as np
from matplotlib.text import Text

from frictioncli.report.figures import FIGURES

FIGURE_SPECS = {spec.name: spec for spec in FIGURES}


def data_lines(axes):
    """Lines that hold data, not the empty ones that stand for a legend entry."""
    return [line for line in axes.lines if len(line.get_xdata()) > 0]


def texts(figure):
    found = figure.findobj(Text)
    for axes in figure.axes:
        found += [*axes.get_xticklabels(), *axes.get_yticklabels()]
    return [text.get_text() for text in found if text.get_text()]


def at_zero_load(speed, temperature):
    """Equation (16) at L = 0 with the published parameters, written out by hand."""
    return 10.57 + (3.48 + 15.66 * np.exp(-0.056 * temperature)) * np.sqrt(speed)
