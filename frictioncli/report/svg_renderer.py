"""Drawing as SVG with what markers have in common written once.

matplotlib repeats colours and widths for every point, which takes longer than writing its place and
makes a page twice as large.
"""

import io
from typing import Any, cast

import numpy as np
from matplotlib.backend_bases import GraphicsContextBase, RendererBase
from matplotlib.backends.backend_mixed import MixedModeRenderer
from matplotlib.backends.backend_svg import FigureCanvasSVG, RendererSVG
from matplotlib.figure import Figure
from matplotlib.path import Path
from matplotlib.transforms import Affine2D, Transform

_POINTS_PER_INCH = 72.0
_DIGITS = 3
"""Digits of the places of markers after the decimal point; 1 is a point, 1/72 inch."""

_UPSIDE_DOWN = Affine2D().scale(1.0, -1.0)
_NO_METADATA = {"Date": None, "Creator": None, "Format": None, "Type": None}


def drawn_as_svg(figure: Figure) -> str:
    """Return a figure as an SVG document.

    Parameters
    ----------
    figure : Figure
        The figure; its resolution becomes that of SVG, 72 dots per inch.
    """
    stream = io.StringIO()
    # Figure.savefig would draw the figure twice
    FigureCanvasSVG(figure)
    pixels_per_inch, figure.dpi = figure.dpi, _POINTS_PER_INCH
    width, height = figure.get_size_inches()
    points = width * _POINTS_PER_INCH, height * _POINTS_PER_INCH
    vector = _Renderer(stream, *points, image_dpi=pixels_per_inch, metadata=_NO_METADATA)
    renderer = MixedModeRenderer(figure, width, height, pixels_per_inch, vector)
    figure.draw(cast(RendererBase, renderer))
    renderer.finalize()
    return stream.getvalue()


class _Renderer(RendererSVG):
    """Renderer of SVG that writes the style of markers once for all of them."""

    def __init__(self, stream: io.StringIO, width: float, height: float, **options: Any) -> None:
        super().__init__(width, height, stream, **options)
        self._stream = stream

    def draw_markers(
        self,
        gc: GraphicsContextBase,
        marker_path: Path,
        marker_trans: Transform,
        path: Path,
        trans: Transform,
        rgbFace: Any = None,
    ) -> None:
        """Draw a marker at each vertex of a path."""
        places = trans.transform(path.vertices)
        places = places[np.isfinite(places).all(axis=1)]
        if not len(places):
            return
        style = self._get_style_dict(gc, rgbFace)
        # groups pass on all but the opacity, which would be that of the group as a whole
        opacity = style.pop("opacity", "")
        shape = self._convert_path(marker_path, marker_trans + _UPSIDE_DOWN, simplify=False)
        if shape not in self._markers:
            self._markers[shape] = self._make_id("m", shape)
            self.writer.start("defs")
            self.writer.element("path", id=self._markers[shape], d=shape)
            self.writer.end("defs")
        css = "; ".join(f"{name}: {value}" for name, value in style.items())
        self.writer.start("g", style=css, **self._get_clip_attrs(gc))
        common = {"xlink:href": f"#{self._markers[shape]}"}
        if opacity:
            common["opacity"] = opacity
        texts = [(f"{x:.{_DIGITS}f}", f"{self.height - y:.{_DIGITS}f}") for x, y in places.tolist()]
        self.writer.element("use", attrib={**common, "x": texts[0][0], "y": texts[0][1]})
        head = "<use " + " ".join(f'{name}="{value}"' for name, value in common.items())
        # after an element the writer holds nothing back, so that the others can be written at once
        self._stream.write("".join(f'{head} x="{x}" y="{y}"/>\n' for x, y in texts[1:]))
        self.writer.end("g")
