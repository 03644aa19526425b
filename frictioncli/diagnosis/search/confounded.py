"""What goes together in the data, so that an effect of one thing may be an effect of another."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pandas as pd

from frictioncli.arrays import Array, Flags
from frictioncli.diagnosis.data.pair_neighbours import numbered
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.columns import main_channel
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.effect_size import FORM
from frictioncli.effects.backlash import EFFECT as BACKLASH
from frictioncli.effects.base import Effect
from frictioncli.effects.inertia import EFFECT as INERTIA
from frictioncli.effects.position_ripple import EFFECT as POSITION_RIPPLE
from frictioncli.effects.position_ripple import periods_seen
from frictioncli.effects.reversal_transient import EFFECT as REVERSAL_TRANSIENT
from frictioncli.wording import in_words

_TOGETHER = 0.8
"""Rank correlation of temperature and time above which few data tell one from the other."""

_WITHIN_RUNS = 0.05
"""Share of the variance of the logarithm of speed that must be within runs."""

_TURNS_APART = 0.1
"""Standard deviation of the ends of moves at one speed in one run, relative to the whole stroke,
above which moves turn elsewhere each time."""

_FROM_ENDS = frozenset({INERTIA.name, REVERSAL_TRANSIENT.name})
"""Effects that count from the ends of the stroke."""

_GOES_WITH_TIME = (
    "temperature and time change together in these data, and either could be the cause"
)

NO_TEMPERATURE = (
    "the log has no temperature, and a joint that warms up or cools down would look the same; log"
    " that of the motor or the housing"
)

_GOES_WITH_RUN = (
    "every run has its own speed, and any other difference between the runs could be the cause"
)

_ONE_SPEED = 1.1
"""Ratio of the highest to the lowest speed up to which all moves have one speed."""

_GOES_WITH_DELAY = "all moves have one speed, at which a delay of the torque looks the same"

_UNKNOWN_ENDS = (
    "the moves reverse at different angles each time, which the ends of the paired range do not"
    " show"
)

_LOOKS_LIKE_ENDS = (
    "the moves reverse at different angles each time, and errors in the form of {other} look"
    " the same"
)

_LEAST_SEEN = 1.5
"""Periods of a ripple in the stroke below which less than half of it is seen twice: it may be any
smooth function of the angle, as one bump."""

_LOOKS_LIKE_SMOOTH = (
    "over the angles measured it would hardly repeat, and any smooth dependence of friction on the"
    " angle looks the same"
)

_LOOKS_LIKE_FORM = "errors in the form of {other} may look the same"

_APART = 0.98
"""Share of pairs of pairs, one with a change and one without, of which the same is warmer, from
which the change goes with the temperature."""

_OF_TIME = frozenset({"clock", "order", "travel"})
"""Inputs that are of time."""

_GRADUAL = frozenset({"temperature", "motor_temperature", "clock", "travel"})
"""Inputs that change gradually with the temperature or with time."""


def confounded(effect: Effect, problem: Problem) -> str:
    """Return why an effect may be one of another input, which goes with its own; empty if not.

    Parameters
    ----------
    effect : Effect
        Entry of the catalogue.
    problem : Problem
        The joint's rows.
    """
    if problem.doubt and not effect.measurement:
        return problem.doubt
    if _is_gradual(effect):
        if not has_temperature(problem):
            return NO_TEMPERATURE
        if _temperature_goes_with_time(problem):
            return _GOES_WITH_TIME
    if effect is BACKLASH and float(np.ptp(np.log(problem.layout.speed))) < np.log(_ONE_SPEED):
        return _GOES_WITH_DELAY
    return _GOES_WITH_RUN if _goes_with_run(effect, problem) else ""


def goes_with_temperature(fit: EffectFit, problem: Problem) -> bool:
    """Return whether an effect of time or travel has its torque at one end of the temperatures.

    What is gone after the first pairs of a joint that warms up is there in the coldest ones alone,
    where friction that depends on temperature would look the same.

    Parameters
    ----------
    fit : EffectFit
        The effect, with its shape.
    problem : Problem
        The joint's rows.
    """
    if _OF_TIME.isdisjoint(fit.effect.needs) or not has_temperature(problem):
        return False
    torque = main_channel(problem.basis(fit.effect, fit.shape), fit.effect) @ fit.coefficients
    temperature = problem.table.measured_temperature
    of_pairs = problem.layout.means(np.column_stack([torque, temperature]))
    there = of_pairs[:, 0] > (of_pairs[:, 0].min() + of_pairs[:, 0].max()) / 2
    return are_warmer_or_colder(there, of_pairs[:, 1])


def are_warmer_or_colder(there: Flags, temperature: Array) -> bool:
    """Return whether some pairs are warmer than the others, or colder, nearly without exception.

    Parameters
    ----------
    there : ndarray of bool, shape (pairs,)
        Which pairs.
    temperature : ndarray, shape (pairs,)
        Temperature of all. [°C]
    """
    rank = pd.Series(temperature).rank().to_numpy()
    some, others = int(there.sum()), int((~there).sum())
    if not some or not others:
        return False
    warmer = (float(rank[there].sum()) - some * (some + 1) / 2) / (some * others)
    return max(warmer, 1 - warmer) >= _APART


def unclaimed(effect: Effect, problem: Problem) -> str:
    """Return why nobody can say from which size on an effect has a name; empty if one can.

    Parameters
    ----------
    effect : Effect
        Entry of the catalogue.
    problem : Problem
        The joint's rows.
    """
    reason = confounded(effect, problem)
    if not reason and effect.name in _FROM_ENDS and turns_elsewhere(problem):
        return _UNKNOWN_ENDS
    return reason


def hardly_repeats(fit: EffectFit, problem: Problem) -> str:
    """Return why a ripple may be any smooth function of the angle; empty if it repeats.

    Parameters
    ----------
    fit : EffectFit
        The effect, with its shape.
    problem : Problem
        The joint's rows.
    """
    if fit.effect is not POSITION_RIPPLE:
        return ""
    return _LOOKS_LIKE_SMOOTH if periods_seen(problem.table, **fit.shape) < _LEAST_SEEN else ""


def without_forms_of_ends(causes: Sequence[Cause], problem: Problem) -> tuple[Cause, ...]:
    """Return causes without a name for what the form of an effect at the ends of the stroke misses.

    Where moves turn elsewhere each time, inertia and friction after a reversal begin at angles that
    the ends of what was paired do not tell. What is left of them then depends on the angle.

    Parameters
    ----------
    causes : sequence of Cause
        Causes with their standing.
    problem : Problem
        The joint's rows.
    """
    judged = list(causes)
    at_ends = [one for one in causes if one.standing == "named" and _is_at_ends(one)]
    if not at_ends or not turns_elsewhere(problem):
        return tuple(judged)
    for number, one in enumerate(judged):
        if one.standing != "named" or _is_at_ends(one) or "position" not in one.fit.effect.needs:
            continue
        for other in at_ends:
            same = one.fit.effect.channel == other.fit.effect.channel
            if same and one.visible < other.visible:
                reason = _LOOKS_LIKE_ENDS.format(other=in_words(other.fit.effect.name))
                judged[number] = replace(one, standing="undetermined", reason=reason)
    return tuple(judged)


def without_forms_of_others(causes: Sequence[Cause]) -> tuple[Cause, ...]:
    """Return causes without a name for an effect of the measurement that a form may miss.

    The form of an entry misses a share of its whole torque. Where the base takes most of that, what
    is missed may look like one of those effects of the measurement with which it is confused.

    Parameters
    ----------
    causes : sequence of Cause
        Causes with their standing.
    """
    judged = list(causes)
    named = {one.fit.effect.name: one for one in causes if one.standing == "named"}
    for number, one in enumerate(judged):
        if one.standing != "named" or not one.fit.effect.measurement:
            continue
        for name in one.fit.effect.confounders:
            other = named.get(name)
            if other is None or other.fit.effect.measurement:
                continue
            if one.visible_interval[0] < FORM * other.size:
                reason = _LOOKS_LIKE_FORM.format(other=in_words(name))
                judged[number] = replace(one, standing="visible", reason=reason)
    return tuple(judged)


def _is_at_ends(cause: Cause) -> bool:
    return cause.fit.effect.name in _FROM_ENDS


def turns_elsewhere(problem: Problem) -> bool:
    """Return whether moves at one speed in one run turn elsewhere each time.

    Parameters
    ----------
    problem : Problem
        The joint's rows.
    """
    position, layout = problem.table.position, problem.layout
    _, heads = np.unique(layout.row_pair, return_index=True)
    groups = numbered(layout.run, layout.level)
    found = []
    for ends in (np.minimum.reduceat(position, heads), np.maximum.reduceat(position, heads)):
        own = [_squares(ends[groups == one]) for one in np.unique(groups)]
        found.append(float(np.sqrt(sum(own) / len(ends))))
    return max(found) > _TURNS_APART * float(np.ptp(position))


def _is_gradual(effect: Effect) -> bool:
    """Return whether an effect changes gradually with temperature or with time.

    A change at a moment does not, nor does a lag, which shows at each speed by how friction falls
    with temperature there.
    """
    if effect.measurement or effect.moments is not None or "temperature_slope" in effect.needs:
        return False
    return not _GRADUAL.isdisjoint(effect.needs)


def has_temperature(problem: Problem) -> bool:
    """Return whether the log has a temperature of the motor or of the housing.

    Parameters
    ----------
    problem : Problem
        The joint's rows.
    """
    table = problem.table
    return any(
        bool(np.isfinite(one).any()) for one in (table.motor_temperature, table.housing_temperature)
    )


def _temperature_goes_with_time(problem: Problem) -> bool:
    """Return whether temperature and time go together in these data.

    Where the joint mostly warms up, what goes with temperature goes with time as well: a drift
    looks like friction that depends on temperature.
    """
    table = problem.table
    known = np.column_stack([table.measured_temperature, table.clock])
    means = pd.DataFrame(problem.layout.means(known))
    return abs(float(means.corr(method="spearman").iloc[0, 1])) >= _TOGETHER


def _goes_with_run(effect: Effect, problem: Problem) -> bool:
    """Return whether an effect shows by speed, and speeds differ between runs only.

    The day, the payload and the pose differ between runs as well. An effect that counts from the
    ends of the stroke shows at one speed.
    """
    if "speed" not in effect.needs or "position" in effect.needs:
        return False
    run = problem.layout.run
    speed = np.log(problem.layout.speed)
    whole = _squares(speed)
    within = sum(_squares(speed[run == one]) for one in np.unique(run))
    return whole > 0 and within < _WITHIN_RUNS * whole


def _squares(values: Array) -> float:
    return float(np.sum(np.square(values - np.mean(values))))
