"""Plan of the next experiment for one joint."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from frictioncli.design.blocks import Block, all_blocks
from frictioncli.design.decision_probability import decision_probability
from frictioncli.design.design_criterion import DesignCriterion
from frictioncli.design.limits import Limits, limits_of
from frictioncli.design.place_blocks import blocks_about
from frictioncli.design.planned_joint import PlannedJoint, planned_joint
from frictioncli.design.predicted_rows import Timing, predict_rows
from frictioncli.design.rivals import open_questions_of
from frictioncli.design.selection import choose_blocks, seconds_of, steps_of
from frictioncli.design.settings import PlanSettings
from frictioncli.design.steps import Step
from frictioncli.diagnosis.data.build_problem import build_problems
from frictioncli.diagnosis.documents.document import CauseRecord, DiagnosisDocument
from frictioncli.diagnosis.documents.extended_model import ExtendedModel
from frictioncli.errors import NotEnoughData

CHECK = 0.28
"""Share of the time that is reserved for the check on the next day."""

_ENOUGH_LACK_OF_FIT = 1.5
"""Lack of fit in the check, relative to the programme's, beyond which more counts nothing."""

_LACK_OF_FIT_WEIGHT = 0.3
"""Weight of this ratio beside the design criterion."""

_CHECK_EXCHANGES = 40
"""Number of exchanges that are tried for the check."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Expectation:
    """Expected results after a part of the programme.

    Attributes
    ----------
    decision : tuple of float
        Probability, per question, that only the right name remains.
    rule_out : tuple of ndarray
        Probability, per question, that rival j is ruled out if rival i is the cause.
    half_widths : dict of str to float
        Half-width of each parameter's 95 % interval.
    """

    decision: tuple[float, ...]
    rule_out: tuple[np.ndarray, ...]
    half_widths: Mapping[str, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """The next experiment for one joint.

    Attributes
    ----------
    joint : int
        Joint number.
    verdict : str
        Verdict of the diagnosis that it starts from.
    torque_unit : str
        Unit of everything torque-like.
    limits : Limits
        Limits of the motion.
    criterion : DesignCriterion
        Open questions and wide intervals.
    blocks : tuple of Block
        The programme.
    timings : tuple of Timing
        Start, end and motor temperatures of each block.
    check : tuple of Block
        Blocks that are repeated on the next day.
    check_timings : tuple of Timing
        Start, end and motor temperatures of each of them.
    expected : tuple of Expectation
        Before the programme, and after each of its blocks.
    after_check : Expectation
        After programme and check.
    unnamed : CauseRecord or None
        Structure that no effect explains, with what would show its nature.
    """

    joint: int
    verdict: str
    torque_unit: str
    limits: Limits
    criterion: DesignCriterion
    blocks: tuple[Block, ...]
    timings: tuple[Timing, ...]
    check: tuple[Block, ...]
    check_timings: tuple[Timing, ...]
    expected: tuple[Expectation, ...]
    after_check: Expectation
    unnamed: CauseRecord | None = None


def plan_joint(
    torques: pd.DataFrame,
    torque_unit: str,
    document: DiagnosisDocument,
    extended: ExtendedModel,
    settings: PlanSettings,
    *,
    angle_logged: bool = True,
) -> Plan:
    """Plan the next experiment for one joint.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of a single joint.
    torque_unit : str
        Unit of everything torque-like.
    document : DiagnosisDocument
        The joint's part of ``diagnosis.json``.
    extended : ExtendedModel
        Its extended model.
    settings : PlanSettings
        Time budget and limits.
    angle_logged : bool
        Whether the log has the joint's angle.

    Returns
    -------
    Plan
        The programme, the check, and what is expected of both.

    Raises
    ------
    OptionError
        If the limits contradict each other.
    NotEnoughData
        If no block fits into the time.
    """
    limits = limits_of(torques, settings, angle_logged=angle_logged)
    criterion = criterion_of(torques, document, extended, limits, angle_logged=angle_logged)
    about = blocks_about(criterion.forms, limits, settings.seed)
    candidates = (*all_blocks(limits, settings.seed), *about)
    if criterion.joint.thermal_model is None:  # the effect of heating could not be predicted
        candidates = tuple(block for block in candidates if not block.name.startswith("heat"))
    payload = criterion.joint.payload
    budget = 60 * settings.minutes
    blocks = choose_blocks(
        candidates, criterion.value, (1 - CHECK) * budget, payload, settings.seed
    )
    if not blocks:
        raise NotEnoughData(
            f"joint {_joint_number(torques)}: no block fits into {settings.minutes:g} min, or none"
            " would add information; give more time with --minutes"
        )
    rest = budget - seconds_of(blocks, payload)
    check = choose_check(criterion, blocks, rest, payload, settings.seed)
    return Plan(
        unnamed=next((cause for cause in document.causes if not cause.effects), None),
        joint=_joint_number(torques),
        verdict=document.verdict,
        torque_unit=torque_unit,
        limits=limits,
        criterion=criterion,
        blocks=blocks,
        timings=_timings(criterion.joint, blocks),
        check=check,
        check_timings=_timings(criterion.joint, check),
        expected=tuple(expectation(criterion, blocks[:count]) for count in range(len(blocks) + 1)),
        after_check=expectation(criterion, blocks, check),
    )


def criterion_of(
    torques: pd.DataFrame,
    document: DiagnosisDocument,
    extended: ExtendedModel,
    limits: Limits,
    *,
    angle_logged: bool,
) -> DesignCriterion:
    """Return the design criterion of one joint; parameters as for :func:`plan_joint`."""
    problem, _ = build_problems(torques, extended.temperature)
    joint = planned_joint(torques, extended.temperature, problem, limits, angle_logged=angle_logged)
    return DesignCriterion.of(
        joint,
        open_questions_of(problem, document, extended),
        unnamed=document.verdict == "unnamed",
        empirical=extended.empirical,
    )


def choose_check(
    criterion: DesignCriterion,
    blocks: Sequence[Block],
    budget: float,
    payload: float | None,
    seed: int,
) -> tuple[Block, ...]:
    """Return the blocks of a programme that are repeated on the next day.

    The diagnosis holds the last run out to test whether a cause improves the model. Where the cause
    has little effect in that run, a right name would be dropped. With still later runs, this run
    also contributes evidence.

    Parameters
    ----------
    criterion : DesignCriterion
        Open questions and wide intervals.
    blocks : sequence of Block
        The programme.
    budget : float
        Time for the check. [s]
    payload : float or None
        Payload that is mounted before the first block. [kg]
    seed : int
        Seed of the random starts and exchanges.

    Returns
    -------
    tuple of Block
        The check.
    """
    programme = steps_of(blocks)
    reference = max(criterion.lack_of_fit(programme), 1e-9)

    def check_criterion(steps: Sequence[Step]) -> float:
        if not steps:
            return 0.0
        ratio = min(criterion.lack_of_fit(steps) / reference, _ENOUGH_LACK_OF_FIT)
        return criterion.value(programme, steps) + _LACK_OF_FIT_WEIGHT * ratio

    candidates = list(dict.fromkeys(blocks))
    return choose_blocks(
        candidates, check_criterion, budget, payload, seed, exchanges=_CHECK_EXCHANGES
    )


def expectation(criterion: DesignCriterion, *days: Sequence[Block]) -> Expectation:
    """Return the expected results after blocks, day after day.

    Parameters
    ----------
    criterion : DesignCriterion
        Open questions and wide intervals.
    *days : sequence of Block
        Blocks of each day; none: the observed rows alone.

    Returns
    -------
    Expectation
        Probabilities of decisions and widths of intervals.
    """
    information = criterion.observed
    if any(days):
        information = criterion.information_after(*map(steps_of, days))
    rule_out = criterion.rule_out_probabilities(information)
    return Expectation(
        decision=tuple(
            decision_probability(question, one)
            for question, one in zip(criterion.open_questions.questions, rule_out, strict=True)
        ),
        rule_out=rule_out,
        half_widths=criterion.precision_with(information).half_widths,
    )


def _timings(joint: PlannedJoint, blocks: Sequence[Block]) -> tuple[Timing, ...]:
    """Return start, end and motor temperatures of blocks."""
    _, of_steps = predict_rows(joint, steps_of(blocks), "planned")
    timings, first = [], 0
    for block in blocks:
        own = of_steps[first : first + len(block.steps)]
        first += len(block.steps)
        temperatures = (own[0].temperatures[0], own[-1].temperatures[1])
        timings.append(Timing(own[0].start, own[-1].end, temperatures))
    return tuple(timings)


def _joint_number(torques: pd.DataFrame) -> int:
    return int(torques["joint"].iloc[0])
