"""Smallest size of an effect that would be named, by planting it into the misfit that there is.

An effect of the catalogue is added to the residuals of the joint in several shapes, each with an
error of form, and judged as the search judges it. Noise and discrepancy are those that suit base
and effect best, and the base alone best, which takes an effect for discrepancy or drift, the more
so the larger it is. Then come the size that the base leaves of it, its rivals, and structure
without a name. The result is the size at which four of five shapes are named.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import ceil

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.fit.hypotheses import HypothesisTest
from frictioncli.diagnosis.fit.left_by_base import Z95, left_by, span_of
from frictioncli.diagnosis.noise.significance import statistic_of
from frictioncli.diagnosis.search.between_runs import differs_as_days_do
from frictioncli.diagnosis.search.cause import CONVINCING
from frictioncli.diagnosis.search.effect_size import (
    left_shares,
    left_size,
    remember_left,
    shown_of,
)
from frictioncli.diagnosis.search.margin import channel_margin, whole_torque
from frictioncli.diagnosis.search.planted_fits import SHARED, PlantedFit, PlantedFits
from frictioncli.diagnosis.search.planted_rivals import PlantedRivals, RivalsOfTorques
from frictioncli.diagnosis.search.planted_torque import PlantedTorque, planted_torques
from frictioncli.diagnosis.search.possible import beyond, standard_errors
from frictioncli.diagnosis.search.rivals import evidence_missed
from frictioncli.diagnosis.search.standing import level_of
from frictioncli.diagnosis.search.step import Step
from frictioncli.diagnosis.search.structure import Structure
from frictioncli.diagnosis.search.understood import MOST_LEFT, is_part
from frictioncli.effects.base import Effect

POWER = 0.8
"""Share of the shapes that are named at the smallest detectable size."""

SHAPES = 5
"""Number of shapes in which an effect is planted."""

_MOST = 0.5
"""Greatest size that is claimed, as a share of all friction or load: with a larger effect the base
would be another."""

_LEAST = 1e-3
"""Least size that is tried, as a share of the greatest."""

_LEAST_LEFT = 0.2
"""Least share of its torque that the base must leave of a shape: else an error of form of a tenth
changes what is left by more than a half, and the size that is named by as much."""

_STEP = 2.0
"""Factor from one size that is tried to the next."""

_CLOSE = 1.03
"""Factor to which the size of a shape is resolved."""

_SAME = 1.2
"""Factor within which the base alone has the same noise and discrepancy."""

_ROUNDS = 4
"""Greatest number of times that these are estimated anew."""

_LEFT = 0.5
"""Share of the margin that must be left of a rival."""

_IN_SET = 3.0
"""Greatest difference of the log Bayes factors of an effect and its best rival in one set."""

_STRUCTURE = 30.0
"""Twice the log likelihood from which on what the form misses of an effect is structure."""

_NEVER = float("inf")


@dataclass(frozen=True, slots=True, kw_only=True)
class Rules:
    """What is the same for all effects of a joint.

    Attributes
    ----------
    level : float
        Significance level of a single test.
    margin : float
        Smallest size worth a name. [N·m]
    structure : Structure or None
        Structure without a name that is there.
    unnamed : frozenset of str
        Effects that have no name in these data.
    forms : sequence of ndarray, shape (rows,)
        Errors of form, one for each shape that is planted.
    """

    level: float
    margin: float
    structure: Structure | None
    unnamed: frozenset[str]
    forms: Sequence[Array]


def detectable_size(
    effect: Effect, test: HypothesisTest, rules: Rules, rivals: PlantedRivals
) -> float | None:
    """Return the smallest RMS size of an effect at which four of five shapes are named.

    Parameters
    ----------
    effect : Effect
        The effect.
    test : HypothesisTest
        Its test there.
    rules : Rules
        What a name needs.
    rivals : PlantedRivals
        Base and other causes, and all hypotheses beside them.

    Returns
    -------
    float or None
        The size [N·m]; None where it would have to be more than half of all friction, or load, or
        than is physically possible, and where the base takes too much of some shapes.
    """
    if test.freedom == 0:
        return None
    step = rivals.step
    threshold = max(
        test.null.critical_value(level_of(effect, rules.level)),
        statistic_of(CONVINCING, test.freedom, test.null.shapes),
    )
    margin = channel_margin(step.problem, effect.channel, rules.margin)
    most = _MOST * whole_torque(step.problem, effect.channel)
    torques = planted_torques(step.problem, effect, rules.forms, margin)
    if not (np.isfinite(threshold) and torques and margin < most):
        return None
    shares = left_shares(step.precomputed, [one.torque for one in torques])
    told = [one for one, share in zip(torques, shares, strict=True) if share >= _LEAST_LEFT]
    if len(told) < POWER * len(torques):
        return None
    shapes, columns = [one.shape for one in told], [one.columns for one in told]
    remember_left(step.precomputed, effect, shapes, columns)
    fits = PlantedFits.of(step, told)
    judge = _Judge(fits, rules, rivals, threshold, margin, ceil(POWER * len(torques)))
    size = _settled_size(judge, most)
    return size if np.isfinite(size) else None


def _settled_size(judge: "_Judge", most: float) -> float:
    """Return the size with the noise and discrepancy that the base alone has there."""
    fits, tried = judge.fits, dict[int, float]()
    least = [0.0] * len(fits.torques)
    for _ in range(_ROUNDS):
        least = [_least(judge, judge.doubtful, most, *one) for one in enumerate(least)]
        number = judge.counting(least)
        at = min(least[number], most)
        if number in tried and 1 / _SAME < at / tried[number] < _SAME:
            break
        tried[number] = at
        fits.add_best(number, at)
    if np.isfinite(least[judge.counting(least)]):
        least = [_least(judge, judge.refused, most, *one) for one in enumerate(least)]
    return least[judge.counting(least)]


def _least(
    judge: "_Judge",
    doubtful: Callable[[PlantedFit], bool],
    most: float,
    number: int,
    before: float,
) -> float:
    """Return the least size of a torque that is named; infinity where none is.

    None below the one before: the more is asked for, the larger it is.
    """

    def is_named(size: float) -> bool:
        planted = judge.fits.fitted(number, size)
        return planted.fit.statistic >= judge.threshold and not doubtful(planted)

    if not np.isfinite(before) or (before and is_named(before)):
        return before
    lowest = before or max(judge.margin / 2, _LEAST * most)
    count = max(ceil(np.log(most / lowest) / np.log(_STEP)), 1)
    sizes = np.geomspace(lowest, most, count + 1)[1 if before else 0 :]
    possible = judge.fits.most_statistics(number, sizes) >= judge.threshold
    below = before
    for size, may_be in zip(sizes.tolist(), possible.tolist(), strict=True):
        if may_be and is_named(size):
            break
        below = size
    else:
        return _NEVER
    while below and size > _CLOSE * below:
        middle = float(np.sqrt(below * size))
        if is_named(middle):
            size = middle
        else:
            below = middle
    return size


def _share_missed(step: Step, torque: PlantedTorque) -> float:
    """Return the RMS of what no coefficients of an effect explain of its torque, at a size of 1.

    Base and other causes take their part of it. It counts in the channels in which sizes do.
    """
    problem, span = step.problem, step.once(_span, lambda: _span(step))
    columns, planted = (
        shown_of(problem, torque.effect, left_by(span, basis))
        for basis in (torque.columns, torque.torque)
    )
    rest = planted - columns @ np.linalg.lstsq(columns, planted)[0]
    return float(np.sqrt(np.sum(np.square(rest)) / len(problem.rows)))


def _span(step: Step) -> Array:
    """Return an orthonormal basis of base, measurement and other causes."""
    others = [step.problem.basis(one.effect, one.shape) for one in step.accepted]
    return span_of(step.problem, [*step.precomputed.measurement, *others])


@dataclass(frozen=True, slots=True)
class _Judge:
    """What a planted effect needs for its name, and the number of shapes that must have it."""

    fits: PlantedFits
    rules: Rules
    rivals: PlantedRivals
    threshold: float
    margin: float
    wanted: int
    _of_torques: dict[int, RivalsOfTorques] = field(default_factory=dict)
    _shares_missed: dict[int, float] = field(default_factory=dict)
    _of_days: dict[int, tuple[float, float]] = field(default_factory=dict)

    def counting(self, least: Sequence[float]) -> int:
        """Return the number of the shape up to whose least size enough are named."""
        return int(np.argsort(least, kind="stable")[self.wanted - 1])

    def refused(self, planted: PlantedFit) -> bool:
        """Return whether an effect is doubtful, or taken by a rival."""
        return self.doubtful(planted) or self.rivalled(planted)

    def doubtful(self, planted: PlantedFit) -> bool:
        """Return whether an effect is impossible, too small, or not understood."""
        fit, step, errors = planted.fit, self.fits.step, standard_errors(planted.fit)
        if beyond(fit, self.fits.physical) or not errors.any():
            return True
        if len(errors) == 1 and abs(fit.coefficients[0]) <= Z95 * errors[0]:
            return True
        left, low, _ = left_size(step.precomputed, fit)
        if low <= self.margin:
            return True
        structure = self.rules.structure
        if structure is not None and is_part(fit, left, structure, step.problem):
            return True
        # what is not above the margin is no structure
        least = max(MOST_LEFT * left, self.margin)
        if planted.missed > _STRUCTURE and self._missed(planted) > least:
            return True
        return self._as_days_differ(planted)

    def _as_days_differ(self, planted: PlantedFit) -> bool:
        """Return whether days may differ by as much, and more of the effect is needed."""
        number, size = planted.number, planted.size
        less, more = self._of_days.get(number, (0.0, _NEVER))
        if less < size < more:
            torque = self.fits.torques[number].torque
            if differs_as_days_do(planted.fit, self.fits.step, (torque, size)):
                less = size
            else:
                more = size
            self._of_days[number] = less, more
        return size <= less

    def rivalled(self, planted: PlantedFit) -> bool:
        """Return whether a rival that has no name, or a name of its own, takes an effect."""
        fits, rules = self.fits, self.rules
        planted = fits.fitted(planted.number, planted.size, SHARED)
        if planted.member not in self._of_torques:
            variances = fits.family[planted.member].variances
            found = self.rivals.of_torques(fits.torque_part, variances)
            self._of_torques[planted.member] = found
        rivals = self._of_torques[planted.member]
        own = rivals.own_log_bayes_factor(planted)
        for factor, fit in rivals.better(planted, own):
            size, _, _ = left_size(fits.step.precomputed, fit)
            if size <= _LEFT * channel_margin(fits.step.problem, fit.effect.channel, rules.margin):
                continue
            in_set = own + evidence_missed(fit.statistic, 0.0) > factor - _IN_SET
            return fit.effect.name in rules.unnamed or not in_set
        return False

    def _missed(self, planted: PlantedFit) -> float:
        """Return the RMS of what the form of an effect misses of a torque [unit of its channel]."""
        number = planted.number
        if number not in self._shares_missed:
            torque = self.fits.torques[number]
            self._shares_missed[number] = _share_missed(self.fits.step, torque)
        return planted.size * self._shares_missed[number]
