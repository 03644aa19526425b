"""The next experiment as the page shows it."""

from dataclasses import dataclass
from itertools import groupby

from msgspec import UNSET

from frictioncli.design.document import BlockRecord
from frictioncli.report.page_tables import TextTable
from frictioncli.report.results import JointResults
from frictioncli.wording import count_text, duration_text, in_words, list_text, number_text


@dataclass(frozen=True, slots=True, kw_only=True)
class Experiment:
    """The next experiment.

    Attributes
    ----------
    sentence : str
        How long it takes, and what follows it.
    blocks : TextTable
        Its blocks.
    intervals : TextTable or None
        What it would settle: intervals of parameters now and after it.
    files : tuple of str
        Files of the robot program.
    """

    sentence: str
    blocks: TextTable
    intervals: TextTable | None
    files: tuple[str, ...]


def experiment(results: JointResults) -> Experiment | None:
    """Return the next experiment; None if none was planned.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    plan = results.plan
    if plan is None or plan.verdict is None:
        return None
    check = None if plan.check is UNSET or not plan.check.blocks else plan.check
    after = f" A check of {duration_text(check.duration_s)} follows {check.when}." if check else ""
    intervals = [] if plan.intervals is UNSET else [one for one in plan.intervals if one.wide]
    return Experiment(
        sentence=f"The programme takes {duration_text(plan.programme.duration_s)}; log it as a"
        f" separate run.{after}",
        blocks=TextTable(
            title="Blocks in order",
            header=("block", "why", "times", "minutes"),
            rows=tuple(_rows(plan.programme.blocks)),
            texts=2,
        ),
        intervals=TextTable(
            title="Half-widths of 95 % intervals, now and after it",
            header=("parameter", "estimate", "now", "after", "unit"),
            rows=tuple(
                (
                    in_words(one.parameter.replace(".", ": ")),
                    "–" if one.estimate is None else number_text(one.estimate),
                    _half_width(one.half_width_now),
                    _half_width(one.half_width_after),
                    "" if one.unit == "1" else one.unit,
                )
                for one in intervals
            ),
        )
        if intervals
        else None,
        files=(*plan.programme.files, *(check.files if check else ())),
    )


def _half_width(value: float | None) -> str:
    return "not determined" if value is None else f"±{number_text(value, 2)}"


def _rows(blocks: tuple[BlockRecord, ...]) -> list[tuple[str, str, str, str]]:
    rows, told = [], set()
    for name, group in groupby(blocks, key=lambda block: block.name):
        alike = list(group)
        seconds = sum(block.duration_s for block in alike if block.duration_s is not UNSET)
        reason = "" if name in told else alike[0].reason
        told.add(name)
        rows.append((name, reason, str(len(alike)), f"{seconds / 60:.1f}" if seconds else "–"))
    return rows


def experiment_sentence(results: JointResults) -> str:
    """Return the next experiment in a sentence; empty if none was planned.

    Where there is a plan, the page says this instead of the catalogue's advice for each cause, so
    that it gives one answer only.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    found = experiment(results)
    if found is None:
        return ""
    names = list(dict.fromkeys(row[0] for row in found.blocks.rows))
    return f"See the next experiment: {count_text(len(names), 'block')} ({list_text(names)})."
