"""Panels of the figures: axes that draw their ticks as a few paths and measure each label once.

matplotlib keeps five artists per tick, which it creates, measures and draws one by one, several
times per figure; that takes longer than drawing the data.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, cast

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis, Tick, XAxis, YAxis
from matplotlib.backend_bases import RendererBase
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure, FigureBase
from matplotlib.path import Path
from matplotlib.text import Text
from matplotlib.ticker import FixedFormatter, FixedLocator, NullLocator
from matplotlib.transforms import Bbox, IdentityTransform

from frictioncli.arrays import Array
from frictioncli.report.tick_labels import Layouts, TickLabels

_NEAR = 1e-6
"""Share of an axis by which a tick may lie outside its limits."""

_STYLE = cast("Mapping[str, Any]", matplotlib.rcParams)
"""matplotlib's settings, which are those of the style while a figure is drawn."""

_POINTS_PER_INCH = 72.0
_PIXELS = IdentityTransform()


def stacked(
    parent: FigureBase,
    rows: int,
    heights: Sequence[float] | None = None,
    *,
    share_x: bool = False,
    share_y: bool = False,
) -> list[Axes]:
    """Return new panels in one column, from top to bottom.

    Parameters
    ----------
    parent : FigureBase
        Figure or part of a figure.
    rows : int
        Number of panels.
    heights : sequence of float, optional
        Their heights relative to each other; equal if left out.
    share_x, share_y : bool
        Whether they have a common axis.
    """
    grid = parent.subplots(
        rows,
        1,
        sharex=share_x,
        sharey=share_y,
        squeeze=False,
        height_ratios=heights,
        subplot_kw={"axes_class": Panel, "layouts": {}},
    )
    return list(grid[:, 0])


def name_ticks(axis: Axis, places: Iterable[float], names: Iterable[str]) -> None:
    """Set the ticks of an axis and their labels, without minor ticks.

    Parameters
    ----------
    axis : Axis
        The axis.
    places : iterable of float
        Where the ticks are, in data units.
    names : iterable of str
        Their labels.
    """
    axis.set_major_locator(FixedLocator(list(places)))
    axis.set_major_formatter(FixedFormatter(list(names)))
    axis.set_minor_locator(NullLocator())


class _PathAxis(Axis):
    """An axis whose grid is one path, and its ticks another."""

    along: int
    """Index of the coordinate that the axis measures."""

    kind: str
    """Prefix of its settings."""

    side: str
    """Side of the panel at which its ticks are."""

    def reset_ticks(self) -> None:
        """Forget the ticks; they become artists only if something asks for them."""
        self.majorTicks: list[Tick] = []
        self.minorTicks: list[Tick] = []

    def draw(self, renderer: RendererBase) -> None:
        """Draw grid, ticks, their labels and the name of the axis."""
        if not self.get_visible():
            return
        renderer.open_group(__name__, gid=self.get_gid())
        labels = self._tick_labels()
        boxes = []
        for which in ("major", "minor"):
            places, texts = self._ticks(which)
            if not texts:
                continue
            style = self.get_tick_params(cast(Any, which))
            if style.get("gridOn", False):
                self._draw_lines(renderer, "grid", places, self._edge, self._far_edge)
            if style[self.side]:
                end = self._edge - self._tick_size(which)
                self._draw_lines(renderer, f"{self.kind}.{which}", places, end, self._edge)
            for text, at in self._labelled(which, places, texts):
                labels.draw(renderer, text, at)
                boxes.append(labels.extent(renderer, text, at))
        for name in self._named(boxes):
            name.draw(renderer)
        renderer.close_group(__name__)
        self.stale = False

    def get_tightbbox(
        self, renderer: RendererBase | None = None, *, for_layout_only: bool = False
    ) -> Bbox | None:
        """Return the box around ticks, their labels and the name of the axis.

        With ``for_layout_only`` the box of the name has no length along the axis.
        """
        if not self.get_visible():
            return None
        if renderer is None:
            renderer = cast(Any, self.get_figure(root=True))._get_renderer()
        labels = self._tick_labels()
        boxes = [
            labels.extent(renderer, text, at)
            for which in ("major", "minor")
            for text, at in self._labelled(which, *self._ticks(which))
        ]
        corners = self.axes.bbox.get_points().copy()
        corners[:, 1 - self.along] = (self._edge - self._tick_size("major"), self._edge)
        around = [*boxes, Bbox(corners)]
        for text in self._named(boxes):
            box = text.get_window_extent(renderer)
            if text is self.label and for_layout_only:
                corners = box.get_points()
                corners[:, self.along] = corners[:, self.along].mean() + np.array([-0.5, 0.5])
                box = Bbox(corners)
            around.append(box)
        return Bbox.union(around)

    def _labelled(
        self, which: str, places: Array, texts: Sequence[str]
    ) -> Iterator[tuple[str, tuple[float, float]]]:
        """Yield text and anchor of each label."""
        if self.get_tick_params(cast(Any, which))[f"label{self.side}"]:
            pad = self._pixels(_STYLE[f"{self.kind}.{which}.pad"])
            across = self._edge - self._tick_size(which) - pad
            for place, text in zip(places.tolist(), texts, strict=True):
                if text:
                    yield text, (place, across) if self.along == 0 else (across, place)

    def _named(self, boxes: Sequence[Bbox]) -> list[Text]:
        """Place the name of the axis and the common factor of its labels; return which it has."""
        self.offsetText.set_text(self.get_major_formatter().get_offset())
        if self.offsetText.get_text():
            cast(Any, self)._update_offset_text_position(boxes, [])
        if self.label.get_text():
            outermost = [box.get_points()[0, 1 - self.along] for box in boxes]
            at = list(self.label.get_position())
            at[1 - self.along] = min([self._edge - self._tick_size("major"), *outermost])
            at[1 - self.along] -= self._pixels(self.labelpad)
            self.label.set_position((at[0], at[1]))
        texts = (self.label, self.offsetText)
        return [text for text in texts if text.get_text() and text.get_visible()]

    def _ticks(self, which: str) -> tuple[Array, list[str]]:
        """Return place [pixel] and label of each tick within the limits."""
        major = which == "major"
        if isinstance(self.get_major_locator() if major else self.get_minor_locator(), NullLocator):
            return np.empty(0), []
        places = list(self.get_majorticklocs() if major else self.get_minorticklocs())
        formatter = self.get_major_formatter() if major else self.get_minor_formatter()
        texts = formatter.format_ticks(places)
        transform = self.get_transform()
        low, high = sorted(transform.transform(np.array(self.get_view_interval())))
        scaled = transform.transform(np.asarray(places, dtype=float))
        near = _NEAR * (high - low)
        inside = np.flatnonzero((scaled >= low - near) & (scaled <= high + near))
        # any place on the other axis, which may have no zero
        corners = np.tile(self.axes.viewLim.get_points()[0], (len(inside), 1))
        corners[:, self.along] = np.asarray(places, dtype=float)[inside]
        return self.axes.transData.transform(corners)[:, self.along], [texts[i] for i in inside]

    def _draw_lines(
        self, renderer: RendererBase, setting: str, places: Array, start: float, end: float
    ) -> None:
        """Draw a line across the axis at each of the places, all of them as one path."""
        points = np.empty((len(places), 2, 2))
        points[:, :, self.along] = places[:, np.newaxis]
        points[:, :, 1 - self.along] = (start, end)
        codes = np.tile([Path.MOVETO, Path.LINETO], len(places))
        grid = setting == "grid"
        gc = renderer.new_gc()
        gc.set_foreground(to_rgba(_STYLE["grid.color" if grid else f"{self.kind}.color"]))
        width = _STYLE["grid.linewidth" if grid else f"{setting}.width"]
        gc.set_linewidth(width)
        renderer.draw_path(gc, Path(points.reshape(-1, 2), codes), _PIXELS)
        gc.restore()

    def _tick_labels(self) -> TickLabels:
        """Return what draws the labels, in their style."""
        style = self.get_tick_params("major")
        sideways = self.along == 0
        text = Text(
            fontsize=style.get("labelsize", _STYLE[f"{self.kind}.labelsize"]),
            color=style.get("labelcolor", _STYLE[f"{self.kind}.color"]),
            horizontalalignment="center" if sideways else "right",
            verticalalignment="top" if sideways else "center_baseline",
            transform=_PIXELS,
        )
        text.set_figure(cast(Figure, self.get_figure(root=False)))
        return TickLabels(text, self._pixels(1.0), cast(Panel, self.axes).layouts)

    @property
    def _edge(self) -> float:
        return float(self.axes.bbox.get_points()[0, 1 - self.along])

    @property
    def _far_edge(self) -> float:
        return float(self.axes.bbox.get_points()[1, 1 - self.along])

    def _tick_size(self, which: str) -> float:
        return self._pixels(_STYLE[f"{self.kind}.{which}.size"])

    def _pixels(self, points: float) -> float:
        return float(points * cast(Figure, self.get_figure(root=True)).dpi / _POINTS_PER_INCH)


class _PathXAxis(_PathAxis, XAxis):
    along, kind, side = 0, "xtick", "bottom"


class _PathYAxis(_PathAxis, YAxis):
    along, kind, side = 1, "ytick", "left"


class Panel(Axes):
    """Axes with ticks at the lower and the left edge, drawn as paths.

    Parameters
    ----------
    *where : FigureBase, SubplotSpec
        As of matplotlib's axes.
    layouts : dict, optional
        Layouts of the labels of ticks, for panels that share them.
    **options
        As of matplotlib's axes.
    """

    def __init__(self, *where: Any, layouts: Layouts | None = None, **options: Any) -> None:
        self.layouts: Layouts = {} if layouts is None else layouts
        super().__init__(*where, **options)

    def _init_axis(self) -> None:
        self.xaxis = _PathXAxis(self, clear=False)
        self.yaxis = _PathYAxis(self, clear=False)
        for name, spine in self.spines.items():
            spine.register_axis(self.xaxis if name in ("bottom", "top") else self.yaxis)
            # ticks and their labels lie further out
            spine.set_in_layout(False)

    def clear(self) -> None:
        """Empty the panel."""
        super().clear()
        for spine in self.spines.values():
            # a spine's first tick would place it
            spine.set_position(("outward", 0.0))
