"""Page of a comparison: what changed in a joint between runs."""

from collections.abc import Mapping
from dataclasses import dataclass

from markupsafe import Markup

from frictioncli import __version__
from frictioncli.comparison.document import (
    CauseOfChangeRecord,
    ChangeRecord,
    ComparisonDocument,
    PercentRecord,
)
from frictioncli.report.labels import PARAMETER_SYMBOLS
from frictioncli.report.page_tables import TextTable
from frictioncli.report.summary import KeyNumber
from frictioncli.report.template import render
from frictioncli.wording import (
    change_text,
    count_text,
    in_words,
    number_text,
    probability_text,
    speed_text,
)

_LEAST_HOURS = 100.0
"""Least time between first and last run for a rate per 1000 h. [h]"""


@dataclass(frozen=True, slots=True, kw_only=True)
class CauseOfChangeText:
    """A cause of the change: its names, since when, its size, what is seen, what to measure."""

    names: str
    since: str
    size: str
    claim: str
    experiment: str


@dataclass(frozen=True, slots=True, kw_only=True)
class ComparePage:
    """Everything that the template shows.

    Attributes
    ----------
    period, verdict : str
        What is compared, and the result.
    caveats : list of str
        What limits the result.
    key_numbers : list of KeyNumber
        The changes.
    svg : Markup
        The figure.
    causes : list of CauseOfChangeText
        Causes of the change.
    tables : list of TextTable
        Runs, reference conditions and parameters.
    parameters_note : str
        How the parameters are to be read; empty without them.
    folders : list of (str, str)
        Names of the work folders, and addresses of their reports; empty where they have none.
    """

    period: str
    verdict: str
    caveats: list[str]
    key_numbers: list[KeyNumber]
    svg: Markup
    causes: list[CauseOfChangeText]
    tables: list[TextTable]
    parameters_note: str
    folders: list[tuple[str, str]]


def compare_html(document: ComparisonDocument, svg: str, pages: Mapping[str, str]) -> str:
    """Return the page of a comparison.

    Parameters
    ----------
    document : ComparisonDocument
        ``comparison.json``.
    svg : str
        The figure, as an SVG element.
    pages : mapping of str to str
        Address of the report of a work folder by its name; absent where it has none.
    """
    return render(
        "compare.html.jinja",
        scripts=["figures.js"],
        title=f"Joint {document.joint}: changes between runs",
        page=compare_page(document, svg, pages),
        version=__version__,
    )


def compare_page(document: ComparisonDocument, svg: str, pages: Mapping[str, str]) -> ComparePage:
    """Return what the page of a comparison shows; parameters as for :func:`compare_html`."""
    parameters = _parameters_table(document)
    tables = [_conditions_table(document), _runs_table(document), parameters]
    return ComparePage(
        period=_period(document),
        verdict=_verdict(document),
        caveats=_caveats(document),
        key_numbers=_key_numbers(document),
        svg=Markup(svg),
        causes=[_cause(document, cause) for cause in document.causes],
        tables=[table for table in tables if table is not None],
        parameters_note="The parameters compensate each other: judge by the friction above."
        if parameters
        else "",
        folders=[(name, pages.get(name, "")) for name in document.folders],
    )


def _period(document: ComparisonDocument) -> str:
    runs = count_text(len(document.runs), "run")
    where = count_text(len(document.folders), "work folder")
    first, last = document.runs[0].started_at, document.runs[-1].started_at
    if document.trend.per_1000_h is None or first is None or last is None:
        return f"{runs} of {where}, in the order given: the logs have no dates"
    return f"{runs} of {where}, {first[:10]} to {last[:10]}"


def _verdict(document: ComparisonDocument) -> str:
    change = f"a change of {number_text(document.margin.value, 2)} %"
    trend = f"Friction, first run to last: {_percent(document.trend.percent)}."
    if document.verdict == "changed":
        return f"The joint has changed. {trend}"
    if document.verdict == "no_evidence":
        return f"No change was found, and {change} is ruled out. {trend}"
    return f"Undetermined: no change was found, but {change} is not ruled out. {trend}"


def _caveats(document: ComparisonDocument) -> list[str]:
    found = []
    if document.weak:
        found.append(
            "Two runs do not show how much the joint differs from day to day: the intervals assume"
            f" {number_text(document.scatter.assumed, 2)} % (--day-to-day)."
        )
    if document.verdict == "undetermined":
        found.append("Measure more days, or at the same ambient temperature.")
    threshold = document.threshold
    if threshold is not None:
        limit = f"{number_text(threshold.value)} {threshold.unit}"
        found.append(
            f"Threshold {limit}: a change above it was found."
            if threshold.exceeded
            else f"Threshold {limit}: no change above it was found."
        )
    return found


def _key_numbers(document: ComparisonDocument) -> list[KeyNumber]:
    numbers = [_change_number("friction, first run to last", document.trend)]
    if document.last_run is not None:
        numbers.append(_change_number("last run against the earlier ones", document.last_run))
    per_1000_h = document.trend.per_1000_h
    days = document.runs[-1].days or 0.0
    if per_1000_h is not None and 24 * days >= _LEAST_HOURS:
        numbers.append(
            _key_number("per 1000 h of calendar time", per_1000_h.estimate, per_1000_h.ci95)
        )
    if document.load is not None:
        load = document.load
        numbers.append(_key_number("load torque, first run to last", load.estimate, load.ci95))
    numbers.append(
        KeyNumber(
            name="mean friction",
            value=f"{number_text(document.mean_friction.estimate)} {document.mean_friction.unit}",
            context=f"from day to day {number_text(document.scatter.day_to_day, 2)} % (1 sigma)",
        )
    )
    return numbers


def _change_number(name: str, change: ChangeRecord) -> KeyNumber:
    torque = change_text(change.change, change.ci95, change.unit)
    return _key_number(name, change.percent.estimate, change.percent.ci95, torque)


def _key_number(name: str, estimate: float, ends: tuple[float, float], also: str = "") -> KeyNumber:
    """Return a change in percent: its value and, as context, its interval and another unit's."""
    value, interval = change_text(estimate, ends, "%").split(" (")
    context = f"95 % interval {interval.removesuffix(')')} %"
    return KeyNumber(name=name, value=value, context=f"{context}; {also}" if also else context)


def _cause(document: ComparisonDocument, cause: CauseOfChangeRecord) -> CauseOfChangeText:
    names = [
        f"{in_words(name)} ({probability_text(cause.probabilities[name])})"
        for name in cause.effects
    ]
    return CauseOfChangeText(
        names=" or ".join(names),
        since=cause.since or "",
        size=f"{_percent(cause.change)} in the {cause.channel}",
        claim=cause.claim,
        experiment=cause.experiment,
    )


def _conditions_table(document: ComparisonDocument) -> TextTable | None:
    if not document.friction:
        return None
    load = f"{number_text(document.friction[0].load)} {document.load_unit}"
    unit = document.torque_unit
    return TextTable(
        title=f"Friction at a load of {load}, and its change from the first run to the last",
        header=("condition", f"friction [{unit}]", f"change [{unit}]", "change [%]"),
        rows=tuple(
            (
                f"{one.temperature:.0f} °C, {speed_text(one.speed)}"
                + (", not measured in all runs" if one.extrapolated else ""),
                number_text(one.friction),
                change_text(one.change, one.ci95, ""),
                change_text(one.percent.estimate, one.percent.ci95, ""),
            )
            for one in document.friction
        ),
    )


def _runs_table(document: ComparisonDocument) -> TextTable:
    return TextTable(
        title="Friction of each run against the mean of all",
        header=(
            "run",
            "begin",
            "as measured [%]",
            "at equal ambient conditions [%]",
            "ambient [°C]",
        ),
        rows=tuple(
            (
                f"{run.folder}, {run.run}" if len(document.folders) > 1 else run.run,
                (run.started_at or "–")[:10],
                change_text(run.measured, run.ci95, "").split(" (")[0],
                change_text(run.level, run.ci95, ""),
                number_text(run.surroundings),
            )
            for run in document.runs
        ),
        texts=2,
    )


def _parameters_table(document: ComparisonDocument) -> TextTable | None:
    if not document.parameters:
        return None
    return TextTable(
        title="Parameters of the first and the last work folder",
        header=("parameter", "unit", "first", "last", "change"),
        rows=tuple(
            (
                PARAMETER_SYMBOLS[name],
                one.unit,
                number_text(one.first),
                number_text(one.last),
                "not in both models"
                if one.change is None or one.ci95 is None
                else change_text(one.change, one.ci95, ""),
            )
            for name, one in document.parameters.items()
        ),
        texts=2,
    )


def _percent(change: PercentRecord) -> str:
    return change_text(change.estimate, change.ci95, "%")
