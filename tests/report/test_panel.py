"""Panels have the ticks, labels and grid that matplotlib's own axes have, in the same places."""

import io
import re

import numpy as np
import pytest
from matplotlib.axes import Axes  # noqa: TID251
from matplotlib.backends.backend_agg import FigureCanvasAgg  # noqa: TID251
from matplotlib.backends.backend_svg import FigureCanvasSVG  # noqa: TID251
from matplotlib.figure import Figure  # noqa: TID251

from frictioncli.report.panel import Panel, name_ticks
from frictioncli.report.style import style_context

TEXT = re.compile(
    r"<text style=\"([^\"]*)\"(?: x=\"\S+\" y=\"\S+\")? transform=\"([^\"]*)\">(.*)</text>"
)
STEP = re.compile(r"[-+.\d]+")


def plain(axes):
    axes.plot([0.0, 3.1], [-40.0, 260.0])
    axes.set_xlabel("speed [deg/s]")
    axes.set_ylabel("torque [N·m]")


def logarithmic(axes):
    axes.plot([0.02, 30.0], [1.0, 2.0])
    axes.set_xscale("log")
    axes.set_ylabel("torque [N·m]")


def named(axes):
    axes.plot([0.0, 2.0], [0.0, 5.0])
    name_ticks(axes.xaxis, [0, 1, 2], ["none", "some\nmore", "all"])
    axes.grid(visible=False, axis="x")
    axes.set_xlabel("kind")


def inverted(axes):
    axes.plot([0.0, 2e-7], [0.0, 5e8])
    axes.invert_yaxis()
    axes.tick_params(labelbottom=False)
    axes.set_ylabel("torque [N·m]")


def drawn(kind, fill):
    """Return the figure, its texts with style and place, and the ends of all straight lines."""
    with style_context():
        figure = Figure(figsize=(5, 4), layout="constrained")
        axes = figure.subplots(subplot_kw={"axes_class": kind})
        fill(axes)
        stream = io.StringIO()
        FigureCanvasSVG(figure).print_svg(stream, metadata={"Date": None})
    return axes, TEXT.findall(stream.getvalue()), stream.getvalue()


def grid_places(svg):
    """Return the ends of the grid's lines, in order."""
    paths = re.findall(r'<path d="([^"]*)"[^>]*stroke: #e4e6ea', svg)
    ends = np.array([STEP.findall(path) for path in paths for path in re.split("(?=M)", path)[1:]])
    return ends[np.lexsort(ends.T)].astype(float)


@pytest.mark.parametrize("fill", [plain, logarithmic, named, inverted])
def test_a_panel_looks_as_axes_do(fill):
    axes, expected, _ = drawn(Axes, fill)
    panel, texts, _ = drawn(Panel, fill)
    assert len(texts) == len(expected) > 3
    for (style, place, text), (known_style, known_place, known_text) in zip(
        sorted(texts, key=lambda one: one[2]), sorted(expected, key=lambda one: one[2]), strict=True
    ):
        assert (style, text) == (known_style, known_text)
        found, wanted = (np.array(STEP.findall(one), dtype=float) for one in (place, known_place))
        np.testing.assert_allclose(found, wanted, atol=0.2)
    np.testing.assert_allclose(
        panel.get_position().get_points(), axes.get_position().get_points(), atol=1e-3
    )


@pytest.mark.parametrize("fill", [plain, logarithmic, named, inverted])
def test_the_grid_has_its_lines_at_the_ticks(fill):
    _, _, expected = drawn(Axes, fill)
    _, _, svg = drawn(Panel, fill)
    np.testing.assert_allclose(grid_places(svg), grid_places(expected), atol=0.2)


def pixels(kind):
    with style_context():
        figure = Figure(figsize=(5, 4), dpi=200)
        plain(figure.add_axes((0.2, 0.2, 0.7, 0.7), axes_class=kind))
        canvas = FigureCanvasAgg(figure)
        canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3].astype(float)


def test_lines_are_as_wide_at_any_resolution():
    expected = pixels(Axes)
    assert np.abs(pixels(Panel) - expected).mean() < 0.02 * np.abs(255.0 - expected).mean()
