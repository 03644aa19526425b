"""The plan of the next experiment for one joint."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd

from frictioncli.design.blocks import Block, all_blocks
from frictioncli.design.decision_probability import decided
from frictioncli.design.design_criterion import DesignCriterion
from frictioncli.design.limits import Limits, limits_of
from frictioncli.design.predicted_rows import Moment, PlannedJoint, foreseen, plain
from frictioncli.design.rivals import open_questions
from frictioncli.design.selection import chosen, seconds_of, steps_of
from frictioncli.design.settings import PlanSettings
from frictioncli.design.steps import Step
from frictioncli.design.thermal_model import thermal_model_of
from frictioncli.diagnosis.data.gravity import NAMES
from frictioncli.diagnosis.data.problem import Problem, build_problems
from frictioncli.diagnosis.documents.extended_model import ExtendedModel
from frictioncli.errors import NotEnoughData
from frictioncli.model.friction import PUBLISHED, FrictionParameters

CHECK = 0.28
"""Share of the time that is kept for the check on the next day."""

_SHOWN = 1.5
"""A check that shows the likely causes so many times as much as the programme shows enough."""

_SHOWING = 0.3
"""Weight of what the check shows, beside its worth after the programme."""

_TRIALS = 40
"""Exchanges that are tried for the check."""

_LEVER = 0.5 * 9.80665
"""Gravity torque of a mass at half a metre, where no payload has been changed yet. [N·m/kg]"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Expected:
    """What is expected after a part of the programme.

    Attributes
    ----------
    decided : tuple of float
        Probability, per question, that it ends with the right name alone.
    chances : tuple of ndarray
        Probability, per question, that rival i, if it is at work, leaves rival j behind.
    half_widths : dict of str to float
        Half of each parameter's 95 % interval.
    """

    decided: tuple[float, ...]
    chances: tuple[np.ndarray, ...]
    half_widths: Mapping[str, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """The next experiment for one joint.

    Attributes
    ----------
    joint : int
        Joint number.
    verdict : str
        The diagnosis that it starts from.
    torque_unit : str
        Unit of everything torque-like.
    limits : Limits
        Within which it stays.
    outlook : DesignCriterion
        What is open.
    blocks : tuple of Block
        The programme.
    moments : tuple of Moment
        When each block begins and ends, and how warm the motor is then.
    check : tuple of Block
        What is repeated on the next day.
    check_moments : tuple of Moment
        The same of it.
    expected : tuple of Expected
        Before the programme, and after each of its blocks.
    settled : Expected
        After programme and check, by all runs together.
    """

    joint: int
    verdict: str
    torque_unit: str
    limits: Limits
    outlook: DesignCriterion
    blocks: tuple[Block, ...]
    moments: tuple[Moment, ...]
    check: tuple[Block, ...]
    check_moments: tuple[Moment, ...]
    expected: tuple[Expected, ...]
    settled: Expected


def plan_joint(
    torques: pd.DataFrame,
    torque_unit: str,
    document: Mapping[str, Any],
    extended: ExtendedModel,
    settings: PlanSettings,
) -> Plan:
    """Plan the next experiment for one joint.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of a single joint.
    torque_unit : str
        Unit of everything torque-like.
    document : mapping
        The joint's part of ``diagnosis.json``.
    extended : ExtendedModel
        Its extended model.
    settings : PlanSettings
        Budget and limits.

    Raises
    ------
    OptionError
        If the limits contradict each other.
    NotEnoughData
        If no block fits into the time.
    """
    limits = limits_of(torques, settings)
    outlook = outlook_of(torques, document, extended, limits)
    candidates = all_blocks(limits, settings.seed)
    if outlook.joint.warmth is None:  # what heats cannot be told apart from what does not
        candidates = tuple(block for block in candidates if not block.name.startswith("heat"))
    payload = outlook.joint.payload
    budget = 60 * settings.minutes
    blocks = chosen(candidates, outlook.worth, (1 - CHECK) * budget, payload, settings.seed)
    if not blocks:
        raise NotEnoughData(
            f"joint {_number_of(torques)}: no block fits into {settings.minutes:g} min, or none"
            " tells anything new; give more time with --minutes"
        )
    rest = budget - seconds_of(blocks, payload)
    check = check_of(outlook, blocks, rest, payload, settings.seed)
    return Plan(
        joint=_number_of(torques),
        verdict=str(document["verdict"]),
        torque_unit=torque_unit,
        limits=limits,
        outlook=outlook,
        blocks=blocks,
        moments=_moments(outlook.joint, blocks),
        check=check,
        check_moments=_moments(outlook.joint, check),
        expected=tuple(expected(outlook, blocks[:count]) for count in range(len(blocks) + 1)),
        settled=expected(outlook, blocks, check),
    )


def outlook_of(
    torques: pd.DataFrame, document: Mapping[str, Any], extended: ExtendedModel, limits: Limits
) -> DesignCriterion:
    """Return what is open of one joint; parameters as of :func:`plan_joint`."""
    problem, _ = build_problems(torques, extended.temperature)
    joint = PlannedJoint(
        torques=plain(torques),
        temperature=extended.temperature,
        parameters=_planning_parameters(problem),
        gravity=_planning_gravity(problem, limits),
        warmth=thermal_model_of(torques),
    )
    return DesignCriterion.of(
        joint,
        open_questions(problem, document, extended),
        unnamed=document["verdict"] == "unnamed",
    )


def check_of(
    outlook: DesignCriterion,
    blocks: Sequence[Block],
    budget: float,
    payload: float | None,
    seed: int,
) -> tuple[Block, ...]:
    """Return what of a programme is repeated on the next day.

    Diagnosis keeps the last run to see whether a cause is worth modelling. Where the cause does not
    show there, a right name would be dropped. Later that run speaks for or against names, too.

    Parameters
    ----------
    outlook : DesignCriterion
        What is open.
    blocks : sequence of Block
        The programme.
    budget : float
        Time for the check. [s]
    payload : float or None
        What is on before. [kg]
    seed : int
        Source of what is tried.
    """
    programme = steps_of(blocks)
    usual = max(outlook.shown(programme), 1e-9)

    def worth(steps: Sequence[Step]) -> float:
        if not steps:
            return 0.0
        shown = min(outlook.shown(steps) / usual, _SHOWN)
        return outlook.worth(programme, steps) + _SHOWING * shown

    return chosen(list(dict.fromkeys(blocks)), worth, budget, payload, seed, trials=_TRIALS)


def expected(outlook: DesignCriterion, *days: Sequence[Block]) -> Expected:
    """Return what is expected after blocks, day after day."""
    sight = outlook.after(*map(steps_of, days)) if any(days) else outlook.before
    chance = outlook.chances(sight)
    return Expected(
        decided=tuple(
            decided(question, one)
            for question, one in zip(outlook.opening.questions, chance, strict=True)
        ),
        chances=chance,
        half_widths=outlook.narrowed(sight).half_widths,
    )


def _moments(joint: PlannedJoint, blocks: Sequence[Block]) -> tuple[Moment, ...]:
    """Return when blocks begin and end, and how warm the motor is then."""
    _, each = foreseen(joint, steps_of(blocks), "planned")
    found, first = [], 0
    for block in blocks:
        own = each[first : first + len(block.steps)]
        first += len(block.steps)
        warm = (own[0].temperatures[0], own[-1].temperatures[1])
        found.append(Moment(own[0].start, own[-1].end, warm))
    return tuple(found)


def _planning_parameters(problem: Problem) -> FrictionParameters:
    """Return the fitted friction; what the data cannot tell has a usual value.

    A design that is best for one value of a parameter needs a guess of it [1]_. Where the fall with
    temperature is not determined, the published rate is taken, and half of the viscous part falls.

    References
    ----------
    .. [1] H. Chernoff, "Locally optimal designs for estimating parameters," Ann. Math. Stat. 24(4),
       1953, doi:10.1214/aoms/1177728915.
    """
    fitted = problem.parameters
    if fitted.gamma > 0 and fitted.delta > 0:
        return fitted
    warm = float(np.mean(problem.table.temperature)) or 20.0
    viscous = max(fitted.beta, 1e-3 * float(np.mean(np.abs(problem.friction))))
    return replace(
        fitted,
        beta=viscous / 2,
        gamma=viscous / 2 * float(np.exp(PUBLISHED.delta * warm)),
        delta=PUBLISHED.delta,
    )


def _planning_gravity(problem: Problem, limits: Limits) -> np.ndarray:
    """Return the fitted gravity; a payload that is new to the data gets a usual lever."""
    if len(problem.gravity) > len(NAMES) or not limits.payloads:
        return problem.gravity
    return np.append(problem.gravity, [_LEVER, 0.0])


def _number_of(torques: pd.DataFrame) -> int:
    """Return the number of the joint that rows are of."""
    return int(torques["joint"].iloc[0])
