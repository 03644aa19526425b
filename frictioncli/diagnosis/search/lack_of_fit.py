r"""Lack of fit along every axis of the experiment, whatever the cause.

Along each axis, or two of them, the torque gets one more random function *f* beside base, accepted
effects, noise and the discrepancy that any model has,

.. math:: f = \omega \sum_k s_k \gamma_k c_k , \quad \gamma_k \sim N(0, 1) ,

with columns :math:`c_k` of that axis: harmonics of the angle, levels of speed, cosines of
temperature, load and time, and products. Twice the logarithm of the restricted likelihood that the
best amplitude :math:`\omega` gains is half the time 0, else a chi-squared variable of one degree
of freedom, where nothing is there [1]_. Along the time the drift itself is such a function: it is
structure where it is, or surely was, more than any joint has. They name no cause.

References
----------
.. [1] S. G. Self and K.-Y. Liang, "Asymptotic properties of maximum likelihood estimators and
   likelihood ratio tests under nonstandard conditions," J. Am. Stat. Assoc. 82(398), 1987,
   doi:10.1080/01621459.1987.10478472.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.added_function import likely_amplitudes
from frictioncli.diagnosis.fit.columns import reduced
from frictioncli.diagnosis.fit.left_by_base import products_left_by, span_of
from frictioncli.diagnosis.fit.mixed_model import Components, MixedFit, evaluate
from frictioncli.diagnosis.fit.transformed_columns import Part
from frictioncli.diagnosis.fit.variance_components import fit_variances
from frictioncli.diagnosis.noise.discrepancy_functions import SPEED_RIPPLE
from frictioncli.diagnosis.search.axis_columns import (
    angle_and_speed,
    axis_columns,
    can_be_judged,
    cosines,
)
from frictioncli.diagnosis.search.carried_load import most_likely_constant
from frictioncli.diagnosis.search.drift_beyond import drift_beyond
from frictioncli.diagnosis.search.margin import channel_margin
from frictioncli.diagnosis.search.realised_size import realised
from frictioncli.diagnosis.search.step import Step
from frictioncli.distributions import chi2_tail
from frictioncli.effects.base import CHANNELS, Basis, Channel

_DRIFT = 0.015
"""Greatest RMS of a drift that is no structure, relative to the mean friction."""

_PINNED = 1e-3
"""Spread of the amplitudes of the discrepancy: they stay as they are expected."""

_SIGNIFICANT = 5e-3
"""Greatest p-value of structure that no effect explains."""

_ROUNDED = 1e-9
"""Share of its squares below which what the base leaves of a function is rounding."""

_TOLD_BY_ANGLE = 10.0
"""By so much structure along the load must be likelier than another: with one payload and pose the
load is a function of the angle, and what goes with it goes with the angle, too."""

_LOAD: tuple[tuple[str, ...], Channel] = (("load",), "friction")
_LOAD_AND_SPEED: tuple[tuple[str, ...], Channel] = (("load", "speed"), "friction")
_ANGLE_AND_SPEED: tuple[tuple[str, ...], Channel] = (("position", "speed"), "friction")

_Found = tuple[tuple[str, ...], Channel, float, float, tuple[float, float]]
"""Axes, channel, twice the log likelihood ratio, size [N·m] and its interval."""

_NO_DOUBT = 1e-12
"""P-value below which there is no doubt that structure is there."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Structure:
    """Lack of fit along one axis of the experiment.

    Attributes
    ----------
    axes : tuple of str
        The axis, or the two axes, along which it shows: ``position``, ``speed``, ``temperature``,
        ``time`` or ``load``.
    channel : {"friction", "load"}
        The channel.
    p_value : float
        Probability that noise explains as much, corrected for the number of axes (Bonferroni).
    statistic : float
        Twice the log likelihood ratio to base and accepted effects.
    size : float
        RMS of what base and effects leave of it. [N·m]
    interval : (float, float)
        95 % interval of that. [N·m]
    or_load : bool
        Whether structure along the angle is about as likely along the load, which differs from it.
    only_on : str
        The only run that has it, where that was kept out of the diagnosis; else empty.
    """

    axes: tuple[str, ...]
    channel: Channel
    p_value: float
    statistic: float
    size: float
    interval: tuple[float, float]
    or_load: bool = False
    only_on: str = ""

    @property
    def axis(self) -> str:
        """The axes in words."""
        return " and ".join(self.axes).replace("position", "angle")


def unnamed_structure(
    step: Step,
    margin: float,
    alpha: float,
    is_known: Callable[[Structure], bool] = lambda _: False,
) -> Structure | None:
    """Return the most significant structure beside the causes that is above the margin.

    Surely above it, or most probably where there is no doubt that it is there.

    Parameters
    ----------
    step : Step
        Base and accepted effects.
    margin, alpha : float
        Smallest size worth a name [N·m] and significance level.
    is_known : callable, optional
        Whether structure belongs to something that is known, and does not count.
    """
    return first_above(structures(step), step.problem, margin, alpha, is_known)


def first_above(
    found: Sequence[Structure],
    problem: Problem,
    margin: float,
    alpha: float,
    is_known: Callable[[Structure], bool] = lambda _: False,
) -> Structure | None:
    """Return the most likely structure above the margin, if any is significant and surely above it.

    Where one is surely above the margin, that much is left; along which axis, the likeliest says.

    Parameters
    ----------
    found : sequence of Structure
        The lack of fit along every axis, most likely first.
    problem : Problem
        The rows.
    margin, alpha, is_known
        As of :func:`unnamed_structure`.
    """
    significant = [
        one for one in found if one.p_value < min(_SIGNIFICANT, alpha) and not is_known(one)
    ]
    above = [one for one in significant if one.size > channel_margin(problem, one.channel, margin)]
    for one in above:
        least = one.size if one.p_value < _NO_DOUBT else one.interval[0]
        if least > channel_margin(problem, one.channel, margin):
            return replace(above[0], or_load=_may_be_of_load(above[0], found))
    return None


def _may_be_of_load(one: Structure, found: Sequence[Structure]) -> bool:
    """Return whether structure along the angle is about as likely along the load."""
    return one.axes[0] == "position" and any(
        two.axes == ("load", *one.axes[1:])
        and two.channel == one.channel
        and two.statistic > one.statistic - _TOLD_BY_ANGLE
        for two in found
    )


def structures(step: Step) -> tuple[Structure, ...]:
    """Return the lack of fit along every axis, most likely first.

    The discrepancy counts with the amplitude that is expected of it, so that what is larger than
    any model's small errors stands out.

    Parameters
    ----------
    step : Step
        Base and accepted effects.
    """
    return step.once(structures, lambda: _structures(step))


def _structures(step: Step) -> tuple[Structure, ...]:
    problem = step.problem
    axes = {
        place: columns
        for place, columns in axis_columns(problem).items()
        if can_be_judged(problem, columns)
    }
    expected = expected_components(step)
    known = step.precomputed.start
    starts = replace(step.fit.variances, amplitude=known.amplitude), known
    null = fit_variances(expected, step.products, step.known, *starts)
    quiet = evaluate(expected, step.products, step.known, known)
    accepted = [problem.basis(one.effect, one.shape) for one in step.accepted]
    span = span_of(problem, [*step.precomputed.measurement, *accepted])

    def judged(names: tuple[str, ...], channel: Channel, columns: Array) -> _Found | None:
        zeros = np.zeros_like(columns)
        basis = Basis(columns, zeros) if channel == "friction" else Basis(zeros, columns)
        left = products_left_by(span, basis)
        squares = float(np.trace(left))
        if squares <= _ROUNDED * float(np.sum(np.square(columns))):
            return None
        scale = float(np.sqrt(len(columns) / squares))
        fit = _beside_function(step, expected, basis, scale, (null, quiet))
        place = slice(step.known, step.known + columns.shape[1])
        size, interval = realised(
            scale**2 * left / len(columns),
            fit.coefficients[place],
            fit.covariance_of(place),
        )
        return names, channel, null.objective - fit.objective, size, interval

    by_place = {place: judged(*place, columns) for place, columns in axes.items()}
    load, angle = (by_place.get(((name,), "friction")) for name in ("load", "position"))
    least = _TOLD_BY_ANGLE if load is None else max(_TOLD_BY_ANGLE, load[2] - _TOLD_BY_ANGLE)
    if load is not None and angle is not None and angle[2] > least:
        count = axes[_LOAD].shape[1]
        price = float(np.log(len(problem.layout.time)))

        def carried(constant: float) -> _Found:
            one = judged(*_LOAD, cosines(np.abs(problem.table.load - constant), count))
            return load if one is None else (*one[:2], one[2] - price, *one[3:])

        constant = most_likely_constant(problem, lambda one: carried(one)[2])
        by_place[_LOAD] = max(load, carried(constant), key=lambda one: one[2])
    of_load, of_angle = (by_place.get(one) for one in (_LOAD_AND_SPEED, _ANGLE_AND_SPEED))
    if of_load is not None and of_angle is not None and of_load[2] > of_angle[2] + _TOLD_BY_ANGLE:
        columns = angle_and_speed(problem)
        enough = can_be_judged(problem, columns)
        finer = judged(*_ANGLE_AND_SPEED, columns) if enough else None
        if finer is not None and finer[2] > of_load[2] - _TOLD_BY_ANGLE:
            # more functions may cancel the discrepancy's: the size is that of the fewer
            by_place[_ANGLE_AND_SPEED] = (*finer[:3], *of_load[3:])
    found = [(one, 1.0) for one in by_place.values() if one]
    for number, channel in enumerate(CHANNELS):
        drift = drift_beyond(step, expected, null, number)
        found.append(
            ((("time",), channel, drift.statistic, drift.size, drift.interval), drift.chance)
        )
    every = (
        Structure(
            axes=names,
            channel=channel,
            p_value=min(1.0, len(found) * min(chi2_tail(statistic, 1) / 2, chance)),
            statistic=max(statistic, 0.0),
            size=size,
            interval=interval,
        )
        for (names, channel, statistic, size, interval), chance in found
    )

    def behind(one: Structure) -> float:
        return -one.statistic + _TOLD_BY_ANGLE * (one.axes[0] == "load")

    return tuple(sorted(every, key=behind))


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


def _beside_function(
    step: Step,
    expected: Components,
    basis: Basis,
    scale: float,
    nulls: tuple[MixedFit, ...],
) -> MixedFit:
    """Return the fit with one more random function, with the noise that suits it best.

    It starts from fits without the function, with an amplitude that is likely beside each.
    """
    layout = step.problem.layout
    columns = reduced(layout, scale * basis.friction, scale * basis.load)
    products = step.products.beside([Part(columns, step.precomputed.noises)])
    place = slice(step.known, step.known + columns.count)
    amplitude = float(expected.prior[0]) if len(expected.prior) else _unit_amplitude(step)
    components = expected.beside_function(place, amplitude)
    likely = likely_amplitudes(components, products, nulls)
    starts = (
        replace(one.variances, amplitude=np.append(one.variances.amplitude, own))
        for one, own in zip(nulls, likely, strict=True)
    )
    return fit_variances(components, products, place.stop, *starts)


def _unit_amplitude(step: Step) -> float:
    """Return the logarithm of the noise of a pair, where no discrepancy is expected."""
    return float(np.log(step.precomputed.start.between[0]) / 2)
