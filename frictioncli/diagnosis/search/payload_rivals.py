r"""What looks like a change of payload: another scale of the torque, or zero of the position.

Another motor, drive or calibration changes load and friction by the same share *e*; a payload
changes friction by its load term only. How far friction itself differs between days limits what it
tells: relative to friction its change *f* has the density

.. math:: p(f \mid m) = (1 - s)\, N(f; m, \sigma^2) + s\, U(f)

about *m*, which is *e* with a scale, and what its load adds with a payload; before and after a
moment within a day it differs less. With the probability *s* something else changed friction at
that moment as well, evenly over a range (*U*). A scale changes the load exactly in the form of
gravity, and by few per cent as a rule; another zero of the position, or a base that was tilted,
exactly in the form of its slope, and by a degree or so. The torque of a payload, of any size, has
the form of gravity to within some ten degrees as a rule, at the end of an arm, but may have any.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

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
from frictioncli.effects import BY_NAME
from frictioncli.effects.base import Basis
from frictioncli.effects.history import present
from frictioncli.effects.pair_series import measured_share
from frictioncli.effects.payload_change import EFFECT as PAYLOAD_CHANGE
from frictioncli.effects.position_offset import EFFECT as POSITION_OFFSET
from frictioncli.effects.step_change import EFFECT as STEP_CHANGE
from frictioncli.effects.torque_scale import EFFECT as TORQUE_SCALE

_PRIOR = 0.1
"""Odds of either rival to a change of the payload, before anything is measured."""

_USUAL_SCALE = 0.02
"""Median size of a change of the scale, whose distribution (Cauchy) has heavy tails."""

_USUAL_PAYLOAD = 0.3
"""Standard deviation of what a payload adds, relative to gravity."""

_USUAL_OFFSET = np.radians(0.5)
"""Median size of a change of the zero of the position, of the same distribution. [rad]"""

_PHASE_OF_PAYLOAD = 0.5
"""Standard deviation of the angle between the forms of a payload's torque and of gravity. [rad]"""

_ANYWHERE = 0.2
"""Share of payloads that have any such angle."""

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
class WithRivals:
    """Causes of which a change of payload may be one of its rivals.

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


def with_payload_rivals(causes: Sequence[Cause], step: Step, rows: Sequence[Problem]) -> WithRivals:
    """Return causes with a rival of a change of payload where that may be it, or is.

    Parameters
    ----------
    causes : sequence of Cause
        The causes that are named.
    step : Step
        Base and causes.
    rows : sequence of Problem
        The rows of the runs that were seen, and of the one that was kept out.
    """
    unchanged = WithRivals(tuple(causes), (), step)
    payload = next((one for one in causes if one.fit.effect is PAYLOAD_CHANGE), None)
    if payload is None or step.problem.has_load_channel:
        return unchanged
    steps = _steps_with(payload, causes, step.problem)
    others = [one.fit for one in causes if one is not payload and one not in steps]
    judged = _with_chances(payload, _of_runs(payload.fit, others, rows, step))
    rival = BY_NAME[judged.effects[0]]
    if rival is PAYLOAD_CHANGE:
        kept = tuple(judged if one is payload else one for one in causes)
        return replace(unchanged, causes=kept)
    # a scale explains the step of friction at its moment as well
    explained = steps if rival is TORQUE_SCALE else []
    gone = {one.fit.effect for one in (payload, *explained)}
    beside = Step.of(step.precomputed, [one for one in step.accepted if one.effect not in gone])
    fit = beside.fitted(rival, payload.fit.shape)
    judged = replace(judged, fit=fit, **sizes_of(step.precomputed, fit))
    return WithRivals(
        causes=tuple(judged if one is payload else one for one in causes if one not in explained),
        replaced=tuple(
            replace(one, standing="undetermined", reason=_EXPLAINED) for one in explained
        ),
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


def with_rivals_on_new_run(cause: Cause, residual: NewRunMisfit) -> Cause:
    """Return a payload of a new run that may be, or is, one of its rivals.

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
    none = Basis(np.empty((len(new.friction), 0)), np.empty((len(new.friction), 0)))
    torques = _Torques.of(new, cause.fit, residual.misfit, none)
    judged = _with_chances(cause, _chances(cause.fit, torques, [new]))
    rival = BY_NAME[judged.effects[0]]
    if rival is PAYLOAD_CHANGE:
        return judged
    columns = new.basis(rival, cause.fit.shape)
    coefficients, covariance, statistic = residual.with_own_noise(columns).fitted(columns)
    fit = EffectFit(rival, cause.fit.shape, coefficients, covariance, statistic)
    return replace(judged, fit=fit)


def _with_chances(payload: Cause, chances: dict[str, float]) -> Cause:
    """Return a payload with the rivals in its set that may be it; as it is if there are none."""
    rest = 1.0 - sum(chances.values())
    probabilities = {name: rest * one for name, one in payload.probabilities.items()}
    probabilities |= chances
    effects = credible_set(probabilities)
    if chances.keys().isdisjoint(effects):
        return payload
    return replace(payload, effects=effects, probabilities=probabilities)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Torques:
    """What is left of the torque beside other effects, and what may explain it.

    Attributes
    ----------
    left, added : Basis
        What is left, and the torque that the payload adds.
    base, scaled, turned : Basis
        Columns of the base, and of both rivals.
    """

    left: Basis
    base: Basis
    added: Basis
    scaled: Basis
    turned: Basis

    @classmethod
    def of(
        cls, problem: Problem, payload: EffectFit, left: tuple[Array, Array], base: Basis
    ) -> "_Torques":
        """Return what is left of friction and load, and what may explain it in some rows."""
        added = problem.basis(payload.effect, payload.shape)
        return cls(
            left=Basis(*(one[:, np.newaxis] for one in left)),
            base=base,
            added=Basis(*((one @ payload.coefficients)[:, np.newaxis] for one in added)),
            scaled=problem.basis(TORQUE_SCALE, payload.shape),
            turned=problem.basis(POSITION_OFFSET, payload.shape),
        )


def _of_runs(
    payload: EffectFit, others: Sequence[EffectFit], rows: Sequence[Problem], step: Step
) -> dict[str, float]:
    """Return the probability of each rival of a payload [1]."""
    payload, *others = refit(step.problem, step.predicting_fit(), [payload, *others]).effects
    parts = [_torques_of(one, payload, others) for one in rows]
    joined = {
        field.name: _joined([getattr(part, field.name) for part in parts])
        for field in fields(_Torques)
    }
    return _chances(payload, _Torques(**joined), rows)


def _chances(payload: EffectFit, torques: _Torques, rows: Sequence[Problem]) -> dict[str, float]:
    """Return the probability of each rival of a payload [1]."""
    base, left, added = torques.base, torques.left, torques.added
    _, by_payload = _fitted(base.load, added.load, left.load)
    share, by_scale = _fitted(base.load, torques.scaled.load, left.load)
    offset, by_offset = _fitted(base.load, torques.turned.load, left.load)
    share, offset = share / 100.0, float(np.radians(offset))
    size = max(float(np.mean(np.square(added.load))), 1e-300)
    error = float(np.sqrt(np.trace(payload.covariance) / 2 / np.sum(payload.coefficients**2)))

    def aside(misfit: float) -> float:
        return float(np.arcsin(np.sqrt(np.clip((misfit - by_payload) / size, 0.0, 1.0))))

    from_gravity = aside(by_scale)
    usual = float(norm.pdf(from_gravity, scale=_PHASE_OF_PAYLOAD))
    of_payload = (1 - _ANYWHERE) * usual + _ANYWHERE / np.pi

    def odds_of(size: float, usual: float, angle: float) -> float:
        likely = cauchy.pdf(size, scale=usual) / norm.pdf(size, scale=_USUAL_PAYLOAD)
        exactly = norm.pdf(angle, scale=np.hypot(FORM, error))
        return float(_PRIOR * likely * exactly / of_payload)

    changed, _ = _fitted(base.friction, torques.scaled.friction, left.friction)
    with_payload, _ = _fitted(base.friction, torques.scaled.friction, added.friction)
    changed, with_payload = changed / 100.0, with_payload / 100.0
    within = any(_begins_or_ends_within(payload, one) for one in rows)
    spread = _WITHIN_DAY if within else _BETWEEN_DAYS
    by_friction = _density(changed - share, spread) / _density(changed - with_payload, spread)
    odds = {
        TORQUE_SCALE.name: by_friction * odds_of(share, _USUAL_SCALE, from_gravity),
        POSITION_OFFSET.name: odds_of(offset, _USUAL_OFFSET, aside(by_offset)),
    }
    every = 1.0 + sum(odds.values())
    return {name: one / every for name, one in odds.items()}


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


def _torques_of(problem: Problem, payload: EffectFit, others: Sequence[EffectFit]) -> _Torques:
    """Return what is left of the torque beside other effects, and what may explain it."""
    friction, load = problem.friction_misfit, problem.load_misfit
    for one in others:
        columns = problem.basis(one.effect, one.shape)
        friction = friction - columns.friction @ one.coefficients
        load = load - columns.load @ one.coefficients
    base = Basis(problem.friction_base, problem.load_base)
    return _Torques.of(problem, payload, (friction, load), base)


def _joined(parts: Sequence[Basis]) -> Basis:
    """Return the columns of several runs below each other."""
    return Basis(*(np.vstack(channel) for channel in zip(*parts, strict=True)))


def _fitted(base: Array, column: Array, values: Array) -> tuple[float, float]:
    """Return the coefficient of a column beside a base, and the mean square that both leave."""
    both = np.hstack([base, column])
    found = np.linalg.lstsq(both, values, rcond=None)[0]
    return float(found[-1, 0]), float(np.mean(np.square(values - both @ found)))
