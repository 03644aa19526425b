"""Whether data can show a form: its width and height are measured, and friction stays above zero.

The height of a peak that is narrower than measured values are apart is whatever its place between
them makes it. One with a standard deviation of half an angle bin has 0.6 of its height or more at
the centre of a bin, wherever it is.
"""

import numpy as np

from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.empirical.form_columns import LATE_BUMPS, UNEVEN_BUMP
from frictioncli.diagnosis.empirical.term import FormFunction

_AT_ONE_WIDTH = float(np.exp(-1 / 2))
"""Share of the height of a peak one standard deviation from its centre."""


def is_resolved(form: FormFunction, problem: Problem) -> bool:
    """Return whether rows tell width and height of a form, and it leaves no friction below zero.

    Parameters
    ----------
    form : FormFunction
        The form with its parameters.
    problem : Problem
        The rows.
    """
    added, peak = form.at(problem.table), form.coefficients.get("peak", 0.0)
    if form.kind == UNEVEN_BUMP:
        peak = sum(form.coefficients.values()) / 2
    torque = added.friction if form.channel == "friction" else added.load
    if np.max(np.abs(torque)) < _AT_ONE_WIDTH * abs(peak):
        return False
    if form.kind in ("peak", *LATE_BUMPS) and "position" in form.axes:
        bins = np.diff(problem.table.angles)
        if form.shape["width"] < np.min(bins) / 2:
            return False
    lowest = min(float(np.min(torque)), peak)
    return form.channel == "load" or lowest >= -float(np.mean(np.abs(problem.friction)))
