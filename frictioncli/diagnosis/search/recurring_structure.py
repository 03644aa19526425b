r"""Structure that the runs seen may owe to chance, and that a new run has again.

The most likely axis of the runs seen has the p-value *a*, corrected for the number of axes. On the
new run that axis alone is asked for, and has the p-value *b*. Fisher's method [1]_ gives

.. math:: p = ab \, (1 - \ln ab) .

What is beyond doubt on the new run needs no more than to be as large on the runs seen: a drift that
is just no more than any joint's may be one that oscillates.

References
----------
.. [1] R. A. Fisher, Statistical Methods for Research Workers, 4th ed., Oliver and Boyd, 1932,
   section 21.1.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

from frictioncli.diagnosis.search.cause_selection import BEYOND_DOUBT
from frictioncli.diagnosis.search.lack_of_fit import structures
from frictioncli.diagnosis.search.margin import channel_margin
from frictioncli.diagnosis.search.step import Step
from frictioncli.diagnosis.search.structure import Structure
from frictioncli.distributions import chi2_tail

_CHANCE = 0.05
"""Greatest p-value on the runs seen, and on the new one."""

_TOGETHER = 1e-4
"""Greatest p-value of both: no joint's days are quite independent."""


def recurring_structure(step: Step, again: Sequence[Structure], margin: float) -> Structure | None:
    """Return structure of the runs seen that a new run has again; None without any.

    Both must have most of it along the same axis, or both a size of it that is surely above the
    margin where it is beyond doubt on the new run.

    Parameters
    ----------
    step : Step
        Base and causes on the runs seen.
    again : sequence of Structure
        The lack of fit along every axis of the new run, most likely first.
    margin : float
        Smallest size worth a name. [N·m]
    """
    other = again[0]
    least = channel_margin(step.problem, other.channel, margin)
    alone = chi2_tail(other.statistic, 1) / 2
    if alone > _CHANCE or other.interval[0] <= least:
        return None
    found = structures(step)
    if other.p_value < BEYOND_DOUBT:
        alike = [one for one in found if (one.axes, one.channel) == (other.axes, other.channel)]
        if alike and alike[0].interval[0] > least:
            return replace(alike[0], p_value=other.p_value)
    one = found[0]
    both = max(one.p_value * alone, 1e-300)
    together = both * (1 - math.log(both))
    is_same = (one.axes, one.channel) == (other.axes, other.channel)
    is_likely = one.p_value <= _CHANCE and together <= _TOGETHER
    if not is_same or not is_likely or one.interval[0] <= least:
        return None
    return replace(one, p_value=together)
