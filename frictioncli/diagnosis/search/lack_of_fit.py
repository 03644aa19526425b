r"""Lack of fit along every axis of the experiment, whatever the cause.

Along each axis, or two of them, the torque gets one more random function beside base, accepted
effects, noise and the discrepancy that any model has (:mod:`.random_function`): harmonics of the
angle, levels of speed, cosines of temperature, load and time, and products. Twice the logarithm of
the restricted likelihood that its best amplitude gains is half the time 0, else a chi-squared
variable of one degree of freedom, where nothing is there [1]_. Along the time the drift itself is
such a function: it is structure where it is, or surely was, more than any joint has. They name no
cause.

References
----------
.. [1] S. G. Self and K.-Y. Liang, "Asymptotic properties of maximum likelihood estimators and
   likelihood ratio tests under nonstandard conditions," J. Am. Stat. Assoc. 82(398), 1987,
   doi:10.1080/01621459.1987.10478472.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.fit.mixed_model import Components
from frictioncli.diagnosis.noise.discrepancy_functions import SPEED_RIPPLE
from frictioncli.diagnosis.search.axis_columns import (
    angle_and_speed,
    axis_columns,
    can_be_judged,
    cosines,
)
from frictioncli.diagnosis.search.carried_load import most_likely_constant
from frictioncli.diagnosis.search.drift_beyond import drift_beyond
from frictioncli.diagnosis.search.random_function import Known, RandomFunction
from frictioncli.diagnosis.search.step import Step
from frictioncli.diagnosis.search.structure import SIGNIFICANT, Structure
from frictioncli.distributions import chi2_tail
from frictioncli.effects.base import CHANNELS, Channel

_DRIFT = 0.015
"""Greatest RMS of a drift that is no structure, relative to the mean friction."""

_PINNED = 1e-3
"""Spread of the amplitudes of the discrepancy: they stay as they are expected."""

TOLD_BY_ANGLE = 20.0
"""By so much structure along the load must be likelier than another: with one payload and pose the
load is a function of the angle, and what goes with it goes with the angle, too."""

_Place = tuple[tuple[str, ...], Channel]
"""Axes and channel."""

_Judged = tuple[RandomFunction, Array]
"""A random function and its columns."""

_Structures = tuple[tuple[Structure, ...], dict[Structure, Array | None]]
"""Structures, most likely first, and the columns of some; a drift has none."""

_LOAD: _Place = (("load",), "friction")
_ANGLE: _Place = (("position",), "friction")
_LOAD_AND_SPEED: _Place = (("load", "speed"), "friction")
_ANGLE_AND_SPEED: _Place = (("position", "speed"), "friction")


def structures(step: Step) -> tuple[Structure, ...]:
    """Return the lack of fit along every axis, most likely first.

    The discrepancy counts with the amplitude that is expected of it, so that what is larger than
    any model's small errors stands out.

    Parameters
    ----------
    step : Step
        Base and accepted effects.
    """
    return _all_structures(step)[0]


def beside_others(
    structure: Structure, others: Sequence[Structure], step: Step
) -> Structure | None:
    """Return structure as it is beside other structure of the same step; None where nothing is.

    What only imitates another is not significant beside it. A drift stays as it is.

    Parameters
    ----------
    structure : Structure
        One of :func:`structures` that is significant.
    others : sequence of Structure
        Others of them that are.
    step : Step
        Base and accepted effects.
    """
    key = beside_others, structure, tuple(others)
    return step.once(key, lambda: _beside_others(structure, others, step))


def _beside_others(
    structure: Structure, others: Sequence[Structure], step: Step
) -> Structure | None:
    found, columns_of = _all_structures(step)
    columns = columns_of[structure]
    if columns is None:
        return structure
    known = _known(step)
    for other in others:
        beside = columns_of[other]
        channel = other.channel
        added = known.with_any_drift(channel) if beside is None else known.beside(channel, beside)
        known = added or known
    left = known.judged(structure.channel, columns)
    if left is None:
        return None
    return _structure((structure.axes, structure.channel), left, _p_value(left, len(found)))


def _known(step: Step) -> Known:
    """Return what is judged along the axes beside base and accepted effects alone."""
    return step.once(_known, lambda: Known.of(step, expected_components(step)))


def _all_structures(step: Step) -> _Structures:
    """Return the lack of fit along every axis, and the columns of what is significant."""
    return step.once(_all_structures, lambda: _tested(step))


def _tested(step: Step) -> _Structures:
    known = _known(step)
    of_axes = _along_axes(step, known)
    tests = len(of_axes) + len(CHANNELS)
    found: list[Structure] = []
    columns_of: dict[Structure, Array | None] = {}
    for place, (one, columns) in of_axes.items():
        found.append(_structure(place, one, _p_value(one, tests)))
        if found[-1].p_value < SIGNIFICANT:
            columns_of[found[-1]] = columns
    for number, channel in enumerate(CHANNELS):
        drift = drift_beyond(step, known.components, known.fits[0], number)
        p_value = min(_p_value(drift.function, tests), tests * drift.chance)
        found.append(_structure((("time",), channel), drift.function, p_value))
        columns_of[found[-1]] = None

    def behind(one: Structure) -> float:
        return -one.statistic + TOLD_BY_ANGLE * (one.axes[0] == "load")

    return tuple(sorted(found, key=behind)), columns_of


def _along_axes(step: Step, known: Known) -> dict[_Place, _Judged]:
    """Return what is there along each axis, with the columns that show it."""
    problem = step.problem
    found: dict[_Place, _Judged] = {}

    def judge(place: _Place, columns: Array) -> _Judged | None:
        one = known.judged(place[1], columns)
        return None if one is None else (one, columns)

    for place, columns in axis_columns(problem).items():
        one = judge(place, columns) if can_be_judged(problem, columns) else None
        if one is not None:
            found[place] = one
    if _LOAD in found and _ANGLE in found:
        load, angle = found[_LOAD][0], found[_ANGLE][0]
        if angle.statistic > max(TOLD_BY_ANGLE, load.statistic - TOLD_BY_ANGLE):
            found[_LOAD] = _along_carried(step, known, found[_LOAD])
    if _LOAD_AND_SPEED in found and _ANGLE_AND_SPEED in found:
        load, angle = found[_LOAD_AND_SPEED][0], found[_ANGLE_AND_SPEED][0]
        columns = angle_and_speed(problem)
        if load.statistic > angle.statistic + TOLD_BY_ANGLE and can_be_judged(problem, columns):
            finer = judge(_ANGLE_AND_SPEED, columns)
            if finer is not None and finer[0].statistic > load.statistic - TOLD_BY_ANGLE:
                # more functions may cancel the discrepancy's: the size is that of the fewer
                found[_ANGLE_AND_SPEED] = replace(load, statistic=finer[0].statistic), columns
    return found


def _along_carried(step: Step, known: Known, plain: _Judged) -> _Judged:
    """Return friction along the load of the gear, if a constant in it is likely, else as it is."""
    problem = step.problem
    columns = plain[1]
    price = float(np.log(len(problem.layout.time)))

    def carried(constant: float) -> _Judged:
        own = cosines(np.abs(problem.table.load - constant), columns.shape[1])
        one = known.judged("friction", own)
        return plain if one is None else (replace(one, statistic=one.statistic - price), own)

    constant = most_likely_constant(problem, lambda one: carried(one)[0].statistic)
    return max(plain, carried(constant), key=lambda one: one[0].statistic)


def _structure(place: _Place, found: RandomFunction, p_value: float) -> Structure:
    axes, channel = place
    return Structure(
        axes=axes,
        channel=channel,
        p_value=p_value,
        statistic=max(found.statistic, 0.0),
        size=found.size,
        interval=found.interval,
    )


def _p_value(found: RandomFunction, tests: int) -> float:
    """Return the probability that noise explains as much along one of so many axes."""
    return min(1.0, tests * chi2_tail(found.statistic, 1) / 2)


def expected_components(step: Step) -> Components:
    """Return the variance components with the discrepancy and the drift that any joint has.

    A speed that is not constant is no structure of the joint, however much it is.

    Parameters
    ----------
    step : Step
        Base and accepted effects.
    """
    components = step.components
    most = _DRIFT * float(np.mean(np.abs(step.problem.friction)))
    functions = step.precomputed.discrepancy.components
    free = np.array([one.axes == SPEED_RIPPLE for one in functions], bool)
    spread = np.where(free, components.spread, _PINNED)
    return replace(components, spread=spread, most_drift=(most**2, most**2))
