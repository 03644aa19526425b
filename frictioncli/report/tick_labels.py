"""Labels of ticks: a text is measured and laid out once, however often it is drawn."""

from dataclasses import dataclass
from typing import Any, cast

from matplotlib.backend_bases import RendererBase
from matplotlib.colors import to_rgba
from matplotlib.text import Text
from matplotlib.transforms import Bbox


@dataclass(frozen=True, slots=True)
class Layout:
    """Where a text is when its anchor is at the origin."""

    extent: Bbox
    start: tuple[float, float] | None
    """Where the renderer starts to write; None for a text that it cannot write in one piece."""


Layouts = dict[tuple[str, str, Any, float], Layout]
"""Layouts of texts by text, alignment, size and resolution."""


class TickLabels:
    """Labels of one axis, which differ in text and place only.

    Parameters
    ----------
    style : Text
        Text with the style of all labels, placed in pixels.
    resolution : float
        Pixels per point.
    layouts : dict
        Layouts that are known; new ones are added.
    """

    def __init__(self, style: Text, resolution: float, layouts: Layouts) -> None:
        self._text = style
        self._resolution = resolution
        self._layouts = layouts

    def extent(self, renderer: RendererBase, text: str, at: tuple[float, float]) -> Bbox:
        """Return the box around a label [pixel].

        Parameters
        ----------
        renderer : RendererBase
            What measures it.
        text : str
            The label.
        at : (float, float)
            Its anchor. [pixel]
        """
        return self._layout(renderer, text).extent.translated(*at)

    def draw(self, renderer: RendererBase, text: str, at: tuple[float, float]) -> None:
        """Draw a label.

        Parameters
        ----------
        renderer : RendererBase
            What draws it.
        text : str
            The label.
        at : (float, float)
            Its anchor. [pixel]
        """
        start = self._layout(renderer, text).start
        self._text.set_position(at)
        if start is None:
            self._text.set_text(text)
            self._text.draw(renderer)
            return
        gc = renderer.new_gc()
        gc.set_foreground(to_rgba(self._text.get_color()), isRGBA=True)
        upwards = -1.0 if renderer.flipy() else 1.0
        height = renderer.get_canvas_width_height()[1] if renderer.flipy() else 0.0
        x, y = at[0] + start[0], height + upwards * (at[1] + start[1])
        font = self._text.get_fontproperties()
        renderer.draw_text(gc, x, y, text, font, 0.0, ismath=False, mtext=self._text)
        gc.restore()

    def _layout(self, renderer: RendererBase, text: str) -> Layout:
        alignment = f"{self._text.get_horizontalalignment()} {self._text.get_verticalalignment()}"
        key = (text, alignment, self._text.get_fontsize(), self._resolution)
        if key not in self._layouts:
            self._text.set_text(text)
            self._text.set_position((0.0, 0.0))
            extent = self._text.get_window_extent(renderer)
            recorder = _Recorder(renderer)
            self._text.draw(cast(RendererBase, recorder))
            self._layouts[key] = Layout(extent, recorder.start)
        return self._layouts[key]


class _Recorder:
    """A renderer that writes nothing down but where a text of one piece would start."""

    def __init__(self, renderer: RendererBase) -> None:
        self._renderer = renderer
        self.start: tuple[float, float] | None = None

    def __getattr__(self, name: str) -> Any:
        return getattr(self._renderer, name)

    def open_group(self, _name: str, _gid: str | None = None) -> None:
        pass

    def close_group(self, _name: str) -> None:
        pass

    def draw_text(
        self, _gc: Any, x: float, y: float, *_: Any, ismath: Any = False, mtext: Any = None
    ) -> None:
        if mtext is not None and not ismath:
            height = self._renderer.get_canvas_width_height()[1]
            self.start = (x, height - y if self._renderer.flipy() else y)
