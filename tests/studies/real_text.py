"""Text of docs/real.md: what one case gives, and the table at its top."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

from frictioncli.wording import count_text, number_text, range_text
from tests.studies.real_beside import alike, chosen_speeds, counterpart, deviations, largest_change
from tests.studies.real_cases import Case
from tests.studies.real_chain import Attempt, JointResult
from tests.studies.real_independent import Independent
from tests.studies.real_page import shortened

_MOST_NOTES = 5
"""Notes that are shown."""

_TELLING = ("torque of joint", "warning", "moves", "gear ratio", "angle bins widened")
"""Words of the notes on channels and doubts."""

_MOST_NAMED = 3
"""Joints of which the table names the friction."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Tried:
    """One case, tried in three ways.

    Attributes
    ----------
    case : Case
        The case.
    unaided : Attempt
        Without any help.
    suggested : Attempt or None
        With the suggested map; None where none could be suggested.
    suggestion : str
        Lines of that map, or why there is none.
    written : Attempt or None
        With a map that a person wrote, where there is one.
    beside : list of Independent
        Figures of the independent script.
    """

    case: Case
    unaided: Attempt
    suggested: Attempt | None
    suggestion: str
    written: Attempt | None
    beside: list[Independent]

    @property
    def helped(self) -> Attempt | None:
        """The run with the suggested map, where it says something else than the unaided one."""
        if self.suggested is None or (self.suggested.refusal and self.unaided.refusal):
            return None
        change = largest_change(self.unaided, self.suggested)
        return None if change is not None and change < 0.005 else self.suggested

    @property
    def shown(self) -> Attempt:
        """The attempt that the table judges: the unaided one, else the one with the map."""
        if self.unaided.refusal and self.helped is not None:
            return self.helped
        return self.unaided


def table(tried: Sequence[Tried]) -> str:
    """Return the table of all cases."""
    lines = [
        "| folder | unaided | with the suggested map | independent script | deviation |",
        "|---|---|---|---|---|",
    ]
    for one in tried:
        helped = "the same" if one.suggested is not None else "none suggested"
        if one.helped is not None:
            helped = _short(one, one.helped)
        elif one.suggested is not None and one.suggested.refusal:
            helped = "refused too"
        cells = (one.case.name, _short(one, one.unaided), helped, _beside(one), _deviation(one))
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def _short(tried: Tried, attempt: Attempt) -> str:
    if attempt.refusal:
        return "refused"
    texts = []
    for result in attempt.joints[:_MOST_NAMED]:
        other = counterpart(result, attempt, tried.beside)
        shown = chosen_speeds(result, other)
        values = ", ".join(number_text(one.friction) for one in shown)
        speeds = ", ".join(f"{one.speed:.0f}" for one in shown)
        texts.append(
            f"{result.way}, joint {result.joint}: {values} {result.unit} at {speeds} deg/s"
        )
    return "; ".join(texts)


def _beside(tried: Tried) -> str:
    texts = []
    shown = [(one, counterpart(one, tried.shown, tried.beside)) for one in tried.shown.joints]
    for other in [one for _, one in shown if one is not None] or tried.beside:
        if other.law is not None:
            law = f"{number_text(other.law[0])} + {number_text(other.law[1])} √v {other.unit}"
            texts.append(f"joint {other.joint}: {law} ({other.way})")
            continue
        speeds = sorted(other.friction)
        for result, beside in shown:
            if beside is other:
                speeds = [other.nearest(one.speed) for one in chosen_speeds(result, other)]
        values = ", ".join(number_text(other.friction[one]) for one in speeds)
        at = ", ".join(f"{one:.0f}" for one in speeds)
        texts.append(f"joint {other.joint}: {values} {other.unit} at {at} deg/s")
    return "; ".join(texts) or "none"


def _deviation(tried: Tried) -> str:
    """Return the range of deviations; that of bare numbers where units differ."""
    found, units = [], True
    for result in tried.shown.joints:
        other = counterpart(result, tried.shown, tried.beside)
        if other is not None:
            found += deviations(result, other)
            units &= alike(result, other)
    if not found:
        return "nothing to compare"
    text = range_text([_percent(one) for one in sorted(found)])
    return text if units else f"of the numbers {text}; units differ"


def _percent(share: float) -> str:
    return f"{100 * share:+.1f} %".replace("-", "−")


def section(tried: Tried) -> str:
    """Return the section on a case."""
    case = tried.case
    parts = [f"## {case.name}: {case.title}" if case.title != case.name else f"## {case.name}"]
    parts += [f"Known: {case.known}"] if case.known else []
    parts.append(_attempt_text("Unaided", tried, tried.unaided))
    if tried.helped is not None:
        parts.append(_attempt_text("With the suggested map", tried, tried.helped))
    parts.append(_by_hand(tried))
    final = tried.shown
    if case.refused and tried.unaided.refusal:
        parts.append(f"Is the refusal right? {case.refused}")
    if case.doubt and not final.refusal:
        parts.append(f"Doubtful about the result: {case.doubt}")
    return "\n\n".join(parts)


def _attempt_text(title: str, tried: Tried, attempt: Attempt) -> str:
    if attempt.refusal:
        # the reason of the second way stands at the end of a long refusal
        first, mark, second = attempt.refusal.partition("by regression neither: ")
        return f"**{title}: refused.** “{shortened(first)}{mark and ' ' + mark}{shortened(second)}”"
    ways = " and ".join(sorted({f"by {one.way}" for one in attempt.joints}))
    blocks = [f"**{title}: read**, friction {ways}."]
    blocks += [_joint_text(one, tried, attempt) for one in attempt.joints]
    shown: dict[str, str] = {}
    for note in attempt.notes:
        if any(word in note for word in _TELLING) and _of_results(note, attempt):
            plain = note.removeprefix("warning: ").removeprefix("note: ")
            # what is said of several groups of files differs in its numbers only
            shown.setdefault(re.sub(r"in \d+ files: |\d+ of \d+|in \d+:", "", plain), plain)
    if shown:
        lines = [f"- {note}" for note in list(shown.values())[:_MOST_NOTES]]
        blocks.append("\n".join(["The program notes:", "", *lines]))
    return "\n\n".join(blocks)


def _of_results(note: str, attempt: Attempt) -> bool:
    """Return whether a note is not on a joint without a result."""
    number = re.search(r"of joint (\d+)", note)
    return number is None or any(one.joint == int(number[1]) for one in attempt.joints)


def _joint_text(result: JointResult, tried: Tried, attempt: Attempt) -> str:
    other = counterpart(result, attempt, tried.beside)
    groups = "pair" if result.way == "pairs" else "group"
    lines = [
        f"Joint {result.joint}, torque in {result.unit} at the {result.side},"
        f" {count_text(result.pairs, groups)}. Diagnosis: {result.diagnosis}.",
        "",
        *(f"- {channel}" for channel in result.channels),
        "",
        "| speed [deg/s] | friction | independent script | deviation |",
        "|---|---|---|---|",
    ]
    for one in chosen_speeds(result, other):
        value = None if other is None else other.at(one.speed)
        beside = "" if value is None or other is None else f"{number_text(value)} {other.unit}"
        apart = "" if not value else _percent(one.friction / value - 1)
        if other is not None and not alike(result, other):
            apart = f"of the numbers {apart}; units differ"
        friction = _with_interval(one.friction, one.ci95, result.unit)
        lines.append(f"| {one.speed:.1f} | {friction} | {beside} | {apart} |")
    lines += ["", "| parameter | estimate | the program says |", "|---|---|---|"]
    for name, entry in result.model.parameters.items():
        why = entry.reason or ""
        value = "left out"
        if entry.ci95 is not None:
            value = _with_interval(entry.estimate, entry.ci95, entry.unit)
        lines.append(f"| {name} | {value} | {why} |")
    return "\n".join(lines)


def _with_interval(value: float, interval: tuple[float, float] | None, unit: str) -> str:
    if interval is None:
        return f"{number_text(value)} {unit}, interval not known"
    return f"{number_text(value)} {unit} ({number_text(interval[0])} to {number_text(interval[1])})"


def _by_hand(tried: Tried) -> str:
    """Return what a person had to write."""
    if tried.suggested is None:
        offered = f"No map can be suggested: “{shortened(tried.suggestion)}”."
    elif tried.suggested.refusal:
        offered = "With the suggested map the program refuses too."
    else:
        offered = f"The suggested map {_against(tried.unaided, tried.suggested)}."
    if tried.written is None:
        return f"No map was written by hand. {offered}"
    if tried.written.refusal:
        return (
            f"By hand: with a map that a person wrote ({tried.case.map}) it is refused. {offered}"
        )
    return (
        f"By hand: a map was written once ({tried.case.map}); compared with the"
        f" {'unaided result' if not tried.unaided.refusal else 'result of the suggested map'} it"
        f" {_against(tried.shown, tried.written)}. {offered}"
    )


def _against(one: Attempt, other: Attempt) -> str:
    if one.refusal:
        return "gives a result where there was none"
    change = largest_change(one, other)
    if change is None:
        return "gives no speed in common"
    if change < 0.005:
        return "changes nothing: friction differs by less than 0.5 % at every speed"
    return "gives other figures, see above"
