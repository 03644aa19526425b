"""Numbers as a reader meets them on a page: tables by caption, and every number of the text."""

import re
from html.parser import HTMLParser

NUMBER = re.compile(r"(?<![\w.#])[−-]?\d+(?:[.,]\d+)*(?:e[−-]?\d+)?")
"""A number with decimals, groups of thousands or an exponent; none inside a name such as day1."""

_HIDDEN = {"script", "style", "svg", "noscript", "title", "code", "pre", "option", "select"}
_VOID = {"meta", "link", "img", "input", "br", "hr"}


class Page(HTMLParser):
    """Tables, and text outside of tables by section, without scripts, figures and code."""

    def __init__(self, text):
        super().__init__()
        self.tables = {}
        self.texts = []
        self._open = []
        self._rows, self._cell, self._caption = None, None, None
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        if tag in _VOID:
            return
        self._open.append((tag, dict(attrs)))
        if tag == "table":
            self._rows, self._caption = [], ""
        elif tag == "tr" and self._rows is not None:
            self._rows.append([])
        elif tag in ("td", "th") and self._rows is not None:
            self._rows[-1].append("")

    def handle_endtag(self, tag):
        while self._open and self._open.pop()[0] != tag:
            pass
        if tag == "table":
            self.tables.setdefault(self._caption.strip(), []).append(self._rows)
            self._rows = None

    def handle_data(self, data):
        tags = [tag for tag, _ in self._open]
        if _HIDDEN & {*tags}:
            return
        if self._rows is not None:
            if "caption" in tags:
                self._caption += data
            elif self._rows and self._rows[-1]:
                self._rows[-1][-1] += data
        elif data.strip():
            section = next((a["id"] for _, a in reversed(self._open) if a.get("id")), "")
            self.texts.append((section, tags[-1] if tags else "", data.strip()))


def numbers(text):
    """Numbers of a text, each as it is written."""
    return NUMBER.findall(text)


def value(written):
    return float(written.replace("−", "-").replace(",", ""))


def agrees(written, values):
    """Return whether a number as written is one of the values, rounded to the digits written."""
    mantissa, _, exponent = written.replace("−", "-").partition("e")
    decimals = len(mantissa.partition(".")[2])
    half = 0.5 * 10.0 ** (int(exponent or 0) - decimals)
    shown = value(written)
    return any(abs(shown - one) <= half * (1 + 1e-9) + 1e-12 for one in values)


def leaves(document):
    """All numbers of a document."""
    if isinstance(document, dict):
        for key, one in document.items():
            if key != "provenance":
                yield from leaves(one)
    elif isinstance(document, (list, tuple)):
        for one in document:
            yield from leaves(one)
    elif isinstance(document, (int, float)) and not isinstance(document, bool):
        yield float(document)
