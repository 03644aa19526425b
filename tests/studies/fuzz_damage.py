"""Damage done to logs, from a number: the same number does the same damage."""

import gzip
import random
from collections.abc import Callable
from dataclasses import dataclass

from tests.studies.fuzz_layout import Layout

_CELLS = (
    b"nan",
    b"NaN",
    b"inf",
    b"-inf",
    b"1e308",
    b"-1e308",
    b"1e309",
    b"4.9e-324",
    b"9.9e34",
    b"0x1F",
    b"1_000",
    b"1.234,5",
    b"1,234.5",
    b"--1",
    b"1e",
    b".",
    b"-",
    b"",
    b" ",
    b"null",
    b"True",
    b"2024-05-17T09:30:00",
    b"9999-12-31",
    b"0001-01-01",
    b"292277026596",
    b"-1",
    b"0",
    b"9223372036854775807",
    b"18446744073709551616",
    b"\xd9\xa1\xd9\xa2",
    b"\xef\xbc\x91",
)
_TEXTS = (
    b"<script>alert(1)</script>",
    b"=cmd|' /C calc'!A0",
    b"@SUM(1+1)*cmd",
    b"\x1b[31mred\x1b[2J",
    b"../../../../tmp/x",
    b"..\\..\\x",
    b"C:\\Windows\\x",
    b"/etc/passwd",
    b"%s%n%x",
    b"{0.__class__}",
    b"{{7*7}}",
    b"\x00",
    b"\xff\xfe",
    b"\xef\xbb\xbf",
    b"\xe2\x80\xae",
    b"\r",
    b"\x0b\x0c\x85",
    b'"',
    b'""',
    b'"""',
    b"'",
    b"\\",
    b"\t",
    b";",
    b",",
    b"\xc2\xb0",
    b"\xc3\xaf\xc2\xbf\xc2\xbd",
    b"[deg]",
    b"[rad]",
    b"[K]",
    b"[ms]",
    b"#",
    b"sep=;",
    b"AxisPos_Act3[\xb0]",
    b"Zeit[sec]",
    b"!!python/object",
)


@dataclass(frozen=True, slots=True)
class Case:
    """A damaged folder.

    Attributes
    ----------
    layout : Layout
        What it was.
    damage : str
        What was done to it.
    files : dict of str to bytes
        What the folder holds.
    touched : int or None
        Rows of the log that may have changed; None where any may have.
    whole : tuple of int or None
        Indices of the rows that stand in the log as they did, where it is known.
    lines : int or None
        Lines of the log from the first row on that are not blank, where the header is whole.
    """

    layout: Layout
    damage: str
    files: dict[str, bytes]
    touched: int | None = None
    whole: tuple[int, ...] | None = None
    lines: int | None = None


def case(number: int, layouts: tuple[Layout, ...]) -> Case:
    """Return the damaged folder of a number."""
    draw = random.Random(number)
    layout = layouts[number % len(layouts)]
    kinds: list[Callable[[Layout, random.Random], Case]] = [_bytes, _bytes, _mixed, _extreme]
    if not layout.binary:
        kinds += [_rows] * 8 + [_header] * 3
    if layout.others:
        kinds += [_other] * 6
    return draw.choice(kinds)(layout, draw)


def _folder(layout: Layout, content: bytes) -> dict[str, bytes]:
    return {layout.log: content, **layout.others}


def _rows(layout: Layout, draw: random.Random) -> Case:
    """Damage some rows; all others are known."""
    rows = list(layout.rows)
    hit = {draw.randrange(len(rows)) for _ in range(draw.choice((1, 1, 2, 5, 20)))}
    name, damage = draw.choice(ROW_DAMAGE)
    for index in hit:
        rows[index] = damage(rows[index], draw)
    whole = tuple(sorted(set(range(len(rows))) - hit))
    if name == "last line cut":
        rows[-1] = rows[-1][: draw.randrange(len(rows[-1]))]
        whole = tuple(i for i in whole if i != len(rows) - 1)
    content = layout.content(rows=rows)
    lines = [line for row in rows for line in row.split(b"\n") if line.strip(b" \r")]
    # undecodable bytes and other alphabets change the count in other encodings
    countable = all(row.isascii() for row in rows)
    return Case(
        layout,
        f"row: {name}",
        _folder(layout, content),
        touched=sum(row.count(b"\n") + 1 for row in (rows[i] for i in hit)) + 1,
        whole=whole,
        lines=len(lines) if countable else None,
    )


def _cells(row: bytes) -> tuple[list[bytes], bytes]:
    delimiter = max((b";", b"\t", b",", b" "), key=row.count)
    return row.split(delimiter), delimiter


def _cell(row: bytes, draw: random.Random) -> bytes:
    cells, delimiter = _cells(row)
    cells[draw.randrange(len(cells))] = draw.choice(_CELLS)
    return delimiter.join(cells)


def _cell_text(row: bytes, draw: random.Random) -> bytes:
    cells, delimiter = _cells(row)
    at = draw.randrange(len(cells))
    cells[at] = draw.choice((cells[at], b"")) + draw.choice(_TEXTS)
    return delimiter.join(cells)


def _flipped(row: bytes, draw: random.Random) -> bytes:
    damaged = bytearray(row)
    for _ in range(draw.choice((1, 1, 3, 10))):
        at = draw.randrange(len(damaged))
        # no flip into or out of a line end: the lines stay what they are
        value = damaged[at] ^ (1 << draw.randrange(8))
        if value not in b"\r\n":
            damaged[at] = value
    return bytes(damaged)


def _cell_lost(row: bytes, draw: random.Random) -> bytes:
    cells, delimiter = _cells(row)
    del cells[draw.randrange(len(cells))]
    return delimiter.join(cells)


ROW_DAMAGE: tuple[tuple[str, Callable[[bytes, random.Random], bytes]], ...] = (
    ("another cell", _cell),
    ("another cell", _cell),
    ("text in a cell", _cell_text),
    ("text in a cell", _cell_text),
    ("bits flipped", _flipped),
    ("bits flipped", _flipped),
    ("cell lost", _cell_lost),
    ("cell more", lambda row, draw: row + _cells(row)[1] + draw.choice(_CELLS)),
    ("cut", lambda row, draw: row[: draw.randrange(len(row))]),
    ("doubled", lambda row, draw: row + b"\n" + row),
    ("broken in two", lambda row, draw: row[:9] + b"\n" + row[9:]),
    ("emptied", lambda row, draw: b""),
    ("comment", lambda row, draw: b"# " + row),
    ("quote opened", lambda row, draw: b'"' + row),
    ("quotes nested", lambda row, draw: b'"' + row.replace(b"1", b'""') + b'"'),
    ("NUL bytes", lambda row, draw: row[:5] + b"\0" * draw.randrange(1, 9) + row[5:]),
    ("huge cell", lambda row, draw: row + b"1" * draw.choice((1_000, 100_000, 1_000_000))),
    ("huge text", lambda row, draw: row + b"x" * draw.choice((1_000, 100_000, 1_000_000))),
    ("last line cut", lambda row, draw: row),
)
"""What can happen to a row: its name, and a function from the row to what becomes of it."""


def _header(layout: Layout, draw: random.Random) -> Case:
    """Damage the lines before the first row."""
    head = list(layout.head) or [b""]
    cells, delimiter = _cells(head[-1])
    at = draw.randrange(len(cells))
    kind = draw.randrange(8)
    if kind == 0:
        cells[at] += draw.choice(_TEXTS)
    elif kind == 1:
        cells[at] = draw.choice(_TEXTS)
    elif kind == 2:
        cells[at] = cells[draw.randrange(len(cells))]
    elif kind == 3:
        del cells[at]
    elif kind == 4:
        draw.shuffle(cells)
    elif kind == 5:
        cells.append(draw.choice(_TEXTS) * draw.choice((1, 1, 1000)))
    elif kind == 6:
        cells[at] = b"h" * draw.choice((300, 100_000))
    head[-1] = delimiter.join(cells)
    if kind == 7:
        head = draw.choice(([], [b"", *head], [*head, *head], [b"x" * 70_000, *head]))
    return Case(layout, "header", _folder(layout, layout.content(head=head)))


def _damaged(content: bytes, draw: random.Random) -> tuple[str, bytes]:
    data = bytearray(content)
    kind = draw.choice(("bits", "cut", "doubled", "lost", "inserted", "zeros", "shuffled"))
    begin = draw.randrange(len(data)) if data else 0
    size = min(draw.choice((1, 8, 100, 5_000)), len(data) - begin)
    if kind == "bits":
        for _ in range(draw.choice((1, 3, 30, 300))):
            if data:
                data[draw.randrange(len(data))] ^= 1 << draw.randrange(8)
    elif kind == "cut":
        del data[begin:]
    elif kind == "doubled":
        data[begin:begin] = data[begin : begin + size]
    elif kind == "lost":
        del data[begin : begin + size]
    elif kind == "inserted":
        data[begin:begin] = draw.choice((draw.choice(_TEXTS), draw.randbytes(size)))
    elif kind == "zeros":
        data[begin : begin + size] = bytes(size)
    elif data:
        other = draw.randrange(len(data))
        size = min(size, len(data) - other)
        data[begin : begin + size] = data[other : other + size]
    return kind, bytes(data)


def _bytes(layout: Layout, draw: random.Random) -> Case:
    """Damage the log as bytes, anywhere."""
    kind, content = _damaged(layout.content(), draw)
    return Case(layout, f"bytes: {kind}", _folder(layout, content))


def _other(layout: Layout, draw: random.Random) -> Case:
    """Damage a file beside the log."""
    name = draw.choice(sorted(layout.others))
    content = layout.others[name]
    if draw.random() < 0.5:
        _, content = _damaged(content, draw)
    else:
        lines = content.split(b"\n")
        at = draw.randrange(len(lines))
        lines[at] = draw.choice((_cell, _cell_text, _flipped))(lines[at] or b"x", draw)
        content = b"\n".join(lines)
    return Case(layout, "file beside", _folder(layout, layout.content()) | {name: content})


def _mixed(layout: Layout, draw: random.Random) -> Case:
    """Mix encodings, or two contents."""
    content = layout.content()
    text = content.decode("cp1252", "replace")
    kind = draw.choice(
        ("utf-16", "utf-16-le", "utf-16-be", "utf-32", "cp037", "halves", "gzip", "twice")
    )
    if kind == "halves":
        middle = len(text) // 2
        content = text[:middle].encode("utf-8", "replace") + text[middle:].encode("utf-16")
    elif kind == "gzip":
        content = gzip.compress(content, 1, mtime=0)
        content = content[: draw.choice((len(content), draw.randrange(len(content))))]
    elif kind == "twice":
        content = content + content
    else:
        content = text.encode(kind, "replace")
    return Case(layout, f"mixed: {kind}", _folder(layout, content))


def _extreme(layout: Layout, draw: random.Random) -> Case:
    """Replace the log by something of an extreme size or shape."""
    rare = draw.random() < 0.02
    columns = draw.choice((100_000, 1_000_000) if rare else (1_000, 10_000))
    kind = draw.choice(
        ("columns", "one line", "numbers", "nothing", "noise", "bomb", "quotes", "time")
    )
    if kind == "columns":
        content = b";".join(b"c%d" % i for i in range(columns)) + b"\n"
        content += (b";".join([b"1"] * columns) + b"\n") * 3
    elif kind == "one line":
        content = b"1;2;3 " * (10 * columns)
    elif kind == "numbers":
        content = b"Zeit[sec];AxisPos_Act2[deg];GearTorq_Act2[Nm]\n" + b"1;1;1\n" * columns
    elif kind == "nothing":
        content = draw.choice(
            (b"", b"\n", b"\n" * 1000, b" ", b"\xef\xbb\xbf", b"\0" * 1000, b";\n;\n")
        )
    elif kind == "noise":
        content = draw.randbytes(draw.choice((10, 1_000, 100_000)))
    elif kind == "bomb":
        size = 1 << (30 if rare else 24)
        content = _bomb(size, draw.choice((b"\0", b"1;", b"1;2\n")))
    elif kind == "quotes":
        content = b'"' * columns + b";" + b'""' * columns
    else:
        start = draw.choice((b"1e300", b"-1e300", b"253402300800", b"1e18", b"5e-324", b"-0"))
        rows = [start + b";" + row.partition(b";")[2] for row in layout.rows]
        content = layout.content(rows=rows) if not layout.binary else start
    return Case(layout, f"extreme: {kind}", _folder(layout, content))


def _bomb(size: int, pattern: bytes) -> bytes:
    """Return gzip bytes that unpack to ``size`` bytes of a pattern."""
    block = (pattern * (1 << 20))[: 1 << 20]
    packed = gzip.compress(block, 9, mtime=0)
    return packed * (size >> 20)
