r"""A change of the scale of the logged torque, which looks like a change of payload.

Another motor, drive or calibration changes load and friction by the same share *e*; a payload
changes friction by its load term only. How far friction itself differs between days limits what it
tells: relative to friction its change *f* has the density

.. math:: p(f \mid m) = (1 - s)\, N(f; m, \sigma^2) + s\, U(f)

about *m*, which is *e* with a scale, and what its load adds with a payload; before and after a
moment within a day it differs less. With the probability *s* something else changed friction at
that moment as well, evenly over a range (*U*). A scale changes the load exactly in the form of
gravity, which a payload at the end of an arm does to within some ten degrees only, and by few per
cent as a rule, where payloads are of any size.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import cauchy, norm

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.extension import refit
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.noise.significance import credible_set
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.effect_size import FORM, sizes_of
from frictioncli.diagnosis.search.new_run_misfit import NewRunMisfit
from frictioncli.diagnosis.search.step import Step
from frictioncli.effects.base import Basis
from frictioncli.effects.history import present
from frictioncli.effects.pair_series import measured_share
from frictioncli.effects.payload_change import EFFECT as PAYLOAD_CHANGE
from frictioncli.effects.step_change import EFFECT as STEP_CHANGE
from frictioncli.effects.torque_scale import EFFECT as TORQUE_SCALE

_PRIOR = 0.1
"""Odds of a change of the scale to one of the payload, before anything is measured."""

_USUAL_SCALE = 0.02
"""Median size of a change of the scale, whose distribution (Cauchy) has heavy tails."""

_USUAL_PAYLOAD = 0.3
"""Standard deviation of what a payload adds, relative to gravity."""

_PHASE_OF_PAYLOAD = 0.5
"""Standard deviation of the angle between the forms of a payload's torque and of gravity. [rad]"""

_BETWEEN_DAYS = 0.015
"""Standard deviation of friction between days, relative to friction."""

_WITHIN_DAY = 0.005
"""The same before and after a moment within a day."""

_OF_RUN = 0.1
"""Least share of the rows of a run on either side of such a moment."""

_SERVICED = 0.05
"""Probability that friction was changed at the same moment."""

_RANGE = 0.4
"""Range of such a change, relative to friction."""

_SAME_HISTORY = 0.9
"""Least share of the rows in which two changes agree that have one history."""

_EXPLAINED = "the change of the scale of the torque explains it"


@dataclass(frozen=True, slots=True)
class Scaled:
    """Causes of which a change of payload may be one of the torque's scale.

    Attributes
    ----------
    causes : tuple of Cause
        The causes that are named.
    replaced : tuple of Cause
        Steps of friction that the change of scale explains.
    step : Step
        Base and causes.
    """

    causes: tuple[Cause, ...]
    replaced: tuple[Cause, ...]
    step: Step


def with_torque_scale(causes: Sequence[Cause], step: Step, rows: Sequence[Problem]) -> Scaled:
    """Return causes with a change of the torque's scale where it may be, or is, the payload's.

    Parameters
    ----------
    causes : sequence of Cause
        The causes that are named.
    step : Step
        Base and causes.
    rows : sequence of Problem
        The rows of the runs that were seen, and of the one that was kept out.
    """
    unchanged = Scaled(tuple(causes), (), step)
    payload = next((one for one in causes if one.fit.effect is PAYLOAD_CHANGE), None)
    if payload is None or step.problem.has_load_channel:
        return unchanged
    steps = _steps_with(payload, causes, step.problem)
    others = [one.fit for one in causes if one is not payload and one not in steps]
    scale = _of_runs(payload.fit, others, rows, step)
    judged = _or_scale(payload, scale)
    if TORQUE_SCALE.name not in judged.effects:
        return unchanged
    if judged.effects[0] != TORQUE_SCALE.name:
        kept = tuple(judged if one is payload else one for one in causes)
        return replace(unchanged, causes=kept)
    gone = {one.fit.effect for one in (payload, *steps)}
    beside = Step.of(step.precomputed, [one for one in step.accepted if one.effect not in gone])
    fit = beside.fitted(TORQUE_SCALE, payload.fit.shape)
    judged = replace(judged, fit=fit, **sizes_of(step.precomputed, fit))
    return Scaled(
        causes=tuple(judged if one is payload else one for one in causes if one not in steps),
        replaced=tuple(replace(one, standing="undetermined", reason=_EXPLAINED) for one in steps),
        step=Step.of(step.precomputed, [*beside.accepted, fit]),
    )


def _steps_with(payload: Cause, causes: Sequence[Cause], problem: Problem) -> list[Cause]:
    """Return the steps of friction that are there in the same rows as a payload."""
    share = measured_share(problem.all_runs)[problem.rows]
    there = present(share, payload.fit.shape)
    return [
        one
        for one in causes
        if one.fit.effect is STEP_CHANGE
        and np.mean(present(share, one.fit.shape) == there) >= _SAME_HISTORY
    ]


def with_scale_on_new_run(cause: Cause, residual: NewRunMisfit) -> Cause:
    """Return a payload of a new run that may be, or is, a change of the scale.

    Parameters
    ----------
    cause : Cause
        A change that begins on the new run.
    residual : NewRunMisfit
        What the extended model leaves of it.
    """
    new = residual.new
    if cause.fit.effect is not PAYLOAD_CHANGE or new.has_load_channel:
        return cause
    added, columns = (new.basis(one, cause.fit.shape) for one in (PAYLOAD_CHANGE, TORQUE_SCALE))
    none = Basis(np.empty((len(new.friction), 0)), np.empty((len(new.friction), 0)))
    torque = Basis(*((one @ cause.fit.coefficients)[:, np.newaxis] for one in added))
    left = Basis(*(one[:, np.newaxis] for one in residual.misfit))
    scale = _probability(cause.fit, (left, none, columns, torque), [new])
    judged = _or_scale(cause, scale)
    if judged.effects[0] != TORQUE_SCALE.name:
        return judged
    coefficients, covariance, statistic = residual.with_own_noise(columns).fitted(columns)
    fit = EffectFit(TORQUE_SCALE, cause.fit.shape, coefficients, covariance, statistic)
    return replace(judged, fit=fit)


def _or_scale(payload: Cause, scale: float) -> Cause:
    """Return a payload with the scale in its set, by its probability; as it is if that is small."""
    probabilities = {name: (1 - scale) * one for name, one in payload.probabilities.items()}
    probabilities[TORQUE_SCALE.name] = scale
    effects = credible_set(probabilities)
    if TORQUE_SCALE.name not in effects:
        return payload
    return replace(payload, effects=effects, probabilities=probabilities)


def _of_runs(
    payload: EffectFit, others: Sequence[EffectFit], rows: Sequence[Problem], step: Step
) -> float:
    """Return the probability that the scale of the torque changed, and not the payload [1]."""
    payload, *others = refit(step.problem, step.predicting_fit(), [payload, *others]).effects
    parts = [_rows_of(one, payload, others) for one in rows]
    left, base, scaled, added = (_joined([part[i] for part in parts]) for i in range(4))
    return _probability(payload, (left, base, scaled, added), rows)


def _probability(
    payload: EffectFit, torques: tuple[Basis, Basis, Basis, Basis], rows: Sequence[Problem]
) -> float:
    """Return the probability of a change of the scale, from the columns of :func:`_rows_of` [1]."""
    left, base, scaled, added = torques
    _, by_payload = _fitted(base.load, added.load, left.load)
    share, by_scale = _fitted(base.load, scaled.load, left.load)
    size = float(np.mean(np.square(added.load)))
    aside = np.arcsin(np.sqrt(np.clip((by_scale - by_payload) / max(size, 1e-300), 0.0, 1.0)))
    changed, _ = _fitted(base.friction, scaled.friction, left.friction)
    with_payload, _ = _fitted(base.friction, scaled.friction, added.friction)
    within = any(_begins_or_ends_within(payload, one) for one in rows)
    spread = _WITHIN_DAY if within else _BETWEEN_DAYS
    odds = _PRIOR * _density(changed - share, spread) / _density(changed - with_payload, spread)
    odds *= cauchy.pdf(share, scale=_USUAL_SCALE) / norm.pdf(share, scale=_USUAL_PAYLOAD)
    error = float(np.sqrt(np.trace(payload.covariance) / 2 / np.sum(payload.coefficients**2)))
    exactly = norm.pdf(aside, scale=np.hypot(FORM, error))
    odds *= float(exactly / norm.pdf(aside, scale=_PHASE_OF_PAYLOAD))
    return float(odds / (1 + odds))


def _begins_or_ends_within(change: EffectFit, problem: Problem) -> bool:
    """Return whether a run has rows with a change and without it."""
    there = present(measured_share(problem.all_runs)[problem.rows], change.shape)
    run = problem.layout.run[problem.layout.row_pair]
    shares = (float(np.mean(there[run == one])) for one in np.unique(run))
    return any(_OF_RUN < share < 1 - _OF_RUN for share in shares)


def _density(change: float, spread: float) -> float:
    """Return the density of a change of friction that is not expected, relative to it [1]."""
    usual = float(norm.pdf(change, scale=spread))
    return (1 - _SERVICED) * usual + _SERVICED / _RANGE


def _rows_of(
    problem: Problem, payload: EffectFit, others: Sequence[EffectFit]
) -> tuple[Basis, Basis, Basis, Basis]:
    """Return what is left of the torque beside other effects, and what may explain it.

    The columns of the base, those of torque that a scale multiplies while the payload is there,
    and the torque that the payload adds.
    """
    friction, load = problem.friction_misfit, problem.load_misfit
    for one in others:
        columns = problem.basis(one.effect, one.shape)
        friction = friction - columns.friction @ one.coefficients
        load = load - columns.load @ one.coefficients
    added = problem.basis(payload.effect, payload.shape)
    scaled = problem.basis(TORQUE_SCALE, payload.shape)
    return (
        Basis(friction[:, np.newaxis], load[:, np.newaxis]),
        Basis(problem.friction_base, problem.load_base),
        scaled,
        Basis(*((one @ payload.coefficients)[:, np.newaxis] for one in added)),
    )


def _joined(parts: Sequence[Basis]) -> Basis:
    """Return the columns of several runs below each other."""
    return Basis(*(np.vstack(channel) for channel in zip(*parts, strict=True)))


def _fitted(base: Array, column: Array, values: Array) -> tuple[float, float]:
    """Return the coefficient of a column beside a base, and the mean square that both leave."""
    both = np.hstack([base, column])
    found = np.linalg.lstsq(both, values, rcond=None)[0]
    return float(found[-1, 0]) / 100.0, float(np.mean(np.square(values - both @ found)))
