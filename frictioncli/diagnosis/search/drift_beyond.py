"""Drift beyond what any joint has: of its process, or of what it surely was on these runs."""

from dataclasses import dataclass

import numpy as np

from frictioncli.diagnosis.fit.left_by_base import Z95
from frictioncli.diagnosis.fit.mixed_model import Components, MixedFit
from frictioncli.diagnosis.fit.variance_components import fit_variances
from frictioncli.diagnosis.search.random_function import RandomFunction
from frictioncli.diagnosis.search.realised_size import realised_drift
from frictioncli.diagnosis.search.step import Step
from frictioncli.distributions import chi2_tail

_LEAST_CHANCE = 1e-6
"""Least probability of a size beyond what it may be, which is a rule of experience."""


@dataclass(frozen=True, slots=True)
class DriftBeyond:
    """What the drift in one channel explains beyond what any joint has.

    Attributes
    ----------
    function : RandomFunction
        What a larger drift gains, and the size of it.
    chance : float
        Probability that on these runs it was no larger than any joint's.
    """

    function: RandomFunction
    chance: float


def drift_beyond(step: Step, expected: Components, null: MixedFit, number: int) -> DriftBeyond:
    """Return what the drift in one channel explains beyond what any joint has.

    Few pairs may scatter as if they drifted: that there is a drift must be sure as well.

    Parameters
    ----------
    step : Step
        Base and accepted effects.
    expected : Components
        Variance components with the drift that any joint has.
    null : MixedFit
        Their fit.
    number : int
        0 for friction, 1 for load.
    """
    products, known = step.products, step.known
    fit = fit_variances(
        expected.with_most_drift(number, np.inf),
        products,
        known,
        null.variances,
        step.fit.variances,
    )
    size, interval = realised_drift(step, fit, number)
    chance = chance_of_less(size, interval, float(np.sqrt(expected.most_drift[number])))
    if chance < 1.0:
        without = fit_variances(
            expected.with_most_drift(number, 0.0), products, known, step.precomputed.start
        )
        # of strength and correlation time
        chance = max(chance, chi2_tail(without.objective - fit.objective, 2))
    return DriftBeyond(RandomFunction(null.objective - fit.objective, size, interval), chance)


def chance_of_less(size: float, interval: tuple[float, float], most: float) -> float:
    """Return the probability that a size is no more than it may be; 1 where that is not unlikely.

    Likelihoods do not tell a drift that oscillates from one that is slow and now and then as large.
    What it did on these runs is known all the same.

    Parameters
    ----------
    size, interval : float, (float, float)
        The size and its 95 % interval. [N·m]
    most : float
        What it may be. [N·m]
    """
    if interval[0] <= most:
        return 1.0
    chance = chi2_tail((Z95 * (size - most) / (size - interval[0])) ** 2, 1) / 2
    return max(chance, _LEAST_CHANCE)
