"""Which lack of fit counts as structure that no effect explains."""

from collections.abc import Callable, Sequence
from dataclasses import replace

from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.search.lack_of_fit import TOLD_BY_ANGLE, beside_others, structures
from frictioncli.diagnosis.search.margin import channel_margin
from frictioncli.diagnosis.search.step import Step
from frictioncli.diagnosis.search.structure import SIGNIFICANT, Structure

_NO_DOUBT = 1e-12
"""P-value below which there is no doubt that structure is there."""


def unnamed_structure(
    step: Step,
    margin: float,
    alpha: float,
    is_known: Callable[[Structure], bool] = lambda _: False,
) -> Structure | None:
    """Return the most significant structure beside the causes that is above the margin.

    Surely above it, or most probably where there is no doubt that it is there.

    Parameters
    ----------
    step : Step
        Base and accepted effects.
    margin, alpha : float
        Smallest size worth a name [N·m] and significance level.
    is_known : callable, optional
        Whether structure belongs to something that is known, and does not count.
    """
    found = structures(step)
    unknown = [one for one in found if not is_known(one)]
    level = min(SIGNIFICANT, alpha)

    def beside(one: Structure, others: Sequence[Structure]) -> Structure | None:
        return beside_others(one, others, step)

    first = first_above(unknown, step.problem, margin, level, beside)
    return None if first is None else replace(first, or_load=_may_be_of_load(first, found))


def first_above(
    found: Sequence[Structure],
    problem: Problem,
    margin: float,
    level: float,
    beside: Callable[[Structure, Sequence[Structure]], Structure | None],
) -> Structure | None:
    """Return the most likely structure above the margin, if any is significant and surely above it.

    Where one is surely above the margin, that much is left; along which axis, the likeliest says.
    What is above the margin only because it imitates something likelier that is not, does not
    count: it must be above the margin beside that, too.

    Parameters
    ----------
    found : sequence of Structure
        The lack of fit along every axis, most likely first.
    problem : Problem
        The rows.
    margin, level : float
        Smallest size worth a name [N·m] and greatest p-value.
    beside : callable
        Structure as it is beside others, or None where nothing is left of it.
    """

    def is_above(one: Structure) -> bool:
        return one.p_value < level and one.size > channel_margin(problem, one.channel, margin)

    small = [one for one in found if one.p_value < level and not is_above(one)]

    def remains(one: Structure) -> bool:
        likelier = [other for other in small if other.statistic > one.statistic]
        left = beside(one, likelier) if likelier else one
        return left is not None and is_above(left)

    above = [one for one in found if is_above(one) and remains(one)]
    for one in above:
        least = one.size if one.p_value < _NO_DOUBT else one.interval[0]
        if least > channel_margin(problem, one.channel, margin):
            return above[0]
    return None


def _may_be_of_load(one: Structure, found: Sequence[Structure]) -> bool:
    """Return whether structure along the angle is about as likely along the load."""
    return one.axes[0] == "position" and any(
        two.axes == ("load", *one.axes[1:])
        and two.channel == one.channel
        and two.statistic > one.statistic - TOLD_BY_ANGLE
        for two in found
    )
