"""Structure without a name that only the empirical term shows."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from frictioncli.diagnosis.empirical.estimate import Empirical
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.lack_of_fit import Structure, unnamed_structure
from frictioncli.diagnosis.search.step import Step
from frictioncli.diagnosis.search.understood import MOST_LEFT


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
    property of the joint is named, there is structure.

    Parameters
    ----------
    structure : Structure or None
        Structure that the test along every axis found. Where it changes along another quantity by a
        large share of its size, it is along both.
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
        return _with_second_axis(structure, empirical)
    if structure is not None or empirical is None:
        return structure
    if any(not one.fit.effect.measurement for one in causes):
        return None
    largest = empirical.parts[0]
    if empirical.p_value is None:
        return unnamed_structure(step, 0.0, alpha)
    return Structure(
        axes=largest.axes,
        channel="load" if largest.channel == "load" else "friction",
        p_value=empirical.p_value,
        statistic=empirical.statistic,
        size=largest.size,
        interval=largest.interval,
    )


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
