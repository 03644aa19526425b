"""The verdict on a joint, and what was found and is not named."""

from collections.abc import Sequence

from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.lack_of_fit import Structure
from frictioncli.diagnosis.search.margin import strength
from frictioncli.diagnosis.search.measurement import CLEAR


def visible_causes(unnamed: Sequence[Cause], problem: Problem) -> tuple[Cause, ...]:
    """Return what was found and is not named, with the reason, largest first.

    An effect of the measurement that nothing speaks for is not worth a line.

    Parameters
    ----------
    unnamed : sequence of Cause
        What was found and is not named.
    problem : Problem
        The joint's rows.
    """
    left = [one for one in unnamed if not one.fit.effect.measurement or one.test.p_value < CLEAR]

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
