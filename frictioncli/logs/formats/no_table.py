"""Why a text is no table of numbers, and what to do."""

import re
from collections.abc import Sequence

from frictioncli.logs.log_source import Refusal

_ONE_NUMBER = re.compile(r"\s*+[+-]?[\d.,]++(?:[eE][+-]?\d++)?\s*+")
_LEAST_DIGITS = 0.3
"""Share of the characters that are digits in rows of numbers."""

_MAP_TABLES = frozenset({"[channels]", "[units]"})
"""Lines that begin the tables of a mapping file."""


def refuse_unequal(names: int, width: int, delimiter: str) -> Refusal:
    """Return the refusal of a table whose header does not fit its rows.

    Parameters
    ----------
    names, width : int
        Number of names in the header and of fields in a row.
    delimiter : str
        What separates them.
    """
    advice = "give each field a name in one header line"
    if delimiter == "," and width > names:
        advice = "a decimal comma in a comma-separated file does this: save it with ';'"
    return Refusal(
        "wrong_field_count",
        f"the header names {names} columns but the rows have {width} fields; expected as many;"
        f" {advice}",
    )


def refuse_too_short(*, has_header: bool) -> Refusal:
    """Return the refusal of a text of at most one line, which may be a header."""
    if has_header:
        return Refusal(
            "too_few_rows", "a header line and no rows; expected at least two rows of numbers"
        )
    return Refusal("not_a_log", "text without rows; expected a header line and rows of numbers")


def refuse_no_table(filled: Sequence[str], delimiter: str | None) -> Refusal:
    """Return the refusal of a text whose lines are no rows of numbers.

    Parameters
    ----------
    filled : sequence of str
        Its first lines that are not blank.
    delimiter : str or None
        What the user says separates the fields, in words.
    """
    if _MAP_TABLES.intersection(line.strip() for line in filled):
        return Refusal("not_a_log", "a mapping file, not a log; expected as --map FILE")
    first = f"the first line is {filled[0][:120]!r}"
    if delimiter is not None:
        return Refusal(
            "wrong_delimiter",
            f"the map's delimiter {delimiter} does not separate numbers; {first}",
        )
    body = "".join(filled[1:])
    if all(_ONE_NUMBER.fullmatch(line) for line in filled):
        return Refusal(
            "one_column",
            "one number per line; expected a table: join the files of one recording"
            " into one, with a header line that names the columns and, in each row, time, position"
            " and torque of one sample; numbers of several joints that follow each other in a file"
            " belong in one row",
        )
    digits = sum(character.isdigit() for character in body)
    if digits > _LEAST_DIGITS * len(body):
        return Refusal(
            "one_column",
            f"no ';', tab, ',' or blank separates the numbers; {first}; save the log as CSV",
        )
    return Refusal("not_a_log", "text, but not a table of numbers")
