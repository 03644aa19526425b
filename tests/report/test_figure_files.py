"""The bytes of a figure do not depend on the last digits of the layout's solver."""

import numpy as np
from matplotlib.figure import Figure  # noqa: TID251
from matplotlib.layout_engine import ConstrainedLayoutEngine  # noqa: TID251

from frictioncli.report.figure_files import svg

LAST = 4e-16
"""What positions differ by from one process to another."""


def drawn(monkeypatch, away):
    """Return a figure of three panels with a colour bar, whose layout ends so far away."""
    solve = ConstrainedLayoutEngine.execute

    def moved(engine, figure):
        solve(engine, figure)
        for axes in figure.axes:
            axes.set_position(axes.get_position(original=True).translated(away, away))

    figure = Figure(figsize=(5, 4), layout="constrained")
    upper, lower = figure.subfigures(2, 1, height_ratios=(2, 1))
    panels = upper.subplots(1, 2, sharey=True)
    mesh = panels[1].pcolormesh(np.arange(6.0).reshape(2, 3))
    upper.colorbar(mesh, ax=list(panels))
    lower.subplots().set_title("below")
    with monkeypatch.context() as patched:
        patched.setattr(ConstrainedLayoutEngine, "execute", moved)
        return figure, svg(figure, "figure", "figure")


def test_the_last_digits_of_the_layout_are_not_those_of_the_file(monkeypatch):
    figure, text = drawn(monkeypatch, 0.0)
    again, same = drawn(monkeypatch, LAST)
    for one, other in zip(figure.axes, again.axes, strict=True):
        assert (one.get_position().get_points() == other.get_position().get_points()).all()
    assert text.count("<path") == same.count("<path") > 10
    _, other = drawn(monkeypatch, 1e-3)
    assert other.count("<path") == text.count("<path")
    assert other != text
