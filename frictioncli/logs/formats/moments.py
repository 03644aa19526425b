"""Dates and times of day as text: their form is found from some cells, and they become seconds.

ISO 8601 is left to pandas. The other forms are a date with the year first or last, a time of day
with or without AM or PM, or both; and both in digits alone, as ``20240314115853008``.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from frictioncli.arrays import Array

ISO, YEAR_FIRST, DAY_FIRST, MONTH_FIRST, CLOCK = "iso", "ymd", "dmy", "mdy", "clock"
DIGITS = "digits"
DAY = 86400.0  # [s]

_ISO = re.compile(r"\s*\d{4}-\d\d-\d\d([T ]\d\d:\d\d[^AaPp]*+)?\s*")
_TIME = (
    r"(?P<hour>\d{1,2}):(?P<minute>\d\d)(?::(?P<second>\d\d)(?:[.,:](?P<part>\d{1,9})\d{0,9})?)?"
    r"(?:\s?(?P<half>[AaPp])\.?[Mm]\.?)?"
)
_OR_WITH_TIME = rf"(?:[ T]{{1,4}}{_TIME})?"
_YEAR_LAST = rf"(?P<a>\d{{1,2}})[./-](?P<b>\d{{1,2}})[./-](?P<c>\d{{4}}|\d{{2}}){_OR_WITH_TIME}"
_YEAR_AHEAD = rf"(?P<c>\d{{4}})[./-](?P<a>\d{{1,2}})[./-](?P<b>\d{{1,2}}){_OR_WITH_TIME}"
_IN_DIGITS = (
    r"(?P<c>20\d\d)(?P<a>0[1-9]|1[0-2])(?P<b>0[1-9]|[12]\d|3[01])[_T-]?"
    r"(?P<hour>[01]\d|2[0-3])(?P<minute>[0-5]\d)(?P<second>[0-5]\d)[._]?(?P<part>\d{0,9})(?P<half>)"
)
_LEAST_DIGITS = 14
_TEXTS = {
    YEAR_FIRST: _YEAR_AHEAD,
    DAY_FIRST: _YEAR_LAST,
    MONTH_FIRST: _YEAR_LAST,
    CLOCK: _TIME,
    DIGITS: _IN_DIGITS,
}
_DATE_YEAR_LAST = re.compile(rf"\s*{_YEAR_LAST}\s*", re.ASCII)
_DATE_YEAR_AHEAD = re.compile(rf"\s*{_YEAR_AHEAD}\s*", re.ASCII)
_TIME_OF_DAY = re.compile(rf"\s*{_TIME}\s*", re.ASCII)
_DATE_IN_DIGITS = re.compile(rf"\s*{_IN_DIGITS}\s*", re.ASCII)
_FIRST_OF_CENTURY, _PIVOT = 1900, 69
"""Years of two digits are 1969 to 2068."""
_WORDS = {
    DAY_FIRST: "day.month.year",
    MONTH_FIRST: "month/day/year",
    YEAR_FIRST: "year.month.day",
    DIGITS: "in digits alone",
}


@dataclass(frozen=True, slots=True)
class MomentForm:
    """Form of the dates or times of day in a column.

    Attributes
    ----------
    order : str
        ``iso``, ``ymd``, ``dmy`` or ``mdy``; ``clock`` for a time of day alone, ``digits`` for date
        and time of day without separators.
    has_clock : bool
        Whether there is a time of day.
    is_certain : bool
        False where the cells do not show which number is the day, and the usual order is taken.
    """

    order: str
    has_clock: bool
    is_certain: bool = True

    @property
    def text(self) -> str:
        """The form in words; "" for ISO 8601, which needs none."""
        if self.order == ISO:
            return ""
        return "times of day" if self.order == CLOCK else f"dates {_WORDS[self.order]}"

    def note(self, column: str) -> str:
        """Return what is assumed of a column; "" where nothing is."""
        if self.is_certain:
            return ""
        return (
            f"day and month in {column} cannot be told apart: read as {_WORDS[self.order]}, the"
            " usual order with this separator"
        )


def is_moment(cell: str) -> bool:
    """Return whether a cell is a date, a time of day to the second, or both.

    Examples
    --------
    >>> [is_moment(cell) for cell in ("14.03.2024", "11:58:53.008 PM", "12:30", "1.234")]
    [True, True, False, False]
    >>> is_moment("20240314115853008"), is_moment("1710417533008000000")
    (True, False)
    """
    return _order(cell) is not None


def moment_form(cells: Sequence[str]) -> MomentForm | None:
    """Return the form of the dates or times in most of some cells; None where most are neither.

    Examples
    --------
    >>> moment_form(["03/14/2024 11:58:53.008 AM"])
    MomentForm(order='mdy', has_clock=True, is_certain=True)
    """
    filled = [cell for cell in cells if cell.strip()]
    orders = [(cell, order) for cell in filled if (order := _order(cell)) is not None]
    if not orders or 2 * len(orders) <= len(filled):
        return None
    found = [order for _, order in orders]
    order = max(dict.fromkeys(found), key=found.count)
    same = [cell for cell, one in orders if one == order]
    has_clock = order == DIGITS or sum(":" in cell for cell in same) > len(same) / 2
    if order != DAY_FIRST:
        return MomentForm(order, has_clock)
    days = [(int(m["a"]), int(m["b"])) for m in map(_DATE_YEAR_LAST.fullmatch, same) if m]
    day_first = sum(a > 12 >= b for a, b in days)
    month_first = sum(b > 12 >= a for a, b in days)
    if day_first == month_first:
        usual = MONTH_FIRST if "/" in same[0] else DAY_FIRST
        return MomentForm(usual, has_clock, is_certain=False)
    return MomentForm(DAY_FIRST if day_first > month_first else MONTH_FIRST, has_clock)


def settled_form(form: MomentForm, first: Sequence[str], last: Sequence[str]) -> MomentForm:
    """Return a form whose order of day and month may follow from the end of the file.

    Parameters
    ----------
    form : MomentForm
        The form that the first cells show.
    first, last : sequence of str
        Cells of the column from the beginning and from the end of the file.

    Returns
    -------
    MomentForm
        Where one order only is a calendar date throughout, or has less time from the beginning to
        the end than the other, that order, which is then certain.

    Examples
    --------
    >>> form = moment_form(["11.03.2024 23:59:58"])
    >>> settled_form(form, ["11.03.2024 23:59:58"], ["12.03.2024 00:00:01"]).is_certain
    True
    """
    if form.is_certain:
        return form
    spans = {}
    for order in (DAY_FIRST, MONTH_FIRST):
        tried = replace(form, order=order)
        begin, end = (seconds(pa.array(cells, pa.string()), tried) for cells in (first, last))
        begin, end = begin[np.isfinite(begin)], end[np.isfinite(end)]
        if len(begin) and len(end) and end[-1] >= begin[0]:
            spans[order] = float(end[-1] - begin[0])
    if not spans or len(set(spans.values())) < len(spans):
        return form
    return replace(form, order=min(spans, key=lambda order: spans[order]), is_certain=True)


def seconds(cells: pa.Array | pa.ChunkedArray, form: MomentForm) -> Array:
    """Return dates or times of day as seconds, NaN where a cell is neither.

    Parameters
    ----------
    cells : array of binary or str, length n
        The cells; dates without a time zone are taken as UTC.
    form : MomentForm
        Their form.

    Returns
    -------
    ndarray, shape (n,)
        Time since 1970-01-01 00:00 UTC; of a time of day alone, since midnight. [s]

    Examples
    --------
    >>> import pyarrow as pa
    >>> seconds(pa.array(["02.01.70 00:00:00,5", "31.02.70"]), MomentForm("dmy", True))
    array([86400.5,     nan])
    """
    if form.order == ISO:
        texts = [
            cell.decode("utf-8", "replace") if isinstance(cell, bytes) else cell or ""
            for cell in cells.to_pylist()
        ]
        return seconds_since_1970(texts)
    parts = pc.extract_regex(cells.cast(pa.binary()), rf"^\s*{_TEXTS[form.order]}\s*$")
    if isinstance(parts, pa.ChunkedArray):
        parts = parts.combine_chunks()
    known = {field.name: parts.field(field.name) for field in parts.type}
    matched = np.asarray(parts.is_valid())
    found = np.zeros(len(matched)) if form.order == CLOCK else _days(known, form.order) * DAY
    time = _time_of_day(known)
    return np.where(matched, found + time, np.nan)


def seconds_since_1970(texts: list[str]) -> Array:
    """Return ISO 8601 dates as time since 1970, NaN where a text is no date.

    Parameters
    ----------
    texts : list of str, length n
        Dates; without a time zone they are taken as UTC.

    Returns
    -------
    ndarray, shape (n,)
        Time since 1970-01-01 00:00 UTC. [s]

    Examples
    --------
    >>> seconds_since_1970(["1970-01-02 00:00:00,5", ""])
    array([86400.5,     nan])
    """
    import pandas as pd  # takes longer to import than most logs to read

    cleaned = pd.Series([text.strip().replace(",", ".") for text in texts], dtype="str")
    dates = pd.to_datetime(cleaned, format="ISO8601", errors="coerce", utc=True)
    # in seconds: nanoseconds would overflow for the year 1
    epoch = pd.Timestamp("1970-01-01", tz="UTC").as_unit("s")
    since = (dates - epoch) / pd.Timedelta(seconds=1)
    return np.asarray(since.to_numpy(dtype=float), np.float64)


def _order(cell: str) -> str | None:
    """Return the order of a cell, ``dmy`` for all dates with the year last; None for no moment."""
    # most cells are numbers: this takes less time than the patterns
    if "/" not in cell and max(map(cell.count, ".-:")) < 2:
        in_digits = len(cell) >= _LEAST_DIGITS and _DATE_IN_DIGITS.fullmatch(cell)
        return DIGITS if in_digits else None
    if _ISO.fullmatch(cell):
        return ISO
    if _DATE_YEAR_LAST.fullmatch(cell):
        return DAY_FIRST
    if _DATE_YEAR_AHEAD.fullmatch(cell):
        return YEAR_FIRST
    time = _TIME_OF_DAY.fullmatch(cell)
    return CLOCK if time is not None and time["second"] else None


def _number(part: pa.Array) -> Array:
    """Return digits as numbers, NaN where there are none."""
    texts = part.cast(pa.string())
    filled = pc.if_else(pc.equal(texts, ""), None, texts)
    return np.array(filled.cast(pa.float64()).to_numpy(zero_copy_only=False), np.float64)


def _days(parts: dict[str, pa.Array], order: str) -> Array:
    """Return the days since 1970, NaN where there is no such day."""
    year = _number(parts["c"])
    short = np.asarray(pc.equal(pc.binary_length(parts["c"]), 2).fill_null(False))
    year[short] += _FIRST_OF_CENTURY + np.where(year[short] < _PIVOT, 100, 0)
    first, second = _number(parts["a"]), _number(parts["b"])
    month, day = (second, first) if order == DAY_FIRST else (first, second)
    with np.errstate(invalid="ignore"):
        good = (month >= 1) & (month <= 12) & (day >= 1)
    months = np.where(good, (year - 1970) * 12 + month - 1, 0).astype("datetime64[M]")
    starts = months.astype("datetime64[D]").astype(np.int64)
    lengths = (months + 1).astype("datetime64[D]").astype(np.int64) - starts
    with np.errstate(invalid="ignore"):
        return np.where(good & (day <= lengths), starts + day - 1, np.nan)


def _time_of_day(parts: dict[str, pa.Array]) -> Array:
    """Return the time since midnight [s]: NaN where there is none such, 0 for a date alone."""
    hour, minute, second = (_number(parts[name]) for name in ("hour", "minute", "second"))
    half = np.asarray(pc.utf8_lower(parts["half"].cast(pa.string())).fill_null(""))
    digits = np.asarray(pc.binary_length(parts["part"]).fill_null(0).to_numpy(), np.float64)
    fraction = np.nan_to_num(_number(parts["part"])) / 10.0**digits
    twelve = np.isin(half, ("a", "p"))
    with np.errstate(invalid="ignore"):
        bad = (minute > 59) | (second > 60) | (twelve & ((hour < 1) | (hour > 12)))
    hour = np.where(twelve, hour % 12 + 12.0 * (half == "p"), hour)
    whole = np.nan_to_num(hour) * 3600 + np.nan_to_num(minute) * 60 + np.nan_to_num(second)
    return np.where(bad, np.nan, whole + fraction)
