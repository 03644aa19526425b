"""The table that ``challenge`` prints, and its figures in one place."""

from collections.abc import Sequence

from frictioncli.challenge.rows import AS_LOGGED, CANNOT, DONE, SEARCH, SHARE, Row
from frictioncli.wording import count_text, number_text

_HEAD = ("effect", "planted", "share", "claimed", "found from", "verdict", "names given", "")


def challenge_text(rows: Sequence[Row]) -> str:
    """Return what was there already, which sizes are found, and names that are wrong.

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
    told = [row["names"]] if row["names"] else []
    told += [f"structure along {row['structure']}"] if row["structure"] else []
    return f"{row['verdict']}" + (f" ({'; '.join(told)})" if told else "")


def _cells(row: Row) -> tuple[str, ...]:
    unit = row["unit"]
    size = row["asked"] if row["size"] is None else row["size"]
    return (
        row["effect"],
        _size(size, unit),
        "" if row["share"] is None else f"{row['share']:.1%}",
        _size(row["claimed"], unit),
        _found(row),
        row["verdict"] or "",
        row["names"] or (f"along {row['structure']}" if row["structure"] else ""),
        mark(row),
    )


def mark(row: Row) -> str:
    """Return in a few words what a trial came to.

    Parameters
    ----------
    row : dict
        Row of :data:`frictioncli.challenge_schema.CHALLENGE`.
    """
    if row["status"] == CANNOT:
        return "not shown by these data"
    told = []
    if row["already"]:
        told.append("there already")
    elif row["right_alone"]:
        told.append("found")
    elif row["right_in_set"]:
        told.append("found in a set")
    else:
        told.append("not found")
    if row["wrong"]:
        told.append(f"WRONG: {row['wrong']}")
    return ", ".join(told)


def _found(row: Row) -> str:
    if row["size_found_high"] is None:
        return "" if row["size_found_low"] is None else f"above {row['size_found_low']:.2g}"
    low, high = row["size_found_low"], row["size_found_high"]
    return f"below {high:.2g}" if low is None else f"{low:.2g} to {high:.2g}"


def _size(value: float | None, unit: str) -> str:
    return "" if value is None else f"{number_text(value)} {unit}"


def _aligned(table: Sequence[Sequence[str]]) -> list[str]:
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    return ["  " + "  ".join(map(str.ljust, row, widths)).rstrip() for row in table]


def summary(rows: Sequence[Row]) -> list[str]:
    """Return the figures of a joint: shares found in the usual size, wrong names, claims that held.

    Parameters
    ----------
    rows : sequence of dict
        Rows of one joint.
    """
    done = [row for row in rows if row["status"] == DONE and row["purpose"] != AS_LOGGED]
    usual = [row for row in done if row["purpose"] == SHARE and not row["already"]]
    lines = []
    shown = [row for row in usual if can_show(row)]
    if shown:
        found = sum(bool(row["right_in_set"]) for row in shown)
        lines.append(
            f"in the usual size: {found} of {count_text(len(shown), 'effect')} found that the"
            " diagnosis calls detectable in it"
        )
    wrong = sum(bool(row["wrong"]) for row in done)
    if done:
        lines.append(f"wrong new names: in {wrong} of {count_text(len(done), 'trial')}")
    ratios = claim_ratios(rows)
    if ratios:
        within = sum(1 / 1.5 <= one <= 1.5 for one in ratios.values())
        lines.append(
            f"claimed detectable size within a factor of 1.5 of the one found: {within} of"
            f" {count_text(len(ratios), 'effect')}"
        )
    return lines


def can_show(row: Row) -> bool:
    """Return whether the diagnosis of the log calls an effect detectable in its planted size."""
    return row["claimed"] is not None and row["size"] is not None and row["claimed"] <= row["size"]


def claim_ratios(rows: Sequence[Row]) -> dict[tuple[str, int], float]:
    """Return the claimed size over the size found, of each effect and shape that was searched.

    An effect of which every size tried was found, or none, has the ratio to the outermost size
    tried, which is a bound of it.

    Parameters
    ----------
    rows : sequence of dict
        Rows of one joint.
    """
    ratios = {}
    for row in rows:
        size = row["size_found"] if row["size_found"] is not None else row["size_found_low"]
        if size is not None and row["claimed"] is not None:
            ratios[row["effect"], row["seed"]] = float(row["claimed"] / size)
    return ratios
