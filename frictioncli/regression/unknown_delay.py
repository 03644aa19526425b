r"""Errors of a regression whose torque may be late by a time that the log does not tell.

A delay that is not told from zero is left out, and is zero only to within its error. With the
parameters :math:`\theta` of the fit without it, and :math:`\theta_d` of one with a delay *d*, the
second moments of the error are

.. math:: \Sigma = \Sigma_d
    + (\theta - \theta_d)(\theta - \theta_d)^\mathsf{T} \frac{d_r^2 + \sigma_r^2}{d^2 + \sigma^2},

the covariance of the fit with the delay, and the square of what leaving it out changes. The last
factor is 1 but where friction of other kinds may be taken for the delay: there :math:`d_r` is the
delay beside it, and :math:`\sigma, \sigma_r` are the errors of both. In a slow sweep of the
frequency a delay of 8 ms changes the inertia by 2 to 3 %, many times its error in the fit without
it.
"""

from dataclasses import replace

import numpy as np

from frictioncli.regression.determination import JointRegression
from frictioncli.regression.estimate import RegressionEstimate
from frictioncli.regression.identification import identify, some_equations
from frictioncli.regression.zero_load_friction import friction_at


def allowing_for_delay(
    found: JointRegression,
    late: RegressionEstimate | None,
    beside: RegressionEstimate | None = None,
) -> JointRegression:
    """Return a regression without a delay, with errors that allow for one.

    Parameters
    ----------
    found : JointRegression
        The regression.
    late : RegressionEstimate or None
        A fit with the delay; none where the delay is told, or no fit has one.
    beside : RegressionEstimate, optional
        A fit with the delay beside friction of other kinds, where that is not told from it.
    """
    estimate = found.estimate
    if late is None or estimate.terms.delay:
        return found
    terms = replace(estimate.terms, delay=True)
    if late.terms != terms:
        # what was left out since counts as part of another parameter
        late = identify(some_equations(found.equations), terms)
    own = [late.names.index(name) for name in estimate.names]
    change = np.array(
        [value - late.parameters[name] for name, value in estimate.parameters.items()]
    )
    if beside is not None:
        size, own_size = (np.hypot(one.delay, one.deviation("delay")) for one in (beside, late))
        change *= size / own_size
    covariance = late.covariance[np.ix_(own, own)] + np.outer(change, change)
    wider = replace(estimate, covariance=covariance, blocks=min(estimate.blocks, late.blocks))
    return replace(found, estimate=wider, friction=friction_at(found.equations, wider, found.sign))
