"""The table that ``challenge`` prints, and its figures in one place."""

from collections.abc import Sequence

from frictioncli.challenge_schema import AS_LOGGED, SEARCH, Row
from frictioncli.report.challenge_words import found_text, mark, summary
from frictioncli.wording import number_text

_HEAD = ("effect", "planted", "share", "claimed", "found at", "verdict", "names given", "")


def challenge_text(rows: Sequence[Row]) -> str:
    """Return what was there already, which sizes are found, and which names are wrong.

    Parameters
    ----------
    rows : sequence of dict
        Rows of :data:`frictioncli.challenge_schema.CHALLENGE`.
    """
    joints = sorted({row["joint"] for row in rows})
    return "\n".join(_joint_text([row for row in rows if row["joint"] == one]) for one in joints)


def _joint_text(rows: Sequence[Row]) -> str:
    logged = next(row for row in rows if row["purpose"] == AS_LOGGED)
    lines = [f"joint {logged['joint']} as logged: {_as_logged(logged)}"]
    planted = [row for row in rows if row["purpose"] not in (AS_LOGGED, SEARCH)]
    lines += _aligned([_HEAD, *map(_cells, planted)])
    return "\n".join([*lines, *summary(rows)])


def _as_logged(row: Row) -> str:
    told = _told(row)
    return f"{row['verdict']}" + (f" ({told})" if told else "")


def _told(row: Row) -> str:
    """Return what a diagnosis names, and along what it has structure without a name."""
    structure = f"structure along {row['structure']}" if row["structure"] else ""
    return "; ".join(filter(None, [row["names"], structure]))


def _cells(row: Row) -> tuple[str, ...]:
    unit = row["unit"]
    size = row["asked"] if row["size"] is None else row["size"]
    return (
        row["effect"],
        _size(size, unit),
        "" if row["share"] is None else f"{row['share']:.1%}",
        _size(row["claimed"], unit),
        found_text(row),
        row["verdict"] or "",
        _told(row),
        mark(row),
    )


def _size(value: float | None, unit: str) -> str:
    return "" if value is None else f"{number_text(value)} {unit}"


def _aligned(table: Sequence[Sequence[str]]) -> list[str]:
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    return ["  " + "  ".join(map(str.ljust, row, widths)).rstrip() for row in table]
