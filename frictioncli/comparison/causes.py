"""Attribution of a change between runs to effects of the catalogue.

Over months each run is one point. An effect that changes friction from run to run has time courses
over the runs. They are compared by the marginal likelihood of the levels, averaged over the time
courses of each effect; probabilities and credible set follow as in ``diagnose``. The load torque is
the second channel: if it changed by the same share as friction, the scale of the logged torque
changed; if it changed alone, the payload did.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.comparison.day_to_day import LevelEstimate, LevelModel
from frictioncli.diagnosis.noise.significance import credible_set, posterior_probabilities

_RUN_IN_RATES = (1.0, 2.0, 4.0)
"""Rates of running in, as multiples of one over the whole time."""

_ALPHA = 0.05
"""Probability of a false alarm per comparison."""

_CLAIMS = {
    (
        "drift",
        "friction",
    ): "Friction changed steadily over the runs, as by wear or ageing grease.",
    ("step_change", "friction"): "Friction changed once, between two runs, and stayed.",
    ("run_in", "friction"): "Friction fell fast at first and then ever slower, as in running in.",
    ("payload_change", "load"): "The load torque changed once, as with another payload or tool.",
    ("drift", "load"): "The load torque changed steadily from run to run.",
    ("torque_constant", "load"): (
        "Friction and load torque changed by the same percentage: the scale of the logged"
        " torque changed."
    ),
}
"""Claim by effect and channel."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TimeCourse:
    """Time course of a change over the runs.

    Attributes
    ----------
    effect : str
        Name of the effect in the catalogue.
    values : ndarray, shape (runs,)
        Share of the change that has happened: 0 at the first run, 1 at the last.
    change_point : int or None
        Number of the first run after a step change.
    only_decreasing : bool
        Whether friction can only decrease in this way.
    """

    effect: str
    values: Array
    change_point: int | None = None
    only_decreasing: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class CauseOfChange:
    """Cause of a change: one effect, or several that these runs cannot distinguish.

    Attributes
    ----------
    effects : tuple of str
        Credible set, most probable first.
    probabilities : dict of str to float
        Probabilities of all effects that were compared.
    channel : {"friction", "load"}
        Channel that changed.
    change : LevelEstimate
        Change from the first run to the last, by the most probable time course. [%]
    change_point : int or None
        Number of the first run after the change, if it is a step change.
    """

    effects: tuple[str, ...]
    probabilities: dict[str, float]
    channel: str
    change: LevelEstimate
    change_point: int | None

    @property
    def claim(self) -> str:
        """What the most probable effect means for the runs."""
        return _CLAIMS[self.effects[0], self.channel]


def time_courses(time: Array) -> Iterator[TimeCourse]:
    """Yield the time courses that a change may have.

    Parameters
    ----------
    time : ndarray, shape (runs,)
        Time of each run, increasing. [any unit]

    Yields
    ------
    TimeCourse
        Drift, each possible step change, and running in at several rates.

    Examples
    --------
    >>> [course.effect for course in time_courses(np.array([0.0, 7.0]))]
    ['drift', 'step_change', 'run_in', 'run_in', 'run_in']
    """
    share = (time - time[0]) / (time[-1] - time[0])
    yield TimeCourse(effect="drift", values=share)
    for number in range(1, len(time)):
        after = (np.arange(len(time)) >= number).astype(float)
        yield TimeCourse(effect="step_change", values=after, change_point=number)
    for rate in _RUN_IN_RATES:
        values = np.expm1(-rate * share) / np.expm1(-rate)
        yield TimeCourse(effect="run_in", values=values, only_decreasing=True)


def cause_of(levels: Array, model: LevelModel, time: Array, channel: str) -> CauseOfChange:
    """Return the most credible cause of a change of levels.

    Parameters
    ----------
    levels : ndarray, shape (runs,)
        Levels of friction or of the load torque. [%]
    model : LevelModel
        Covariance of levels without a change.
    time : ndarray, shape (runs,)
        Time of each run, increasing.
    channel : {"friction", "load"}
        A step of the load torque is a change of payload.

    Returns
    -------
    CauseOfChange
        Credible set of effects and the change.
    """
    fits: dict[str, list[tuple[float, TimeCourse, LevelEstimate]]] = {}
    for course in time_courses(time):
        fit = model.fit(levels, np.column_stack([np.ones_like(time), course.values]))
        change = fit.estimate(np.array([0.0, 1.0]))
        if course.only_decreasing and (change.value >= 0 or channel == "load"):
            continue
        name = "payload_change" if channel == "load" and course.change_point else course.effect
        fits.setdefault(name, []).append((fit.log_marginal_likelihood, course, change))
    evidence = {
        name: float(np.logaddexp.reduce([one for one, _, _ in own]) - np.log(len(own)))
        for name, own in fits.items()
    }
    share = posterior_probabilities(evidence)
    credible = credible_set(share)
    _, course, change = max(fits[credible[0]], key=lambda entry: entry[0])
    is_step = credible == (course.effect,) or channel == "load"
    return CauseOfChange(
        effects=credible,
        probabilities={name: value for name, value in share.items() if value >= 1e-3},
        channel=channel,
        change=change,
        change_point=course.change_point if is_step else None,
    )


def reconcile_channels(
    friction: CauseOfChange | None, load: CauseOfChange | None
) -> tuple[CauseOfChange, ...]:
    """Return the causes of both channels; one common cause if both changed by the same share.

    Parameters
    ----------
    friction, load : CauseOfChange or None
        Cause of each channel that changed.

    Returns
    -------
    tuple of CauseOfChange
        The scale of the torque (``torque_constant``) if the shares agree within their 95 %
        intervals, else the causes as given.
    """
    if friction is None or load is None:
        return tuple(cause for cause in (friction, load) if cause is not None)
    difference = abs(friction.change.value - load.change.value)
    half_width = np.hypot(
        friction.change.high - friction.change.value, load.change.high - load.change.value
    )
    if difference > half_width:
        return friction, load
    scale = CauseOfChange(
        effects=("torque_constant",),
        probabilities={"torque_constant": 1.0},
        channel="load",
        change=load.change,
        change_point=load.change_point,
    )
    return (scale,)


def is_significant(estimate: LevelEstimate, tests: int) -> bool:
    """Return whether an estimate differs from zero, with Bonferroni's correction for all tests."""
    return tests * estimate.p_value < _ALPHA
