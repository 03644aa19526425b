"""``plan.json``, and the plan in plain words."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from itertools import groupby
from typing import Any

from frictioncli.design.blocks import Block
from frictioncli.design.limits import Limits
from frictioncli.design.plan import Expectation, Plan
from frictioncli.design.predicted_rows import Timing
from frictioncli.design.programs.robot_program import SAFETY_NOTE
from frictioncli.design.rivals import Question
from frictioncli.design.steps import HeatStep, RestStep, SeriesStep, Step
from frictioncli.quantities import TORQUE

_LIKELY = 0.01
"""A rival as unlikely as this is not spoken of."""

_NOTABLE = 0.1
"""A block's reason names rivals whose chance of being ruled out it raises by as much."""


def plan_document(
    plan: Plan, units: Mapping[str, str], files: Sequence[str], check_files: Sequence[str]
) -> dict[str, Any]:
    """Return one joint's plan as plain values.

    Parameters
    ----------
    plan : Plan
        The plan.
    units : mapping of str to str
        Units of the base model's parameters.
    files, check_files : sequence of str
        Names of the robot program's files, and of the check's.
    """
    return {
        "joint": plan.joint,
        "verdict": plan.verdict,
        "torque_unit": plan.torque_unit,
        "limits": limits_document(plan.limits),
        "programme": {
            "files": list(files),
            "duration_s": _rounded(plan.timings[-1].end),
            "blocks": [
                block_document(block, timing) | {"expected": _expected(plan, number)}
                for number, (block, timing) in enumerate(
                    zip(plan.blocks, plan.timings, strict=True)
                )
            ],
        },
        "check": {
            "when": "on the next day, from cold, as a run of its own",
            "files": list(check_files),
            "duration_s": _rounded(plan.check_timings[-1].end) if plan.check else 0.0,
            "blocks": [
                block_document(block, timing)
                for block, timing in zip(plan.check, plan.check_timings, strict=True)
            ],
        },
        "questions": [
            {
                "effects": [rival.name for rival in question.rivals],
                "probabilities": _shares(question),
                "right_name_alone": {
                    "now": _rounded(plan.expected[0].decision[number]),
                    "after": _rounded(plan.expected[-1].decision[number]),
                    "after_check": _rounded(plan.after_check.decision[number]),
                },
                "rules_out": _ruled_out(question, plan.expected[-1], number),
            }
            for number, question in enumerate(plan.criterion.open_questions.questions)
        ],
        "intervals": _intervals(plan, units),
        "thermal": None
        if plan.criterion.joint.thermal_model is None
        else {
            "ambient_degC": _rounded(plan.criterion.joint.thermal_model.ambient),
            "time_constant_s": _rounded(plan.criterion.joint.thermal_model.time_constant),
        },
    }


def limits_document(limits: Limits) -> dict[str, Any]:
    """Return limits as plain values."""
    return {
        "low_deg": limits.low,
        "high_deg": limits.high,
        "slowest_deg_s": limits.slowest,
        "fastest_deg_s": limits.fastest,
        "hottest_degC": limits.hottest,
        "payloads_kg": list(limits.payloads),
        "speed_step_deg_s": limits.speed_step,
        "beyond_measured": list(limits.beyond),
    }


def block_document(block: Block, timing: Timing | None) -> dict[str, Any]:
    """Return a block as plain values, with what is foreseen of it."""
    told: dict[str, Any] = {"name": block.name, "reason": block.reason}
    if timing is not None:
        warm = [_rounded(one) if one == one else None for one in timing.temperatures]
        told |= {
            "start_s": _rounded(timing.start),
            "duration_s": _rounded(timing.end - timing.start),
            "motor_temperature_degC": warm,
        }
    return told | {"steps": [_step(step) for step in block.steps]}


def _step(step: Step) -> dict[str, Any]:
    names = {"speed": "speed_deg_s", "speeds": "speeds_deg_s", "low": "low_deg", "high": "high_deg"}
    names |= {"seconds": "duration_s", "until": "until_degC", "payload": "payload_kg"}
    kinds = {SeriesStep: "series", HeatStep: "heat", RestStep: "rest"}
    told = {names[name]: value for name, value in asdict(step).items()}
    return {"kind": kinds[type(step)]} | {
        name: list(value) if isinstance(value, tuple) else value for name, value in told.items()
    }


def _shares(question: Question) -> dict[str, float]:
    return {name: _rounded(share) for name, share in question.probabilities.items()}


def _expected(plan: Plan, number: int) -> dict[str, Any]:
    """Return what is expected after a block, and which rivals it helps to rule out."""
    before, after = plan.expected[number], plan.expected[number + 1]
    return {
        "right_name_alone": [_rounded(one) for one in after.decision],
        "rules_out": [
            {"rival": rival, "if": truth, "chance_before": old, "chance_after": new}
            for place, question in enumerate(plan.criterion.open_questions.questions)
            for truth, rival, old, new in _raised(question, before, after, place)
        ],
    }


def _raised(
    question: Question, before: Expectation, after: Expectation, place: int
) -> list[tuple[str, str, float, float]]:
    """Return what a block does for the chance that a rival is ruled out, most first."""
    names = [rival.name for rival in question.rivals]
    found = [
        (
            truth,
            rival,
            _rounded(before.rule_out[place][i, j]),
            _rounded(after.rule_out[place][i, j]),
        )
        for i, truth in enumerate(names)
        for j, rival in enumerate(names)
        if i != j and after.rule_out[place][i, j] - before.rule_out[place][i, j] > _NOTABLE
    ]
    return sorted(found, key=lambda one: one[2] - one[3])


def _ruled_out(question: Question, after: Expectation, place: int) -> list[dict[str, Any]]:
    names = [rival.name for rival in question.rivals]
    return [
        {"if": truth, "rival": rival, "chance": _rounded(after.rule_out[place][i, j])}
        for i, truth in enumerate(names)
        for j, rival in enumerate(names)
        if i != j
    ]


def _intervals(plan: Plan, units: Mapping[str, str]) -> list[dict[str, Any]]:
    known = dict(units)
    for one in plan.criterion.open_questions.causes:
        for parameter in one.effect.coefficients:
            unit = parameter.unit.replace(TORQUE, plan.torque_unit)
            known[f"{one.effect.name}.{parameter.name}"] = unit
    first, last = plan.expected[0].half_widths, plan.expected[-1].half_widths
    return [
        {
            "parameter": name,
            "estimate": _rounded(plan.criterion.estimates[name]),
            "half_width_now": _rounded(first[name]),
            "half_width_after": _rounded(last[name]),
            "unit": known.get(name, ""),
            "wide": name in plan.criterion.of_interest,
        }
        for name in first
    ]


def _rounded(value: float) -> float:
    """Return a value in five digits: more is not known, and last digits differ by machine."""
    return float(f"{value:.5g}")


def plan_text(plan: Plan, units: Mapping[str, str], files: Sequence[str]) -> str:
    """Return the plan in plain words."""
    whole = plan.timings[-1].end
    lines = [
        f"joint {plan.joint}: {plan.verdict}; next: {whole / 60:.0f} min"
        + (f", and {plan.check_timings[-1].end / 60:.0f} min on the next day" if plan.check else "")
    ]
    for number, question in enumerate(plan.criterion.open_questions.questions):
        shares = ", ".join(f"{name} {share:.0%}" for name, share in question.probabilities.items())
        now, after = plan.expected[0].decision[number], plan.expected[-1].decision[number]
        lines.append(f"  open: {shares}; the right name alone: {_chance(now)} now,")
        last = plan.after_check.decision[number]
        checked = f", {_chance(last)} with the check" if plan.check else ""
        lines.append(f"    {_chance(after)} after it{checked}{_too_little(last)}")
    if plan.verdict == "unnamed":
        lines.append("  no known effect explains the structure: blocks that spread over all inputs")
    told: set[str] = set()
    for first, last in _alike(plan):
        lines += _blocks_text(plan, first, last, tell=plan.blocks[first].name not in told)
        told.add(plan.blocks[first].name)
    if plan.check:
        names = ", ".join(block.name for block in plan.check)
        lines.append(f"  next day, cold, as a check: {names}")
        lines.append(
            "    log both as runs of their own: diagnose learns from all runs but the last,"
        )
        lines.append("    which shows whether what it has learned is worth modelling")
    wide = [one for one in _intervals(plan, units) if one["wide"]]
    for one in wide:
        lines.append(
            f"  {one['parameter']} {one['estimate']:.3g} {one['unit']}:"
            f" +-{one['half_width_now']:.2g} now, +-{one['half_width_after']:.2g} after"
        )
    limits = plan.limits
    lines.append(
        f"  within {limits.low:g} to {limits.high:g} deg, {limits.slowest:.3g} to"
        f" {limits.fastest:.4g} deg/s"
        + (f", motor up to {limits.hottest:.0f} °C" if plan.criterion.joint.thermal_model else "")
        + (f"; beyond the data: {'; '.join(limits.beyond)}" if limits.beyond else "")
    )
    lines.append(f"  program: {', '.join(files)}. {SAFETY_NOTE}")
    return "\n".join(lines)


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
    low, high = start.temperatures[0], end.temperatures[1]
    warm = f", motor {low:.0f} to {high:.0f} °C" if low == low else ""
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
        raised = _raised(question, before, after, place)
        for truth, rival, old, new in [one for one in raised if likely[one[0]] >= _LIKELY][:2]:
            lines.append(
                f"         rules out {rival} if {truth} is at work: {old:.0%} to {new:.0%}"
            )
    return lines


def _chance(value: float) -> str:
    return "less than 1 %" if value < 0.01 else f"{value:.0%}"


def _too_little(value: float) -> str:
    return "; more time (--minutes), payloads or range are needed" if value < 0.5 else ""


def _clock(seconds: float) -> str:
    return f"{int(seconds) // 60:d}:{int(seconds) % 60:02d}"
