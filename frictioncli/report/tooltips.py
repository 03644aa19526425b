"""Tooltips of points in a figure, as SVG titles without a script."""

import re
from collections.abc import Sequence
from html import escape
from urllib.parse import quote, unquote

from matplotlib.artist import Artist

_MARK = "tooltips:"
_GROUP = re.compile(rf' id="{_MARK}([^"]*)"')
_MARKER = re.compile(r"<use ([^>]*)/>")


def set_tooltips(artist: Artist, texts: Sequence[str]) -> None:
    """Attach tooltips to a drawn artist; :func:`tooltips_as_titles` turns them into SVG titles.

    Parameters
    ----------
    artist : Artist
        Markers of a line, or a shape.
    texts : sequence of str
        One text per marker, in their order; a shape takes a single text.
    """
    # matplotlib writes the artist's identifier into the SVG: it carries the texts, quoted so that
    # commas separate them and no character has a meaning in XML
    artist.set_gid(_MARK + ",".join(quote(text) for text in texts))


def tooltips_as_titles(svg: str) -> str:
    """Return an SVG in which the tooltips attached to artists are titles of their points.

    Parameters
    ----------
    svg : str
        SVG as written by matplotlib.
    """
    head, *groups = _GROUP.split(svg)
    parts = [head]
    for texts, rest in zip(groups[::2], groups[1::2], strict=True):
        parts.append(_titled([unquote(text) for text in texts.split(",")], rest))
    return "".join(parts)


def _titled(texts: list[str], rest: str) -> str:
    """Insert the titles into the markers that follow, or into the shape."""
    end = rest.find('<g id="')
    group, others = (rest, "") if end < 0 else (rest[:end], rest[end:])
    titles = [f"<title>{escape(text, quote=False)}</title>" for text in texts]
    markers = len(_MARKER.findall(group))
    if not markers and len(titles) == 1:
        return group.replace(">", f">{titles[0]}", 1) + others
    if markers != len(titles):
        # some point is not drawn, so texts and markers cannot be matched
        return group + others
    following = iter(titles)
    return _MARKER.sub(lambda marker: f"<use {marker[1]}>{next(following)}</use>", group) + others
