"""Which entry of the catalogue the change looks like; what cannot be told apart is said together.

Over months a run is a point: each effect that changes friction from run to run has a course over
the runs. Courses are weighed by the marginal likelihood of the levels, averaged over their shapes;
probabilities and the credible set are made of that as ``diagnose`` makes them. The load torque is
the witness: if it changed by the same share as friction, the scale of the logged torque did, and if
it changed alone, the payload.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.comparison.day_to_day import LevelEstimate, Scatter
from frictioncli.diagnosis.noise.significance import credible_set, probabilities

_RATES = (1.0, 2.0, 4.0)
"""Pace of running in: 63 % of it are over after the whole time divided by this."""

_ALPHA = 0.05

_CLAIMS = {
    (
        "drift",
        "friction",
    ): "Friction changed steadily over the runs, as by wear or ageing grease.",
    ("step_change", "friction"): "Friction changed once, between two runs, and stayed.",
    ("run_in", "friction"): "Friction fell fast at first and then ever slower, as in running in.",
    ("payload_change", "load"): "The load torque changed once, as by another payload or tool.",
    ("drift", "load"): "The load torque changed steadily from run to run.",
    ("torque_constant", "load"): (
        "Friction and load torque changed by the same share: the scale of the logged torque did."
    ),
}
"""What an effect is when runs are its points."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TimeCourse:
    """How a change may go on from the first run to the last.

    Attributes
    ----------
    effect : str
        Name in the catalogue.
    values : ndarray, shape (runs,)
        From 0 at the first run to 1 at the last.
    moment : int or None
        Number of the first run after a change that happens at once.
    falls : bool
        Whether only a fall of friction can go that way.
    """

    effect: str
    values: Array
    moment: int | None = None
    falls: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class CauseOfChange:
    """A cause of a change, or several that these runs cannot tell apart.

    Attributes
    ----------
    effects : tuple of str
        The credible set, most probable first.
    probabilities : dict of str to float
        Of all that were weighed.
    channel : {"friction", "load"}
        Where it shows.
    change : LevelEstimate
        From the first run to the last, by the most probable course. [%]
    moment : int or None
        Number of the first run after the change, if it happened at once.
    """

    effects: tuple[str, ...]
    probabilities: dict[str, float]
    channel: str
    change: LevelEstimate
    moment: int | None

    @property
    def claim(self) -> str:
        """What the most probable effect says of the runs."""
        return _CLAIMS[self.effects[0], self.channel]


def courses(time: Array) -> Iterator[TimeCourse]:
    """Yield the courses that a change may take over runs at these times.

    Parameters
    ----------
    time : ndarray, shape (runs,)
        Of each run, growing. Any unit.
    """
    share = (time - time[0]) / (time[-1] - time[0])
    yield TimeCourse(effect="drift", values=share)
    for moment in range(1, len(time)):
        after = (np.arange(len(time)) >= moment).astype(float)
        yield TimeCourse(effect="step_change", values=after, moment=moment)
    for rate in _RATES:
        values = np.expm1(-rate * share) / np.expm1(-rate)
        yield TimeCourse(effect="run_in", values=values, falls=True)


def cause_of(levels: Array, scatter: Scatter, time: Array, channel: str) -> CauseOfChange:
    """Return the cause that the course of levels over time tells.

    Parameters
    ----------
    levels : ndarray, shape (runs,)
        Of friction or of load torque. [%]
    scatter : Scatter
        What they do without a change.
    time : ndarray, shape (runs,)
        Of each run.
    channel : {"friction", "load"}
        Of a load, what steps is the payload, and what drifts is named as in friction.
    """
    tried: dict[str, list[tuple[float, TimeCourse, LevelEstimate]]] = {}
    for course in courses(time):
        fitted = scatter.fitted(levels, np.column_stack([np.ones_like(time), course.values]))
        change = fitted.estimate(np.array([0.0, 1.0]))
        if course.falls and (change.value >= 0 or channel == "load"):
            continue
        name = "payload_change" if channel == "load" and course.moment else course.effect
        tried.setdefault(name, []).append((fitted.likelihood, course, change))
    evidence = {
        name: float(np.logaddexp.reduce([one for one, _, _ in own]) - np.log(len(own)))
        for name, own in tried.items()
    }
    share = probabilities(evidence)
    chosen = credible_set(share)
    _, course, change = max(tried[chosen[0]], key=lambda entry: entry[0])
    return CauseOfChange(
        effects=chosen,
        probabilities={name: value for name, value in share.items() if value >= 1e-3},
        channel=channel,
        change=change,
        moment=course.moment if chosen == (course.effect,) or channel == "load" else None,
    )


def with_witness(
    friction: CauseOfChange | None, load: CauseOfChange | None
) -> tuple[CauseOfChange, ...]:
    """Return the causes, the load torque heard: the same share in both is the scale of the torque.

    Parameters
    ----------
    friction, load : CauseOfChange or None
        Of each channel that changed.
    """
    if friction is None or load is None:
        return tuple(cause for cause in (friction, load) if cause is not None)
    apart = abs(friction.change.value - load.change.value)
    reach = np.hypot(
        friction.change.high - friction.change.value, load.change.high - load.change.value
    )
    if apart > reach:
        return friction, load
    scale = CauseOfChange(
        effects=("torque_constant",),
        probabilities={"torque_constant": 1.0},
        channel="load",
        change=load.change,
        moment=load.moment,
    )
    return (scale,)


def changed(estimate: LevelEstimate, tests: int) -> bool:
    """Tell whether an estimate stands out of chance, with so many of them looked at."""
    return tests * estimate.p_value < _ALPHA
