"""Structure without a name that only the empirical term shows."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from frictioncli.diagnosis.empirical.estimate import Empirical
from frictioncli.diagnosis.fit.gain import Gain
from frictioncli.diagnosis.fit.left_by_base import Z95
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.cause_selection import BEYOND_DOUBT
from frictioncli.diagnosis.search.step import Step
from frictioncli.diagnosis.search.structure import Structure
from frictioncli.diagnosis.search.structure_above_margin import unnamed_structure
from frictioncli.diagnosis.search.understood import MOST_LEFT, axes_told
from frictioncli.distributions import chi2_tail


def unexplained(
    structure: Structure | None,
    causes: Sequence[Cause],
    empirical: Empirical | None,
    step: Step,
    alpha: float,
) -> Structure | None:
    """Return the structure that no effect explains, also where its test along an axis found none.

    A form has fewer parameters than the functions of that test, and an effect of the measurement
    that is not corrected may hold a part of the structure: where a term is worth using although no
    property of the joint is named that shows along the same axis, there is structure. Smooth
    functions of a term without a form are structure where they predict a new run beyond doubt: the
    test along an axis takes what varies little more than a discrepancy for one, from the runs seen
    alone. Beside a named property of the joint that alone counts.

    Parameters
    ----------
    structure : Structure or None
        Structure that the test along every axis found. Where it changes along another quantity by a
        large share of its size, it is along both. Along time, which no term knows, it is along what
        predicts it on a new run beyond doubt.
    causes : sequence of Cause
        Causes that are named.
    empirical : Empirical or None
        A term that is worth using.
    step : Step
        Base and causes.
    alpha : float
        Significance level.
    """
    if structure is not None and empirical is not None:
        predicting = _predicting(empirical) if structure.axes == ("time",) else None
        if predicting is not None and predicting.channel == structure.channel:
            return predicting
        return _with_second_axis(structure, empirical)
    if structure is not None or empirical is None:
        return structure
    named = [one.fit.effect for one in causes if not one.fit.effect.measurement]
    if named:
        largest = axes_told(empirical.parts[0].axes)
        if not all(largest.isdisjoint(axes_told(one.needs)) for one in named):
            return None
        return _predicting(empirical)
    if empirical.p_value is not None:
        return _of_largest(empirical, empirical.p_value, empirical.statistic)
    along = unnamed_structure(step, 0.0, alpha)
    predicting = _predicting(empirical)
    if along is None:
        return predicting
    as_large = _as_large_as(along, empirical)
    # along another axis than most of what the term predicts it is no more than a part of that
    is_part = predicting is not None and as_large.size < MOST_LEFT * predicting.size
    return predicting if is_part else as_large


def _predicting(empirical: Empirical) -> Structure | None:
    """Return the largest part of a term as structure, if it predicts a new run beyond doubt."""
    if empirical.gain.basis != "new_run":
        return None
    statistic = _statistic(empirical.gain)
    p_value = chi2_tail(statistic, 1)
    return _of_largest(empirical, p_value, statistic) if p_value < BEYOND_DOUBT else None


def _of_largest(empirical: Empirical, p_value: float, statistic: float) -> Structure:
    """Return the largest part of a term as structure."""
    largest = empirical.parts[0]
    return Structure(
        axes=largest.axes,
        channel="load" if largest.channel == "load" else "friction",
        p_value=p_value,
        statistic=statistic,
        size=largest.size,
        interval=largest.interval,
    )


def _as_large_as(structure: Structure, empirical: Empirical) -> Structure:
    """Return structure with the size that a term has along the same axes, if it has them.

    The test along an axis takes off what any model's small errors may be of it: that may be most of
    what is known to be there.
    """
    for part in empirical.parts:
        if (part.axes, part.channel) == (structure.axes, structure.channel):
            return replace(structure, size=part.size, interval=part.interval)
    return structure


def _statistic(gain: Gain) -> float:
    """Return the square of a gain in standard errors."""
    error = (gain.interval[1] - gain.interval[0]) / (2 * Z95)
    return float(np.square(gain.reduction / max(error, 1e-300)))


def _with_second_axis(structure: Structure, empirical: Empirical) -> Structure:
    """Return structure along one axis with the one along which it changes, if it does.

    What fades with speed differs between speeds, and shows along the angle besides: the test along
    an axis sees its mean. Without a form, the term has both as functions of their own.
    """
    sizes = {
        one.axes: one.size
        for one in empirical.parts
        if one.form is None and one.channel == structure.channel
    }
    own = sizes.pop(structure.axes, np.inf)
    pairs = {axes: size for axes, size in sizes.items() if set(axes) > set(structure.axes)}
    second = max(pairs, key=lambda axes: pairs[axes], default=structure.axes)
    return (
        replace(structure, axes=second) if pairs.get(second, 0.0) > MOST_LEFT * own else structure
    )
