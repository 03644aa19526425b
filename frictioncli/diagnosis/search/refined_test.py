r"""The test of an effect at the shape that fits it best, found between those of the grid.

A grid may hold no shape near that of an effect: of a change with one pair on the wrong side, a
small part of the evidence is left where pairs scatter little. An effect is therefore tested twice,
at the shapes of the grid and at all shapes to which the search may go from there, and the smaller
p-value counts. The second one is multiplied by ten, so that both together exceed a significance
level by a tenth of it at most.

The number of shapes between those of a grid is bounded by two per parameter. Of a change with *m*
moments, each between two of *n* pairs, all :math:`\binom{n-1}{m}` histories are counted
(Bonferroni), and :math:`2^m` times those: the search chooses *m*, too.
"""

from dataclasses import replace

import numpy as np
from scipy.special import comb

from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.hypotheses import EffectFit, HypothesisTest
from frictioncli.effects.history import stretches
from frictioncli.effects.pair_series import measured_share

_SECOND = 10.0
"""Factor of the p-value of the second test."""


def refined_test(
    problem: Problem, test: HypothesisTest, fit: EffectFit, hypotheses: int
) -> HypothesisTest:
    """Return the test of an effect after its shape has been refined off the grid.

    Parameters
    ----------
    problem : Problem
        The rows.
    test : HypothesisTest
        Its test at the shapes of the grid.
    fit : EffectFit
        The effect at its refined shape.
    hypotheses : int
        Number of hypotheses tried.
    """
    tried = replace(test.null, shapes=_shapes(problem, test, fit))
    p_value = _SECOND * hypotheses * tried.p_value(fit.statistic)
    return replace(
        test,
        shape=fit.shape,
        coefficients=fit.coefficients,
        covariance=fit.covariance,
        statistic=fit.statistic,
        variances=fit.variances,
        p_value=min(test.p_value, p_value),
        log_bayes_factor=test.refined_log_bayes_factor(fit),
    )


def _shapes(problem: Problem, test: HypothesisTest, fit: EffectFit) -> float:
    """Return the number of shapes to which the search for the best one may go."""
    if fit.effect.moments is None:
        return float(test.null.shapes * 2.0 ** len(fit.effect.shape))
    share = np.unique(measured_share(problem.all_runs)[problem.rows])
    ends = {end for stretch in stretches(fit.shape) for end in stretch}
    number = sum(share[0] < end <= share[-1] for end in ends)
    return float(2.0**number * comb(len(share) - 1, number))
