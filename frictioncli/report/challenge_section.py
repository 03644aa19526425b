"""Part of the page on effects that were planted in the logs, as a test of the diagnosis."""

from dataclasses import dataclass

import pandas as pd

from frictioncli.challenge_schema import AS_LOGGED, SEARCH, Row
from frictioncli.report.challenge_words import found_text, mark, rows_of_table, summary
from frictioncli.report.page_tables import TextTable
from frictioncli.wording import in_words, number_text

_HEADER = ("effect", "names given", "outcome", "planted", "claimed", "found at")


@dataclass(frozen=True, slots=True, kw_only=True)
class PlantedText:
    """What the diagnosis said of planted effects.

    Attributes
    ----------
    figures : tuple of str
        Shares found and wrong names, a sentence each.
    table : TextTable or None
        The effects in the sizes asked for; None if none were planted.
    """

    figures: tuple[str, ...] = ()
    table: TextTable | None = None


def planted_text(challenge: pd.DataFrame) -> PlantedText:
    """Return what became of effects that were planted in the logs of a joint.

    Parameters
    ----------
    challenge : DataFrame
        The joint's rows of :data:`frictioncli.challenge_schema.CHALLENGE`; empty if there are none.
    """
    rows = rows_of_table(challenge)
    shown = [row for row in rows if row["purpose"] not in (AS_LOGGED, SEARCH)]
    if not shown:
        return PlantedText()
    table = TextTable(
        title="Effects planted in these logs, and what the diagnosis then said",
        header=_HEADER,
        rows=tuple(map(_cells, shown)),
        texts=3,
        marked=tuple(number for number, row in enumerate(shown) if row["wrong"]),
    )
    sentences = tuple(f"{text[0].upper()}{text[1:]}." for text in summary(rows))
    return PlantedText(figures=sentences, table=table)


def _cells(row: Row) -> tuple[str, ...]:
    unit = row["unit"]
    size = row["asked"] if row["size"] is None else row["size"]
    names = in_words(row["names"])
    structure = f"structure along {row['structure']}" if row["structure"] else ""
    claimed = "" if row["claimed"] is None else f"{number_text(row['claimed'], 2)} {unit}"
    found = found_text(row)
    return (
        in_words(row["effect"]),
        names or structure or "none",
        in_words(mark(row)),
        f"{number_text(size)} {unit}",
        claimed,
        f"{found} {unit}" if found else "",
    )
