"""``plan.json`` of a plan."""

import math
from collections.abc import Mapping, Sequence

from msgspec import UNSET

from frictioncli.design.blocks import Block
from frictioncli.design.document import (
    BlockExpectationRecord,
    BlockRecord,
    ChanceRecord,
    CheckRecord,
    DecisionRecord,
    HeatRecord,
    IntervalRecord,
    LimitsRecord,
    PlanDocument,
    ProgrammeRecord,
    QuestionRecord,
    RaisedChanceRecord,
    RestRecord,
    SeriesRecord,
    ThermalRecord,
    UnnamedRecord,
)
from frictioncli.design.limits import Limits
from frictioncli.design.plan import Expectation, Plan
from frictioncli.design.predicted_rows import Timing
from frictioncli.design.rivals import Question
from frictioncli.design.steps import HeatStep, SeriesStep, Step
from frictioncli.diagnosis.documents.document import CauseRecord
from frictioncli.diagnosis.documents.extended_document import ExtendedDocument
from frictioncli.quantities import TORQUE

_NOTABLE = 0.1
"""A block's reason names rivals whose chance of being ruled out it raises by as much."""


def plan_document(
    plan: Plan,
    units: Mapping[str, str],
    stated: Mapping[str, float],
    files: Sequence[str],
    check_files: Sequence[str],
    minutes: float,
) -> PlanDocument:
    """Return one joint's plan as a document.

    Parameters
    ----------
    plan : Plan
        The plan.
    units : mapping of str to str
        Units of the base model's parameters.
    stated : mapping of str to float
        Half-widths as of :func:`stated_half_widths`.
    files, check_files : sequence of str
        Names of the robot program's files, and of the check's.
    minutes : float
        Time that was given. [min]
    """
    thermal = plan.criterion.joint.thermal_model
    questions = plan.criterion.open_questions.questions
    return PlanDocument(
        joint=plan.joint,
        verdict=plan.verdict,
        torque_unit=plan.torque_unit,
        limits=limits_record(plan.limits),
        programme=ProgrammeRecord(
            files=tuple(files),
            duration_s=_rounded(plan.timings[-1].end),
            blocks=tuple(
                block_record(block, timing, _expected(plan, number))
                for number, (block, timing) in enumerate(
                    zip(plan.blocks, plan.timings, strict=True)
                )
            ),
        ),
        check=CheckRecord(
            when="on the next day, from cold, as a separate run",
            files=tuple(check_files),
            duration_s=_rounded(plan.check_timings[-1].end) if plan.check else 0.0,
            blocks=tuple(
                block_record(block, timing)
                for block, timing in zip(plan.check, plan.check_timings, strict=True)
            ),
        ),
        questions=tuple(_question(plan, one, number) for number, one in enumerate(questions)),
        unnamed=UNSET
        if plan.unnamed is None
        else UnnamedRecord(description=plan.unnamed.claim, experiment=plan.unnamed.experiment),
        intervals=tuple(interval_records(plan, units, stated)),
        thermal=None
        if thermal is None
        else ThermalRecord(
            ambient_degC=_rounded(thermal.ambient),
            time_constant_s=_rounded(thermal.time_constant),
        ),
        budget_min=minutes,
    )


def limits_record(limits: Limits) -> LimitsRecord:
    """Return limits as a record."""
    return LimitsRecord(
        low_deg=limits.low,
        high_deg=limits.high,
        slowest_deg_s=limits.slowest,
        fastest_deg_s=limits.fastest,
        hottest_degC=limits.hottest,
        payloads_kg=limits.payloads,
        speed_step_deg_s=limits.speed_step,
        beyond_measured=limits.beyond,
    )


def block_record(
    block: Block, timing: Timing | None = None, expected: BlockExpectationRecord | None = None
) -> BlockRecord:
    """Return a block as a record, with what is predicted where that is known."""
    temperatures = timing.temperatures if timing else ()
    return BlockRecord(
        name=block.name,
        reason=block.reason,
        start_s=_rounded(timing.start) if timing else UNSET,
        duration_s=_rounded(timing.end - timing.start) if timing else UNSET,
        motor_temperature_degC=tuple(_rounded(one) if one == one else None for one in temperatures)
        if timing
        else UNSET,
        steps=tuple(_step(step) for step in block.steps),
        expected=expected or UNSET,
    )


def _step(step: Step) -> SeriesRecord | HeatRecord | RestRecord:
    if isinstance(step, SeriesStep):
        return SeriesRecord(
            speeds_deg_s=step.speeds, low_deg=step.low, high_deg=step.high, payload_kg=step.payload
        )
    if isinstance(step, HeatStep):
        return HeatRecord(
            speed_deg_s=step.speed,
            low_deg=step.low,
            high_deg=step.high,
            duration_s=step.seconds,
            until_degC=step.until,
        )
    return RestRecord(duration_s=step.seconds, until_degC=step.until)


def _question(plan: Plan, question: Question, number: int) -> QuestionRecord:
    after = plan.expected[-1]
    names = [rival.name for rival in question.rivals]
    return QuestionRecord(
        effects=tuple(names),
        probabilities={name: _rounded(share) for name, share in question.probabilities.items()},
        right_name_alone=DecisionRecord(
            now=_rounded(plan.expected[0].decision[number]),
            after=_rounded(after.decision[number]),
            after_check=_rounded(plan.after_check.decision[number]),
        ),
        rules_out=tuple(
            ChanceRecord(truth=truth, rival=rival, chance=_rounded(after.rule_out[number][i, j]))
            for i, truth in enumerate(names)
            for j, rival in enumerate(names)
            if i != j
        ),
    )


def _expected(plan: Plan, number: int) -> BlockExpectationRecord:
    """Return what is expected after a block, and which rivals it helps to rule out."""
    before, after = plan.expected[number], plan.expected[number + 1]
    return BlockExpectationRecord(
        right_name_alone=tuple(_rounded(one) for one in after.decision),
        rules_out=tuple(
            RaisedChanceRecord(rival=rival, truth=truth, chance_before=old, chance_after=new)
            for place, question in enumerate(plan.criterion.open_questions.questions)
            for truth, rival, old, new in raised_chances(question, before, after, place)
        ),
    )


def raised_chances(
    question: Question, before: Expectation, after: Expectation, place: int
) -> list[tuple[str, str, float, float]]:
    """Return truth, rival and the probability that it is ruled out before and after, largest first.

    Only rivals whose probability a block raises by more than a tenth are returned.
    """
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


def stated_half_widths(
    model: ExtendedDocument, causes: Sequence[CauseRecord] = ()
) -> dict[str, float]:
    """Return the half-widths of the 95 % intervals that a diagnosis states.

    The intervals of a cause allow for the uncertainty of its shape; those of the extended model
    hold at its fitted shape. Where there are both, the cause's count, as in the report.

    Parameters
    ----------
    model : ExtendedDocument
        The extended model.
    causes : sequence of CauseRecord
        The causes of the diagnosis.

    Returns
    -------
    dict of str to float
        By name as in a plan, such as ``beta`` or ``stribeck.boundary_torque``; zero at a bound,
        infinite for a parameter of the base model that the data do not determine. Others without
        an interval are left out.
    """
    unknown = (-math.inf, math.inf)
    intervals = {
        name: one.ci95 if one.determined else unknown for name, one in model.parameters.items()
    }
    for effect in model.effects:
        for name, one in effect.coefficients.items():
            intervals[f"{effect.name}.{name}"] = one.ci95
    for cause in causes:
        for effect_name in cause.effects:
            for name, one in cause.parameters.items():
                if f"{effect_name}.{name}" in intervals:
                    intervals[f"{effect_name}.{name}"] = one.ci95
    return {name: (ci95[1] - ci95[0]) / 2 for name, ci95 in intervals.items() if ci95 is not None}


def interval_records(
    plan: Plan, units: Mapping[str, str], stated: Mapping[str, float]
) -> list[IntervalRecord]:
    """Return the interval of each parameter, now and after the programme.

    What is known now is what the diagnosis states; the programme narrows it by the factor by which
    it narrows the interval that is predicted from the rows. Of a parameter that is not determined
    now, the predicted interval is stated, if it is narrower than the parameter's usual size.

    Parameters
    ----------
    plan : Plan
        The plan.
    units : mapping of str to str
        Units of the base model's parameters.
    stated : mapping of str to float
        Half-widths as of :func:`stated_half_widths`.
    """
    known = dict(units)
    for one in plan.criterion.open_questions.causes:
        for parameter in one.effect.coefficients:
            unit = parameter.unit.replace(TORQUE, plan.torque_unit)
            known[f"{one.effect.name}.{parameter.name}"] = unit
    return [
        _interval(
            plan,
            name,
            stated.get(name),
            unit=known.get(name, ""),
            wide=name in plan.criterion.of_interest and stated.get(name) != 0.0,
        )
        for name in plan.expected[0].half_widths
    ]


def _interval(
    plan: Plan, name: str, stated: float | None, *, unit: str, wide: bool
) -> IntervalRecord:
    """Return the interval of one parameter, of which the diagnosis may state a half-width."""
    first, last = plan.expected[0].half_widths[name], plan.expected[-1].half_widths[name]
    if stated is not None and math.isinf(stated):
        known_after = last < plan.criterion.usual_sizes[name]
        return IntervalRecord(
            parameter=name,
            estimate=None,
            half_width_now=None,
            half_width_after=_rounded(last) if known_after else None,
            unit=unit,
            wide=wide,
        )
    # a parameter at its bound has no interval to narrow
    now = stated or first
    return IntervalRecord(
        parameter=name,
        estimate=_rounded(plan.criterion.estimates[name]),
        half_width_now=_rounded(now),
        # further rows tell no less; the predicted discrepancy may be another over a wider range
        half_width_after=_rounded(now * min(last / first, 1.0)),
        unit=unit,
        wide=wide,
    )


def _rounded(value: float) -> float:
    """Return a value in five digits: more is not known, and last digits differ by machine."""
    return float(f"{value:.5g}")
