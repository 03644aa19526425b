"""A plan in plain words."""

from collections import Counter
from collections.abc import Mapping, Sequence
from itertools import groupby

from frictioncli.design.document import IntervalRecord
from frictioncli.design.from_plan import interval_records, raised_chances
from frictioncli.design.plan import Plan
from frictioncli.design.programs.robot_program import SAFETY_NOTE
from frictioncli.wording import probability_text

_LIKELY = 0.01
"""Least probability of a rival that is mentioned."""


def plan_text(
    plan: Plan, units: Mapping[str, str], stated: Mapping[str, float], files: Sequence[str]
) -> str:
    """Return the plan in plain words."""
    whole = plan.timings[-1].end
    lines = [
        f"joint {plan.joint}: {plan.verdict}; next: {whole / 60:.0f} min"
        + (f", and {plan.check_timings[-1].end / 60:.0f} min on the next day" if plan.check else "")
    ]
    for number, question in enumerate(plan.criterion.open_questions.questions):
        shares = ", ".join(
            f"{name} {probability_text(share)}" for name, share in question.probabilities.items()
        )
        now, after = plan.expected[0].decision[number], plan.expected[-1].decision[number]
        lines.append(f"  open: {shares}; the right name alone: {_chance(now)} now,")
        last = plan.after_check.decision[number]
        checked = f", {_chance(last)} with the check" if plan.check else ""
        lines.append(f"    {_chance(after)} after it{checked}{_too_little(last)}")
    if plan.verdict == "unnamed":
        way = "around its location" if plan.criterion.forms else "that spread over all inputs"
        lines.append(f"  no known effect explains the structure: blocks {way}")
    if plan.unnamed is not None:
        lines.append(f"  without a name: {plan.unnamed.claim}")
        lines.append(f"    to find its nature: {plan.unnamed.experiment}")
    told: set[str] = set()
    for first, last in _alike(plan):
        lines += _blocks_text(plan, first, last, tell=plan.blocks[first].name not in told)
        told.add(plan.blocks[first].name)
    if plan.check:
        counts = Counter(block.name for block in plan.check)
        names = [f"{name} ({n} times)" if n > 1 else name for name, n in counts.items()]
        lines.append(f"  next day, cold, as a check: {', '.join(names)}")
        lines.append(
            "    log each day as a separate run: diagnose fits all but the last and tests on it"
        )
    lines += [_interval_text(one) for one in interval_records(plan, units, stated) if one.wide]
    limits = plan.limits
    lines.append(
        f"  within {limits.low:g} to {limits.high:g} deg, {limits.slowest:.3g} to"
        f" {limits.fastest:.4g} deg/s"
        + _temperatures(plan)
        + (f"; beyond the data: {'; '.join(limits.beyond)}" if limits.beyond else "")
    )
    lines.append(f"  program: {', '.join(files)}. {SAFETY_NOTE}")
    return "\n".join(lines)


def _interval_text(interval: IntervalRecord) -> str:
    """Return what is known of a parameter now, and what will be."""
    unit = "" if interval.unit == "1" else f" {interval.unit}"
    after = interval.half_width_after
    if interval.estimate is None or interval.half_width_now is None:
        later = ", nor by it" if after is None else f" now, ±{after:.2g}{unit} after"
        return f"  {interval.parameter}: not determined{later}"
    return (
        f"  {interval.parameter} {interval.estimate:.3g}{unit}:"
        f" ±{interval.half_width_now:.2g} now, ±{after:.2g} after"
    )


def _temperatures(plan: Plan) -> str:
    """Return the limits of the motor temperature, where it is known."""
    if not plan.criterion.joint.thermal_model:
        return ""
    limits = plan.limits
    return f"; heating ends at {limits.hottest:.0f} °C, above {limits.waiting:.0f} °C motion waits"


def _alike(plan: Plan) -> list[tuple[int, int]]:
    """Return the numbers of the first and the last of the blocks of one kind in a row."""
    groups = groupby(range(len(plan.blocks)), key=lambda place: plan.blocks[place].name)
    rows = [list(places) for _, places in groups]
    return [(places[0], places[-1]) for places in rows]


def _blocks_text(plan: Plan, first: int, last: int, *, tell: bool) -> list[str]:
    """Return what there is to say of blocks of one kind in a row; their reason where asked."""
    block, start, end = plan.blocks[first], plan.timings[first], plan.timings[last]
    count = last - first + 1
    number = f"{first + 1}." if count == 1 else f"{first + 1}-{last + 1}."
    low, high = (f"{one:.0f}" for one in (start.temperatures[0], end.temperatures[1]))
    span = low if low == high else f"{low} to {high}"
    warm = "" if low == "nan" else f", motor {span} °C"
    often = f", {count} times" if count > 1 else ""
    lines = [
        f"  {number:>6s} {_clock(start.start)} {block.name}{often}"
        f" ({(end.end - start.start) / 60:.1f} min{warm})"
    ]
    if tell:
        lines.append(f"         {block.reason}")
    before, after = plan.expected[first], plan.expected[last + 1]
    for place, question in enumerate(plan.criterion.open_questions.questions):
        likely = question.probabilities
        raised = raised_chances(question, before, after, place)
        for truth, rival, old, new in [one for one in raised if likely[one[0]] >= _LIKELY][:2]:
            lines.append(
                f"         rules out {rival} if {truth} is the cause:"
                f" {100 * old:.0f} to {100 * new:.0f} %"
            )
    return lines


def _chance(value: float) -> str:
    return "less than 1 %" if value < 0.01 else f"{100 * value:.0f} %"


def _too_little(value: float) -> str:
    return "; more time (--minutes), payloads or range are needed" if value < 0.5 else ""


def _clock(seconds: float) -> str:
    return f"{int(seconds) // 60:d}:{int(seconds) % 60:02d}"
