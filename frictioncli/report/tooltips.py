"""Values that show when the pointer rests on a point of a figure: SVG titles, no script."""

import re
from collections.abc import Sequence
from html import escape
from urllib.parse import quote, unquote

from matplotlib.artist import Artist

_MARK = "told:"
_GROUP = re.compile(rf' id="{_MARK}([^"]*)"')
_MARKER = re.compile(r"<use ([^>]*)/>")


def set_tooltips(artist: Artist, texts: Sequence[str]) -> None:
    """Let a drawn artist carry what its points set_tooltips, until the figure becomes an SVG.

    Parameters
    ----------
    artist : Artist
        Markers of a line, in the order of the texts, or a shape, which takes one text.
    texts : sequence of str
        One per point.
    """
    # matplotlib writes the identifier into the SVG: it takes the texts there, quoted so that
    # commas part them and nothing in them means anything to XML
    artist.set_gid(_MARK + ",".join(quote(text) for text in texts))


def tooltips_as_titles(svg: str) -> str:
    """Return an SVG in which what its artists carry are titles of their points.

    Parameters
    ----------
    svg : str
        As matplotlib writes it.
    """
    head, *groups = _GROUP.split(svg)
    parts = [head]
    for texts, rest in zip(groups[::2], groups[1::2], strict=True):
        parts.append(_titled([unquote(text) for text in texts.split(",")], rest))
    return "".join(parts)


def _titled(texts: list[str], rest: str) -> str:
    """Put the titles into the markers that follow, or into the shape."""
    end = rest.find('<g id="')
    own, others = (rest, "") if end < 0 else (rest[:end], rest[end:])
    titles = [f"<title>{escape(text, quote=False)}</title>" for text in texts]
    markers = len(_MARKER.findall(own))
    if not markers and len(titles) == 1:
        return own.replace(">", f">{titles[0]}", 1) + others
    if markers != len(titles):
        # a point outside the picture is not drawn: better no value than a wrong one
        return own + others
    following = iter(titles)
    return _MARKER.sub(lambda marker: f"<use {marker[1]}>{next(following)}</use>", own) + others
