"""Page of a fleet: one row per joint, sorted and filtered in the browser."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from frictioncli import __version__
from frictioncli.plain_text import without_control_characters
from frictioncli.report.summary import KeyNumber
from frictioncli.report.template import render
from frictioncli.schemas import REFERENCE_TEMPERATURES
from frictioncli.wording import count_text, in_words, list_text, thousands_text

_MOST_ROWS = 20_000
"""Joints on the page: more would take seconds to open."""

_MOST_POINTS = 60
"""Points of a joint's line of friction by run."""

_LONGEST = 200
"""Characters of a message."""

_SHARE = 0.05
"""Band of the line of friction by run, as a share of the joint's friction."""

_DIGITS = 7
"""Significant digits of numbers in the page, of which three are shown."""

_FAILED = "failed"
_UNDIAGNOSED = "not diagnosed"
_TAGS = {_FAILED: "poor", "named": "fair", "ambiguous": "fair", "unnamed": "fair"}
_IMPORTANCE = (_FAILED, "unnamed", "named", "ambiguous")
"""Verdicts that are shown first, after the joints that have changed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Choice:
    """A group of joints that can be shown alone: its value in the form, its name, its size."""

    value: str
    name: str
    count: int


@dataclass(frozen=True, slots=True, kw_only=True)
class FleetPage:
    """Everything that the template shows.

    Attributes
    ----------
    joints : str
        Number of joints in words.
    key_numbers : list of KeyNumber
        Joints done and failed, changed, and with a named cause.
    choices : list of Choice
        Groups that can be shown alone; the first is all.
    left_out : str
        What the page leaves out; empty if nothing.
    data : dict
        Columns and rows for the script, to be written as JSON.
    """

    joints: str
    key_numbers: list[KeyNumber]
    choices: list[Choice]
    left_out: str
    data: Mapping[str, Any]


def fleet_html(rows: Sequence[Mapping[str, Any]], pages: Sequence[str]) -> str:
    """Return the page of a fleet.

    Parameters
    ----------
    rows : sequence of mapping
        Rows of :data:`frictioncli.schemas.FLEET`; absent keys are null.
    pages : sequence of str
        Address of each joint's own report relative to the page; empty where it has none.
    """
    page = fleet_page(rows, pages)
    title = f"Friction of {page.joints}"
    return render(
        "fleet.html.jinja", scripts=["fleet.js"], title=title, page=page, version=__version__
    )


def fleet_page(rows: Sequence[Mapping[str, Any]], pages: Sequence[str]) -> FleetPage:
    """Return what the page of a fleet shows.

    Parameters
    ----------
    rows, pages
        As for :func:`fleet_html`.
    """
    verdicts = Counter(_verdict(row) for row in rows)
    changed = sum(map(_has_changed, rows))
    order = sorted(range(len(rows)), key=lambda at: _rank(rows[at]))[:_MOST_ROWS]
    units = sorted({str(row["torque_unit"]) for row in rows if row.get("torque_unit")})
    columns = _columns(rows, units)
    return FleetPage(
        joints=count_text(len(rows), "joint"),
        key_numbers=_key_numbers(rows, verdicts, changed),
        choices=[
            Choice(value="", name="all joints", count=len(rows)),
            Choice(value="changed:", name="changed", count=changed),
            *(
                Choice(value=f"verdict:{in_words(name)}", name=in_words(name), count=count)
                for name, count in sorted(verdicts.items())
            ),
        ],
        left_out=""
        if len(rows) <= _MOST_ROWS
        else f"The {thousands_text(_MOST_ROWS)} joints that most need attention are shown;"
        " fleet.parquet has all.",
        data={
            "unit": units[0] if len(units) == 1 else "",
            "tags": _TAGS,
            "searched": ["robot", "joint", "verdict", "causes", "message"],
            "columns": [
                {"key": key, "title": title, "kind": kind, "about": about}
                for key, title, kind, about in columns
            ],
            "rows": [
                [_cell(rows[at], pages[at], key, kind) for key, _, kind, _ in columns]
                for at in order
            ],
        },
    )


def _columns(
    rows: Sequence[Mapping[str, Any]], units: Sequence[str]
) -> list[tuple[str, str, str, str]]:
    """Return key, heading, kind and explanation of the columns; without heading they are hidden."""
    shared = len(units) == 1
    unit = f" [{units[0]}]" if shared else ""
    friction = _reference(rows)
    return [
        ("robot", "robot", "text", ""),
        ("joint", "joint", "text", "opens the joint's own report"),
        ("verdict", "verdict", "verdict", "of the diagnosis, or failed"),
        ("causes", "causes, or why it failed", "text", "strongest first"),
        ("friction_by_run", "friction by run", "spark", "sorts by the last run"),
        ("change", f"change{unit}", "interval", "last run less the mean of the earlier runs"),
        (
            friction,
            f"friction at {friction.split('_')[1]}\N{NO-BREAK SPACE}°C{unit}",
            "number",
            "without load",
        ),
        ("gain", "gain [%]", "number", "share of the misfit that the extended model removes"),
        ("epsilon_heating", f"ε heating{unit}", "number", "error with corrections"),
        ("epsilon_cooling", f"ε cooling{unit}", "number", "error with corrections"),
        ("runs", "runs", "count", ""),
        *([] if shared else [("torque_unit", "unit", "text", "of this row's torques")]),
        ("message", "left out", "text", "what could not be used"),
        ("page", "", "text", ""),
        ("changed", "", "text", ""),
    ]


def _reference(rows: Sequence[Mapping[str, Any]]) -> str:
    """Return the column of friction at the temperature that most joints have reached."""
    names = [f"friction_{temperature}" for temperature in REFERENCE_TEMPERATURES]
    known = [sum(row.get(name) is not None for row in rows) for name in names]
    # of equal counts the middle temperature, which the others lie around
    return max(zip(known, (0, 1, 0), names, strict=True))[2]


def _cell(row: Mapping[str, Any], page: str, key: str, kind: str) -> Any:
    """Return a value as the script has it: null where there is none."""
    if key == "page":
        return page or None
    if key == "changed":
        return _has_changed(row)
    if key == "verdict":
        return in_words(_verdict(row))
    if kind == "spark":
        return _line(row)
    failed = row.get("status") == _FAILED
    value = row.get({"causes": "message", "message": ""}.get(key, key) if failed else key)
    if value is None or value == "":
        return None
    if kind == "interval":
        ends = [row.get(f"{key}_{end}") for end in ("low", "high")]
        return None if None in ends else [_rounded(one) for one in (value, *ends)]
    if kind in ("number", "count"):
        return _rounded(100.0 * value if key == "gain" else value)
    text = in_words(str(value)) if key == "causes" and not failed else str(value)
    text = without_control_characters(text)
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 1]}…"


def _line(row: Mapping[str, Any]) -> Any:
    """Return the points of friction by run, and the half-width of the band."""
    values = row.get("friction_by_run")
    if not values:
        return None
    parts = np.array_split(np.array(values, float), min(len(values), _MOST_POINTS))
    friction = next(
        (
            row[name]
            for name in (f"friction_{t}" for t in REFERENCE_TEMPERATURES)
            if row.get(name) is not None
        ),
        0.0,
    )
    means = [_rounded(float(part.mean())) for part in parts]
    return [means, _rounded(_SHARE * abs(friction))]


def _rounded(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")


def _verdict(row: Mapping[str, Any]) -> str:
    if row.get("status") == _FAILED:
        return _FAILED
    return str(row.get("verdict") or _UNDIAGNOSED)


def _has_changed(row: Mapping[str, Any]) -> bool:
    low, high = row.get("change_low"), row.get("change_high")
    return low is not None and high is not None and bool(low > 0 or high < 0)


def _rank(row: Mapping[str, Any]) -> tuple[int, int]:
    verdict = _verdict(row)
    known = _IMPORTANCE.index(verdict) if verdict in _IMPORTANCE else len(_IMPORTANCE)
    return (0 if verdict == _FAILED or _has_changed(row) else 1, known)


def _key_numbers(
    rows: Sequence[Mapping[str, Any]], verdicts: Counter[str], changed: int
) -> list[KeyNumber]:
    failed = verdicts[_FAILED]
    numbers = [
        KeyNumber(
            name="done",
            value=f"{thousands_text(len(rows) - failed)} of {thousands_text(len(rows))}",
            context=f"{thousands_text(failed)} failed; the table says why" if failed else "joints",
        )
    ]
    compared = sum(row.get("change_low") is not None for row in rows)
    if compared:
        numbers.append(
            KeyNumber(
                name="changed since the earlier runs",
                value=f"{thousands_text(changed)} of {thousands_text(compared)}",
                context="95 % interval excludes zero; by chance it does in 1 joint of 20",
            )
        )
    if diagnosed := len(rows) - failed - verdicts[_UNDIAGNOSED]:
        causes = Counter(
            cause
            for row in rows
            for cause in str(row.get("causes") or "").split("; ")
            if cause and " or " not in cause
        )
        most = [f"{in_words(name)} ({count})" for name, count in causes.most_common(3)]
        most_often = f"most often {list_text(most)}" if most else ""
        left_out = verdicts[_UNDIAGNOSED]
        undiagnosed = f"{thousands_text(left_out)} not diagnosed" if left_out else ""
        numbers.append(
            KeyNumber(
                name="cause named",
                value=f"{thousands_text(verdicts['named'])} of {thousands_text(diagnosed)}",
                context="; ".join(part for part in (most_often, undiagnosed) if part),
            )
        )
    return numbers
