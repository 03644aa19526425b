r"""Whether torque that is late was delayed or filtered.

At constant velocity a delay and a filter look alike to first order: the effect ``torque_delay``
finds the mean time *D* by which the torque is late, whatever the reason. What tells them apart is
the variance *S* of that time: to second order at constant velocity, :math:`S = 2 s_2 - D^2` with
the second moment of ``torque_filter``, and much better where moves start
(:mod:`frictioncli.diagnosis.ramps.timing`).

Once it is known by how much the torque is late, every effect of the joint is looked for where such
a log shows it (:mod:`frictioncli.diagnosis.data.late_torque`).
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pandas as pd

from frictioncli.diagnosis.data.late_torque import LateTorque
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.left_by_base import Z95
from frictioncli.diagnosis.noise.significance import credible_set, posterior_probabilities
from frictioncli.diagnosis.ramps.timing import TorqueTiming
from frictioncli.diagnosis.ramps.timing_rivals import TimingRivals
from frictioncli.diagnosis.search.cause import CONVINCING, Cause
from frictioncli.diagnosis.search.measurement import (
    BesideBase,
    beside_base,
    measurement_causes,
)
from frictioncli.diagnosis.search.step import Step
from frictioncli.model.late_torque import torque_delay
from frictioncli.wording import quantity_text

DELAY, FILTER = "torque_delay", "torque_filter"

_TOLERANCE = (0.001, 2e-4)
_SHARE = (0.05, 0.25)
"""Errors of *D* and *S* by other structure in the pairs: at least [s], [s²], and as a share."""

_CONTRADICTED = "the starts of moves show {shown}"


def late_torque(
    problem: Problem,
    starts: TorqueTiming | None,
    beside_base_of: Callable[[Problem], BesideBase] = beside_base,
    torques: pd.DataFrame | None = None,
) -> LateTorque | None:
    """Return by how much the torque is late, from the pairs and from the starts of moves.

    Each counts by its precision. Starts may tell it to some hundredths of a second only, in which a
    ripple of friction passes.

    Parameters
    ----------
    problem : Problem
        One joint's measurements and base model.
    starts : TorqueTiming or None
        Delay and filter by the starts of moves.
    beside_base_of : callable, optional
        Returns what stands beside the base of the problem.
    torques : DataFrame, optional
        Rows of :data:`frictioncli.schemas.TORQUES` of the joint: they tell a delay whatever the
        friction at each angle, unless the load was measured apart.

    Returns
    -------
    LateTorque or None
        None where it is not clearly late, or where both contradict each other.
    """
    beside = beside_base_of(problem)
    causes = measurement_causes(Step.of(beside.precomputed, []), beside.effects)
    by_name = {cause.fit.effect.name: cause for cause in causes}
    late, smeared = by_name.get(DELAY), by_name.get(FILTER)
    if late is None and starts is None:
        return None
    known = _shift_by_pairs(late, problem, torques)
    if starts is not None:
        if known and starts.contradicts(*known[0]):
            return None
        known += [(float(starts.shift.value), float(np.sqrt(starts.rivals.covariance[0, 0])))]
    shift, error = np.array(known).T
    weight = 1 / np.square(error)
    delay = float(weight @ shift / weight.sum())
    if delay <= Z95 / np.sqrt(weight.sum()):
        return None
    if starts is not None:
        return LateTorque(delay=delay, variance=max(starts.smear.value, 0.0))
    if late is None or smeared is None:
        return LateTorque(delay=delay)
    if (rivals := _of_pairs(late, smeared)).log_odds < CONVINCING:
        return LateTorque(delay=delay)
    return LateTorque(delay=delay, variance=max(float(rivals.point[1]), 0.0))


def judged_by_timing(
    causes: Sequence[Cause], starts: TorqueTiming | None
) -> tuple[tuple[Cause, ...], TimingRivals | None]:
    """Return causes in which late torque has the name of its reason, and its rivals.

    It has no name where the starts of moves contradict it. Without starts of moves the delay keeps
    its name unless the pairs speak clearly for a filter.

    Parameters
    ----------
    causes : sequence of Cause
        Causes with their standing, effects of the measurement among them.
    starts : TorqueTiming or None
        Delay and filter by the starts of moves.

    Returns
    -------
    tuple of Cause, TimingRivals or None
        None where nothing is known about the delay.
    """
    by_name = {cause.fit.effect.name: cause for cause in causes}
    late, smeared = by_name.get(DELAY), by_name.get(FILTER)
    if late is not None and starts is not None and starts.contradicts(*_shift_of(late)):
        interval = (starts.shift.low, starts.shift.high)
        reason = _CONTRADICTED.format(shown=quantity_text(starts.shift.value, interval, "s"))
        unnamed = replace(late, standing="undetermined", reason=reason)
        return tuple(unnamed if one is late else one for one in causes), None
    known = [] if late is None or smeared is None else [_of_pairs(late, smeared)]
    known += [] if starts is None else [starts.rivals]
    if late is None or not known:
        return tuple(causes), None
    rivals = known[0].combined(known[1]) if len(known) > 1 else known[0]
    if starts is None and rivals.log_odds < CONVINCING:
        return tuple(causes), rivals
    evidence = rivals.log_evidence()
    if rivals.best in ("none", "both"):
        return tuple(causes), rivals
    filtered = float(np.logaddexp(evidence[FILTER], evidence["both"]))
    share = posterior_probabilities({DELAY: evidence[DELAY], FILTER: filtered})
    names = credible_set(share)
    renamed = replace(late, effects=names, probabilities=share)
    # what is late by a filter is not listed as a filter twice
    twice = names == (FILTER,) and smeared is not None and smeared.standing != "named"
    return tuple(
        renamed if cause is late else cause for cause in causes if not (twice and cause is smeared)
    ), rivals


def _shift_of(late: Cause) -> tuple[float, float]:
    """Return the mean time by which the torque is late, and its standard error [s]."""
    return float(late.fit.coefficients[0]), float(np.sqrt(max(late.fit.covariance[0, 0], 0.0)))


def _shift_by_pairs(
    late: Cause | None, problem: Problem, torques: pd.DataFrame | None
) -> list[tuple[float, float]]:
    """Return the mean time by which the torque is late, and its standard error [s], if known.

    Beside the base, with an error that allows for other structure, or beside any friction at each
    angle, whichever is more precise.
    """
    found = []
    if late is not None:
        shift, error = _shift_of(late)
        found.append((shift, float(np.hypot(error, _TOLERANCE[0] + _SHARE[0] * abs(shift)))))
    if torques is not None and not problem.has_load_channel:
        other = torque_delay(torques[torques["run"].isin(problem.runs)])
        found += [] if other is None else [(other.value, other.error)]
    return sorted(found, key=lambda one: one[1])[:1]


def _of_pairs(late: Cause, smeared: Cause) -> TimingRivals:
    """Return the rivals by the pairs alone."""
    shift, second = float(late.fit.coefficients[0]), float(smeared.fit.coefficients[0])
    variance, of_second = float(late.fit.covariance[0, 0]), float(smeared.fit.covariance[0, 0])
    point = np.array([shift, 2 * second - shift**2])
    tolerance = np.array(_TOLERANCE) + np.array(_SHARE) * np.abs(point)
    errors = np.array([variance, 4 * of_second + 4 * shift**2 * variance])
    return TimingRivals(point, np.diag(np.maximum(errors, 0.0) + np.square(tolerance)))
