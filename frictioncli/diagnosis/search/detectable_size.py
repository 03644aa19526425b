r"""Smallest size of an effect that would be named, with what noise and discrepancy take of it.

An effect of the catalogue is planted into the misfit that is there, less what already looks like
it. Its expected statistic is twice the gain of the restricted log likelihood

.. math:: \lambda(s) = 2 \ell_1 - 2 \ell_0(s)

of base and effect to the base alone, each with the noise and the discrepancy that suit it best:
the base alone takes an effect for discrepancy or drift, and the more so the larger it is. Under
fixed variances :math:`\lambda` would grow with the square of the size *s*; so it does not, and the
size that is needed may be several times larger. Nor is what is planted exactly what is fitted: the
form of an entry misses a few per cent of any joint's effect.
"""

from dataclasses import dataclass

import numpy as np
from scipy import stats
from scipy.optimize import brentq

from frictioncli.diagnosis.fit.hypotheses import EffectFit, HypothesisTest, informative_shapes
from frictioncli.diagnosis.noise.significance import statistic_of
from frictioncli.diagnosis.search.cause import CONVINCING
from frictioncli.diagnosis.search.effect_size import left_size
from frictioncli.diagnosis.search.margin import channel_margin, whole_torque
from frictioncli.diagnosis.search.planted_fit import PlantedFit
from frictioncli.diagnosis.search.standing import level_of
from frictioncli.diagnosis.search.step import Step
from frictioncli.effects.base import Effect

POWER = 0.8
"""Probability with which an effect of the smallest detectable size is named."""

_ABOVE = 1 + float(stats.norm.isf(1 - POWER)) / 1.96
"""By how many of its half-widths below the size the lower bound must be above the margin for it to
be so four times in five."""

_STEP = 1.5
"""Factor between two sizes until one would be named."""

_CLOSER = 2
"""Bisections of that factor."""

_SHAPES = 3
"""Number of shapes of an effect at which it is planted."""

_TRIED = 32
"""Greatest number of shapes among which those are looked for that the data show."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Needed:
    """What a name needs.

    Attributes
    ----------
    statistic : float
        Expected statistic.
    margin : float
        Size of which the base must leave more. [N·m]
    most : float
        Torque that an effect cannot be larger than. [N·m]
    """

    statistic: float
    margin: float
    most: float

    @classmethod
    def of(
        cls, step: Step, effect: Effect, test: HypothesisTest, level: float, margin: float
    ) -> "Needed | None":
        """Return what a name needs; None where the data determine none of the coefficients.

        Parameters
        ----------
        step : Step
            Base and other causes.
        effect : Effect
            The effect.
        test : HypothesisTest
            Its test there.
        level : float
            Significance level of a single test.
        margin : float
            Smallest size worth a name. [N·m]
        """
        if test.freedom == 0:
            return None
        threshold = max(
            test.null.critical_value(level_of(effect, level)),
            statistic_of(CONVINCING, test.freedom, test.null.shapes),
        )
        if not np.isfinite(threshold):
            return None
        return cls(
            statistic=noncentrality(threshold, test.freedom),
            margin=channel_margin(step.problem, effect.channel, margin),
            most=whole_torque(step.problem, effect.channel),
        )


def noncentrality(threshold: float, freedom: int) -> float:
    """Return the noncentrality of a chi-squared variable that passes a threshold with `POWER`.

    Examples
    --------
    >>> round(noncentrality(3.84, 1) ** 0.5, 1)
    2.8
    """

    def passes_too_rarely(value: float) -> float:
        return float(stats.ncx2.sf(threshold, freedom, value)) - POWER

    return float(brentq(passes_too_rarely, 1e-6, 1e5))


def detectable_size(
    step: Step, effect: Effect, test: HypothesisTest, level: float, margin: float
) -> float | None:
    """Return the smallest RMS size of an effect that would be named four times in five [N·m].

    The median over shapes of the effect.

    Parameters
    ----------
    step : Step
        Base and other causes.
    effect : Effect
        The effect.
    test : HypothesisTest
        Its test there.
    level : float
        Significance level of a single test.
    margin : float
        Smallest size worth a name. [N·m]

    Returns
    -------
    float or None
        None where it would have to be larger than the torque that there is, or than is physically
        possible.
    """
    needed = Needed.of(step, effect, test, level, margin)
    if needed is None:
        return None
    sizes = [_least(one, needed, test) for one in _planted(step, effect, needed)]
    if not sizes:
        return None
    size = float(np.median(sizes))
    return size if np.isfinite(size) else None


def _planted(step: Step, effect: Effect, needed: Needed) -> list[PlantedFit]:
    """Return an effect in some shapes that the data show; a change in some that last."""
    shapes = informative_shapes(effect, step.problem)
    if effect.moments is not None:
        shapes = [one for one in shapes if one["end"] >= 1.0] or shapes
    places = stats.qmc.Halton(1, scramble=False).random(_TRIED + 1)[1:, 0] * len(shapes)
    found: list[PlantedFit] = []
    for place in dict.fromkeys(places.astype(int).tolist()):
        one = PlantedFit.of(step, effect, shapes[place])
        # as much of it as is worth a name must be physically possible
        if one is not None and one.is_possible(needed.margin):
            found.append(one)
        if len(found) == _SHAPES:
            break
    return found


def _least(planted: PlantedFit, needed: Needed, test: HypothesisTest) -> float:
    """Return the least size of a planted effect that is named; infinity where none is."""
    size = max(float(np.sqrt(needed.statistic)) * test.size_scale, needed.margin)
    size = min(size, needed.most)
    while not _is_named(planted, needed, size):
        size *= _STEP
        if size > needed.most:
            return float("inf")
    low = size / _STEP
    for _ in range(_CLOSER):
        middle = float(np.sqrt(low * size))
        if _is_named(planted, needed, middle):
            size = middle
        else:
            low = middle
    return size


def _is_named(planted: PlantedFit, needed: Needed, size: float) -> bool:
    """Return whether a size passes every gate; those first that take no further fit."""
    if not planted.is_possible(size) or not _is_large(planted, planted.alone(size), needed):
        return False
    fit = planted.expected(size)
    return fit.statistic >= needed.statistic and _is_large(planted, fit, needed)


def _is_large(planted: PlantedFit, fit: EffectFit, needed: Needed) -> bool:
    left, low, _ = left_size(planted.step.precomputed, fit)
    return left - _ABOVE * (left - low) > needed.margin
