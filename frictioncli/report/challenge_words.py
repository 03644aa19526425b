"""What became of effects that were planted in a log, in words and figures."""

from collections.abc import Sequence
from math import ceil, inf

import pandas as pd

from frictioncli.challenge_schema import AS_LOGGED, CANNOT, DONE, SHARE, Row
from frictioncli.wording import count_text

_FOUR_OF_FIVE = 0.8

_SHAPES = 5
"""Shapes of which a claim is made."""


def rows_of_table(frame: pd.DataFrame) -> list[Row]:
    """Return the rows of a table that was read; None where a value is missing.

    Parameters
    ----------
    frame : DataFrame
        Rows of :data:`frictioncli.challenge_schema.CHALLENGE`.
    """
    return [
        {name: None if value is None or value != value else value for name, value in row.items()}
        for row in frame.astype(object).to_dict("records")
    ]


def mark(row: Row) -> str:
    """Return in a few words what a trial came to.

    Parameters
    ----------
    row : dict
        Row of :data:`frictioncli.challenge_schema.CHALLENGE`.
    """
    if row["status"] == CANNOT:
        return "not visible in these data"
    told = []
    if row["already"]:
        told.append("already there")
    elif row["right_alone"]:
        told.append("found")
    elif row["right_in_set"]:
        told.append("found in a set")
    else:
        told.append("not found" + (", below the size claimed" if _is_below_claim(row) else ""))
    if row["wrong"]:
        told.append(f"WRONG: {row['wrong']}")
    return ", ".join(told)


def found_text(row: Row) -> str:
    """Return between which sizes the least one lies that is found; empty if it was not searched.

    Parameters
    ----------
    row : dict
        Row of :data:`frictioncli.challenge_schema.CHALLENGE`.
    """
    if row["size_found_high"] is None:
        return "" if row["size_found_low"] is None else f"above {row['size_found_low']:.2g}"
    low, high = row["size_found_low"], row["size_found_high"]
    return f"below {high:.2g}" if low is None else f"{low:.2g} to {high:.2g}"


def summary(rows: Sequence[Row]) -> list[str]:
    """Return the figures of a joint: shares found at the usual size, wrong names, claims that held.

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
            f"found at the usual size: {found} of {count_text(len(shown), 'effect')} that the"
            " diagnosis calls detectable at that size"
        )
    wrong = sum(bool(row["wrong"]) for row in done)
    if done:
        lines.append(f"trials with a wrong new name: {wrong} of {count_text(len(done), 'trial')}")
    ratios = claim_ratios(rows)
    if ratios:
        shapes = len({row["seed"] for row in done})
        note = f" (of {count_text(shapes, 'shape')}; it is claimed for four of five, try --draws 5)"
        within = sum(1 / 1.5 <= one <= 1.5 for one in ratios.values())
        lines.append(
            f"claimed detectable size within a factor of 1.5 of the size found: {within} of"
            f" {count_text(len(ratios), 'effect')}{note if shapes < _SHAPES else ''}"
        )
    return lines


def can_show(row: Row) -> bool:
    """Return whether the diagnosis of the log calls an effect detectable in its planted size."""
    return row["claimed"] is not None and row["size"] is not None and row["claimed"] <= row["size"]


def _is_below_claim(row: Row) -> bool:
    """Return whether the diagnosis of the log itself says that a size is too small to be found."""
    claimed, size = row["claimed"], row["size"]
    return claimed is not None and size is not None and size < claimed


def claim_ratios(rows: Sequence[Row]) -> dict[str, float]:
    """Return the claimed size over the size found, of each effect that was searched.

    Where several shapes were tried, the size is the one at which four of five are found, as it is
    claimed. The ratio is 0 where no size that was tried was found; where all were, the true ratio
    is larger.

    Parameters
    ----------
    rows : sequence of dict
        Rows of one joint.
    """
    claimed: dict[str, float] = {}
    found: dict[str, dict[int, float]] = {}
    for row in rows:
        size = row["size_found"]
        if row["claimed"] is None or (size is None and row["size_found_low"] is None):
            continue
        claimed[row["effect"]] = row["claimed"]
        found.setdefault(row["effect"], {})[row["seed"]] = inf if size is None else size
    return {
        effect: claimed[effect] / sorted(sizes.values())[ceil(_FOUR_OF_FIVE * len(sizes)) - 1]
        for effect, sizes in found.items()
    }
