r"""Smallest size of an effect that would be named, with what noise and discrepancy take of it.

An effect of the catalogue is planted into the misfit that is there, less what already looks like
it. Its expected statistic is twice the gain of the restricted log likelihood

.. math:: \lambda(s) = 2 \ell_1 - 2 \ell_0(s)

of base and effect to the base alone, each with the noise and the discrepancy that suit it best:
the base alone takes an effect for discrepancy or drift, and the more so the larger it is. Under
fixed variances :math:`\lambda` would grow with the square of the size *s*; so it does not, and the
size that is needed may be several times larger. Nor is what is planted exactly what is fitted: the
form of an entry misses a few per cent of any joint's effect, which is much where the base takes
nearly all of it.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from frictioncli.diagnosis.fit.hypotheses import EffectFit, HypothesisTest, informative_shapes
from frictioncli.diagnosis.fit.left_by_base import Z95
from frictioncli.diagnosis.noise.significance import statistic_of
from frictioncli.diagnosis.search.cause import CONVINCING
from frictioncli.diagnosis.search.effect_size import left_share, left_size
from frictioncli.diagnosis.search.margin import channel_margin, whole_torque
from frictioncli.diagnosis.search.planted_fit import FORM, PlantedFit
from frictioncli.diagnosis.search.standing import level_of
from frictioncli.diagnosis.search.step import Step
from frictioncli.distributions import normal_quantile
from frictioncli.effects.base import Effect

POWER = 0.8
"""Probability with which an effect of the smallest detectable size is named."""

_ABOVE = 1 + -float(normal_quantile(1 - POWER)) / 1.96
"""By how many of its half-widths below the size the lower bound must be above the margin for it to
be so four times in five."""

_STEP = 1.25
"""Factor to which the size is resolved, and by which it grows at least until it would be named."""

_LEAP = 3.0
"""Factor by which it grows at most."""

_NEVER = float("inf")
"""Size of what is never named, and factor by which a physically impossible size is too small."""

_SHAPES = 9
"""Number of shapes of an effect of which it is planted in the middle one."""

_HISTORIES = 3
"""Number of histories of a change with which it is planted: what drift takes of it depends on them
by more than what the base does."""


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
    from scipy.stats import ncx2  # takes long to import

    def passes_too_rarely(value: float) -> float:
        return float(ncx2.sf(threshold, freedom, value)) - POWER

    return float(brentq(passes_too_rarely, 1e-6, 1e5))


def detectable_size(
    step: Step, effect: Effect, test: HypothesisTest, level: float, margin: float
) -> float | None:
    """Return the smallest RMS size of an effect that would be named four times in five [N·m].

    Of an average shape of the effect; of a change the median over some histories.

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
    """Return an effect in the shape of which the base leaves an average share.

    A change with several histories that last. Those of which a size worth a name is possible.
    """
    from scipy.stats import qmc  # takes long to import

    shapes, wanted = informative_shapes(effect, step.problem), 1
    if effect.moments is not None:
        shapes, wanted = [one for one in shapes if one["end"] >= 1.0] or shapes, _HISTORIES
    places = qmc.Halton(1, scramble=False).random(_SHAPES + 1)[1:, 0] * len(shapes)
    some = [shapes[place] for place in dict.fromkeys(places.astype(int).tolist())]
    if effect.moments is None:
        shares = np.array([left_share(step.precomputed, effect, shape) for shape in some])
        order = np.argsort(np.abs(shares - np.median(shares)), kind="stable")
        some = [some[place] for place in order]
    found: list[PlantedFit] = []
    for shape in some:
        one = PlantedFit.of(step, effect, shape)
        if one is not None and one.is_possible(needed.margin):
            found.append(one)
        if len(found) == wanted:
            break
    return found


def _least(planted: PlantedFit, needed: Needed, test: HypothesisTest) -> float:
    """Return the least size of a planted effect that is named; infinity where none is."""
    size = min(max(float(np.sqrt(needed.statistic)) * test.size_scale, needed.margin), needed.most)
    below, factor = size, _missing(planted, needed, size)
    while factor > 1:
        below, size = size, size * float(np.clip(factor, _STEP, _LEAP))
        if size > needed.most:
            return _NEVER
        factor = _missing(planted, needed, size)
    while size > _STEP * below:
        middle = float(np.sqrt(below * size))
        if _missing(planted, needed, middle) > 1:
            below = middle
        else:
            size = middle
    return size


def _missing(planted: PlantedFit, needed: Needed, size: float) -> float:
    """Return by about which factor a size would have to be larger to pass every gate; 1 if none.

    Those gates first that take no further fit. What is impossible at one size is so at a larger.
    """
    if not planted.is_possible(size):
        return _NEVER
    if not _is_large(planted, planted.alone(size), needed, size):
        return _STEP
    fit = planted.expected(size)
    if fit.statistic < needed.statistic:
        # the statistic grows at most with the square of the size
        return max(float(np.sqrt(needed.statistic / max(fit.statistic, 1e-9))), _STEP)
    return 1.0 if _is_large(planted, fit, needed, size) else _STEP


def _is_large(planted: PlantedFit, fit: EffectFit, needed: Needed, size: float) -> bool:
    """Return whether the lower bound of what the base leaves is above the margin.

    Where it leaves little, what the form misses of the whole torque is as large as that.
    """
    left, low, _ = left_size(planted.step.precomputed, fit)
    reach = float(np.hypot(left - low, Z95 * FORM * size))
    return left - _ABOVE * reach > needed.margin
