"""The verdict on a joint, and what was found and is not named."""

from collections.abc import Sequence

from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.margin import strength
from frictioncli.diagnosis.search.measurement import CLEAR
from frictioncli.diagnosis.search.structure import Structure
from frictioncli.effects.inertia import EFFECT as INERTIA
from frictioncli.effects.sensor_lag import EFFECT as SENSOR_LAG
from frictioncli.effects.thermal_lag import EFFECT as THERMAL_LAG
from frictioncli.effects.torque_filter import EFFECT as TORQUE_FILTER

_IN_SIZE_OF = {SENSOR_LAG.name: THERMAL_LAG.name, TORQUE_FILTER.name: INERTIA.name}
"""Effects of the measurement that may be a part of what is seen of a property of the joint."""


def visible_causes(
    unnamed: Sequence[Cause], refused: Sequence[Cause], causes: Sequence[Cause], problem: Problem
) -> tuple[Cause, ...]:
    """Return what was found and is not named, with the reason, largest first.

    An effect of the measurement that nothing speaks for is not worth a line, unless it was refused
    and may be in the size of a cause. One that was refused and then stands beside fewer causes has
    one line.

    Parameters
    ----------
    unnamed : sequence of Cause
        What was found and is not named.
    refused : sequence of Cause
        Effects of the measurement that do not stand beside the base.
    causes : sequence of Cause
        Causes that are named.
    problem : Problem
        The joint's rows.
    """

    def is_worth_a_line(cause: Cause) -> bool:
        return not cause.fit.effect.measurement or cause.test.p_value < CLEAR

    alone = {one.effects[0] for one in causes if len(one.effects) == 1}
    left = [one for one in unnamed if is_worth_a_line(one)]
    told = {one.fit.effect.name for one in left}
    left += [
        one
        for one in refused
        if one.fit.effect.name not in told
        and (is_worth_a_line(one) or _IN_SIZE_OF.get(one.fit.effect.name) in alone)
    ]

    def share(cause: Cause) -> float:
        return strength(problem, cause.fit.effect.channel, cause.visible)

    return tuple(sorted(left, key=share, reverse=True))


def verdict_of(causes: Sequence[Cause], unnamed: Structure | None) -> str:
    """Return the verdict: whether causes were found, and whether each has a single name.

    Parameters
    ----------
    causes : sequence of Cause
        Causes that are named.
    unnamed : Structure or None
        Structure without a name.
    """
    if unnamed is not None:
        return "unnamed"
    if not causes:
        return "no_evidence"
    return "named" if all(len(cause.effects) == 1 for cause in causes) else "ambiguous"
