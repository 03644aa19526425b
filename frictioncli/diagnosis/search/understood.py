"""Which causes are understood: those that are no part of structure without a name."""

from collections.abc import Iterable, Sequence

from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.confounded import goes_with_temperature
from frictioncli.diagnosis.search.step import Step
from frictioncli.diagnosis.search.structure import Structure
from frictioncli.diagnosis.search.structure_above_margin import unnamed_structure
from frictioncli.effects.step_change import EFFECT as STEP_CHANGE

MOST_LEFT = 1 / 3
"""Structure without a name that is greater than this share of a cause along the same axis says that
the cause is not understood."""

_FORM = 0.1
"""Structure along the axes of a cause that is smaller than this share of it is what its equation
does not match of its form. Where the base takes most of a cause, that may be more than what is left
of it: then the cause is not understood."""

_MOST_BESIDE = 1.0
"""Structure along any axis that is greater than this share of a change of friction says the same:
what comes and goes at some moments may be a part of anything that varies slowly. So may what
follows the temperature, which varies slowly with time, of structure along the time."""

_AXES = {
    "clock": "time",
    "order": "time",
    "travel": "time",
    "motor_temperature": "temperature",
    "angle": "position",
    "load": "position",
}
"""Axes of structure along which an effect shows that needs these columns. With one payload the
angle tells the load."""


def understood(
    step: Step, causes: Sequence[Cause], margin: float, alpha: float
) -> tuple[tuple[Cause, ...], Structure | None]:
    """Return the causes that are named, and the structure without a name that is left.

    A cause loses its name to structure along its own axis that is nearly as large, or along the
    temperature if it goes with that; a change of friction to any that is larger; and what follows
    the temperature to a larger one along the time. Both may be one thing that no effect explains.
    The structure is then what is left without the cause. A cause keeps its name where that is many
    times as large along the same axes: beside another one that looks like it, the base leaves less
    of it than it explains.

    Parameters
    ----------
    step : Step
        Base and all accepted effects.
    causes : sequence of Cause
        Causes, of which those whose standing is ``named`` count.
    margin : float
        Smallest size worth a name. [N·m]
    alpha : float
        Significance level.
    """
    named = tuple(one for one in causes if one.standing == "named")
    structure = structure_beside(step, named, margin, alpha)
    if structure is None:
        return named, None
    kept = tuple(one for one in named if not is_part(one.fit, one.visible, structure, step.problem))
    if len(kept) < len(named):
        lost = {one.fit.effect.name for one in named} - {one.fit.effect.name for one in kept}
        rest = [one for one in step.accepted if one.effect.name not in lost]
        without = unnamed_structure(Step.of(step.precomputed, rest), margin, alpha)
        if without is not None and _is_mostly_explained(structure, without):
            return named, structure
        structure = without or structure
    return kept, structure


def _is_mostly_explained(structure: Structure, without: Structure) -> bool:
    """Return whether the causes beside which structure is left explain most of it without them."""
    same = structure.channel == without.channel and structure.axes == without.axes
    return same and structure.size <= MOST_LEFT * without.size


def structure_beside(
    step: Step, named: Sequence[Cause], margin: float, alpha: float
) -> Structure | None:
    """Return structure that is not the error of the form of a named cause; None without any.

    Parameters
    ----------
    step : Step
        Base and all that stands beside it.
    named : sequence of Cause
        Causes that are named.
    margin : float
        Smallest size worth a name. [N·m]
    alpha : float
        Significance level.
    """

    def is_form(structure: Structure) -> bool:
        return any(_is_form_of(one, structure) for one in named)

    return unnamed_structure(step, margin, alpha, is_form)


def axes_told(names: Iterable[str]) -> set[str]:
    """Return the axes along which these axes, or columns that an effect needs, show.

    Parameters
    ----------
    names : iterable of str
        Axes of structure or columns.
    """
    return {_AXES.get(one, one) for one in names}


def _is_form_of(cause: Cause, unnamed: Structure) -> bool:
    """Return whether structure is the error of a cause's form."""
    effect = cause.fit.effect
    own = axes_told(unnamed.axes) <= axes_told(effect.needs)
    same = not effect.measurement and effect.channel == unnamed.channel
    return same and own and unnamed.size < min(_FORM * cause.size, MOST_LEFT * cause.visible)


def is_part(fit: EffectFit, visible: float, unnamed: Structure, problem: Problem) -> bool:
    """Return whether a cause may be a part of structure without a name.

    Parameters
    ----------
    fit : EffectFit
        The cause, with its shape.
    visible : float
        What the base leaves of it. [N·m]
    unnamed : Structure
        The structure.
    problem : Problem
        The rows: what is there at one end of the temperatures alone shows along these as well.
    """
    effect = fit.effect
    if effect.measurement or effect.channel != unnamed.channel:
        return False
    along = axes_told(effect.needs)
    if goes_with_temperature(fit, problem):
        along.add("temperature")
    if along.isdisjoint(axes_told(unnamed.axes)):
        is_slow = effect is STEP_CHANGE or ("temperature" in along and unnamed.axes == ("time",))
        return is_slow and unnamed.size > _MOST_BESIDE * visible
    return unnamed.size > MOST_LEFT * visible
