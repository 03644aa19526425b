r"""Structure that the runs seen may owe to chance, and that a new run has again.

The most likely axis of the runs seen has the p-value *a*, corrected for the number of axes. On the
new run that axis alone is asked for, and has the p-value *b*. Fisher's method [1]_ gives

.. math:: p = ab \, (1 - \ln ab) .

References
----------
.. [1] R. A. Fisher, Statistical Methods for Research Workers, 4th ed., Oliver and Boyd, 1932,
   section 21.1.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

from frictioncli.diagnosis.search.lack_of_fit import Structure, structures
from frictioncli.diagnosis.search.margin import channel_margin
from frictioncli.diagnosis.search.step import Step
from frictioncli.distributions import chi2_tail

_CHANCE = 0.05
"""Greatest p-value on the runs seen, and on the new one."""

_TOGETHER = 1e-4
"""Greatest p-value of both: no joint's days are quite independent."""


def recurring_structure(step: Step, again: Sequence[Structure], margin: float) -> Structure | None:
    """Return structure of the runs seen that a new run has along the same axis; None without any.

    Parameters
    ----------
    step : Step
        Base and causes on the runs seen.
    again : sequence of Structure
        The lack of fit along every axis of the new run.
    margin : float
        Smallest size worth a name. [N·m]
    """
    smallest = {one.channel: channel_margin(step.problem, one.channel, margin) for one in again}
    on_new_run = {
        (one.axes, one.channel): chi2_tail(one.statistic, 1) / 2
        for one in again
        if one.interval[0] > smallest[one.channel]
    }
    if min(on_new_run.values(), default=1.0) > _CHANCE:
        return None
    for one in structures(step):
        other = on_new_run.get((one.axes, one.channel), 1.0)
        both = max(one.p_value * other, 1e-300)
        together = both * (1 - math.log(both))
        is_likely = max(one.p_value, other) < _CHANCE and together < _TOGETHER
        if is_likely and one.interval[0] > smallest[one.channel]:
            return replace(one, p_value=together)
    return None
