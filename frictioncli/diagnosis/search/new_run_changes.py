r"""Changes that begin on the run that was kept out, so that the runs seen have nothing of them.

What the extended model leaves of the new run's torque is, as in
:mod:`frictioncli.diagnosis.search.new_run_residual`,

.. math:: r = N z + C(h)\, c + e, \quad z \sim N(0, I), \quad e \sim N(0, V)

with the columns *C* of a change of history *h*. Its coefficients and twice the log likelihood ratio
to its absence are, with the precision *M* of *r* without *z*,

.. math:: c = (C^\mathsf{T} M C)^{-1} C^\mathsf{T} M r, \quad
    S = r^\mathsf{T} M C\, (C^\mathsf{T} M C)^{-1} C^\mathsf{T} M r .

Another day always differs a little, and anything else that the model lacks there is larger than
noise too. So a change is accepted only where it is beyond doubt, is a single stretch, explains
nearly all that is left and more than other torque with the same history; and where it begins with
the run, only if it is more than days differ by. A step that explains hardly more than friction that
changes slowly may be a drift.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from scipy.special import expit

from frictioncli.arrays import Array
from frictioncli.diagnosis.fit.columns import base_rows, main_channel
from frictioncli.diagnosis.fit.extension import Extension
from frictioncli.diagnosis.fit.hypotheses import EffectFit, HypothesisTest, physical_bounds
from frictioncli.diagnosis.noise.significance import NullDistribution, log_bayes_factor
from frictioncli.diagnosis.search.cause import CONVINCING, Cause
from frictioncli.diagnosis.search.cause_selection import BEYOND_DOUBT
from frictioncli.diagnosis.search.largest_structure import BETWEEN_DAYS
from frictioncli.diagnosis.search.new_run import parts_of
from frictioncli.diagnosis.search.new_run_misfit import NewRunMisfit
from frictioncli.diagnosis.search.new_run_torque import rivals_of_change, slow_torque
from frictioncli.diagnosis.search.payload_rivals import with_rivals_on_new_run
from frictioncli.diagnosis.search.structure import Structure
from frictioncli.effects.base import Basis, Effect
from frictioncli.effects.drift import EFFECT as DRIFT
from frictioncli.effects.history import (
    Shape,
    distinct,
    history,
    presence,
    present,
    spans_with,
    stretches,
)
from frictioncli.effects.history_search import refined_history
from frictioncli.effects.pair_series import measured_share

ADEQUATE = 1.25
"""Greatest misfit on a run kept out of a model that is adequate, as a multiple of the noise."""

_EXPLAINED = 0.8
"""Least share of the mean square that is left beyond the noise, and of a payload beyond what the
model leaves of the runs seen, for a change to be its cause."""

_CLEARLY = 30.0
"""Statistic by which a change explains more than each of its rivals."""

_CLEAR_SHARE = 0.02
"""The same in torque, as a share of the mean square that it explains: no form is exactly true."""

_LEAST_PRESENT = 0.1
"""Least share of the pairs of the run that have a change, and that lack one that begins later."""

_MOST_EXPLAINED = 3.0
"""Greatest mean square that a change explains, relative to what is new on the run: what the model
leaves of two days may differ."""

_AS_LARGE = 1 / 3
"""Size of structure along time on the runs seen, relative to a change, that may be the same."""

_FORM = 0.05
"""Standard deviation of what the form of a change misses, relative to its size."""

_Z95 = 1.96


def changes_on_new_run(
    residual: NewRunMisfit,
    tried: Sequence[Effect],
    *,
    floor: float,
    usual: float,
    margin: float,
    structure: Structure | None = None,
) -> tuple[Cause, ...]:
    """Return the change that explains what the extended model leaves of a new run, if one does.

    A payload need not explain what the model leaves of the runs seen as well, as ringing behind
    ramps. What changes with time on the runs seen, too, need not stop between two runs.

    Parameters
    ----------
    residual : NewRunMisfit
        What the extended model leaves of the run.
    tried : sequence of Effect
        Effects that are no cause yet; of them changes count.
    floor : float
        RMS of the noise that is new with each pair. [N·m]
    usual : float
        RMS of what the model leaves of the runs seen. [N·m]
    margin : float
        Smallest size worth a name. [N·m]
    structure : Structure, optional
        Structure without a name that the runs seen have.
    """
    left = residual.mean_square(residual.misfit)
    if left <= (ADEQUATE * floor) ** 2:
        return ()
    found = []
    for effect in tried:
        if effect.moments is None:
            continue
        # friction of another day differs from what the model leaves of those seen
        beyond = max(floor, usual) if effect.channel == "load" else floor
        cause = _change(residual, effect, tried, margin)
        if cause is None or (structure is not None and _goes_on(structure, cause)):
            continue
        new = left - beyond**2
        judged = with_rivals_on_new_run(cause, residual)
        squares = (
            _square_left(residual, residual.new.basis(one.effect, one.shape), one.coefficients)
            for one in (cause.fit, judged.fit)
        )
        explained = max(left - square for square in squares)
        # what explains much more than is new is there on the runs seen as well
        if _EXPLAINED * new <= explained <= _MOST_EXPLAINED * new:
            found.append(judged)
    return tuple(sorted(found, key=lambda one: -one.test.statistic)[:1])


def _square_left(residual: NewRunMisfit, basis: Basis, coefficients: Array) -> float:
    """Return the mean square that a torque leaves of a new run's misfit [(N·m)²]."""
    friction, load = (
        misfit - one @ coefficients for misfit, one in zip(residual.misfit, basis, strict=True)
    )
    return residual.mean_square((friction, load))


def _goes_on(structure: Structure, cause: Cause) -> bool:
    """Return whether structure along time is as large as a change, or nearly, in its channel."""
    same = structure.channel == cause.fit.effect.channel and "time" in structure.axes
    return same and structure.size > _AS_LARGE * cause.size


def with_effect(extension: Extension, fit: EffectFit, place: int) -> Extension:
    """Return an extension with an effect that was fitted beside it on another run.

    Parameters
    ----------
    extension : Extension
        The base with the causes.
    fit : EffectFit
        The effect.
    place : int
        Number of effects that precede it.
    """
    before = extension.effects[:place]
    known = len(extension.names) + len(extension.gravity)
    coefficients = known + sum(len(one.coefficients) for one in before)
    shapes = sum(len(one.effect.shape) for one in before)
    errors = np.sqrt(np.maximum(np.diag(fit.covariance), 0.0))
    # what is weak and differs from day to day is there as well, and looks like a part of it
    errors = np.hypot(errors, _FORM * np.abs(fit.coefficients))
    return replace(
        extension,
        effects=(*before, fit, *extension.effects[place:]),
        errors=np.insert(extension.errors, coefficients, errors),
        fixed_shape_errors=np.insert(extension.fixed_shape_errors, coefficients, errors),
        shape_errors=np.insert(extension.shape_errors, shapes, np.zeros(len(fit.effect.shape))),
    )


def _change(
    residual: NewRunMisfit, effect: Effect, tried: Sequence[Effect], margin: float
) -> Cause | None:
    """Return a change on the new run as a cause, if it is beyond doubt."""
    new = residual.new
    table = new.all_runs
    share = np.unique(measured_share(table)[new.rows])
    (span,) = spans_with(table, share)
    shapes = [history([span])]
    shapes += distinct((history([part]) for part in parts_of(share, span)), share)

    def score(under: NewRunMisfit, shape: Shape) -> float:
        return under.fitted(new.basis(effect, shape))[2] / 2

    quiet = residual.without_drift()
    scores = [score(quiet, shape) for shape in shapes]
    first = shapes[int(np.argmax(scores))]
    best = refined_history(first, table, new.rows, partial(score, quiet))
    if 2 * score(quiet, best) < _CLEARLY:
        # not even if no drift could take it
        return None
    there = present(share, best)
    few = min(np.mean(there), np.mean(~there)) < _LEAST_PRESENT
    if few or score(quiet, best) - scores[0] < CONVINCING + np.log(len(shapes)):
        best = shapes[0]
    else:
        # beside slow noise only the right pair shows the change
        noisy = residual.with_own_noise(new.basis(effect, best))
        best = refined_history(best, table, new.rows, partial(score, noisy))
    if len(stretches(best)) != 1:
        return None
    columns = new.basis(effect, best)
    own = residual.with_own_noise(columns)
    coefficients, covariance, statistic = own.fitted(columns)
    is_rivalled, _ = _nearly_explained(own, columns, rivals_of_change(new, best, effect))
    is_slow, slow = _nearly_explained(own, columns, slow_torque(new, best, effect))
    gradual = [
        one.name for one in tried if one.name == DRIFT.name and effect.channel == one.channel
    ]
    lower, upper = physical_bounds(effect, new)
    null = NullDistribution(
        coefficients=len(coefficients),
        freedom=max(len(new.layout.time) - base_rows(new)[0].shape[1], 1),
        # presence throughout the run is no choice of moments
        shapes=1 if best is shapes[0] else len(shapes),
    )
    p_value = min(1.0, len(tried) * null.p_value(statistic))
    factor = log_bayes_factor(np.array([2 * one for one in scores]), len(coefficients))
    present_rows = presence(table, best)[new.rows] > 0
    size, error = _size(main_channel(columns, effect)[present_rows], coefficients, covariance)
    low, high = (size + way * _Z95 * np.hypot(error, _FORM * size) for way in (-1, 1))
    needed = margin
    if present(share.min(), best) and effect.channel == "friction":
        needed = max(needed, BETWEEN_DAYS * float(np.mean(np.abs(new.friction))))
    if (
        p_value > BEYOND_DOUBT
        or factor < CONVINCING
        or low < needed
        or is_rivalled
        or (is_slow if not gradual else statistic < slow)
        or np.any((coefficients < lower) | (coefficients > upper))
    ):
        return None
    probabilities = {effect.name: 1.0}
    if is_slow:
        slower = float(expit((slow - statistic) / 2))
        probabilities = {effect.name: 1 - slower, **dict.fromkeys(gradual, slower)}
    of_run = float(np.sqrt(np.mean(present_rows)))
    fit = EffectFit(effect, best, coefficients, covariance, statistic)
    test = HypothesisTest(
        name=effect.name,
        shape=best,
        coefficients=coefficients,
        covariance=covariance,
        statistic=statistic,
        p_value=p_value,
        log_bayes_factor=factor,
        freedom=len(coefficients),
        null=null,
        size_scale=of_run * error,
    )
    return Cause(
        fit=fit,
        test=test,
        effects=tuple(probabilities),
        probabilities=probabilities,
        size=of_run * size,
        visible=of_run * size,
        visible_interval=(of_run * low, of_run * high),
        holds_on_new_run=True,
        only_on_new_run=True,
    )


def _size(columns: Array, coefficients: Array, covariance: Array) -> tuple[float, float]:
    """Return the RMS of a torque, and its standard error to first order [N·m]."""
    inner = columns.T @ columns / len(columns)
    size = float(np.sqrt(max(float(coefficients @ inner @ coefficients), 1e-300)))
    slope = inner @ coefficients / size
    return size, float(np.sqrt(max(float(slope @ covariance @ slope), 0.0)))


def _nearly_explained(
    residual: NewRunMisfit, columns: Basis, rivals: Sequence[Basis]
) -> tuple[bool, float]:
    """Return whether a rival explains nearly as much as a change does, and the best statistic.

    Either is not clear: the evidence, or the torque in which the two differ.
    """
    whole = residual.mean_square(residual.misfit)

    def explained(basis: Basis) -> tuple[float, float]:
        coefficients, _, statistic = residual.fitted(basis)
        return statistic, whole - _square_left(residual, basis, coefficients)

    statistic, square = explained(columns)
    found = [explained(one) for one in rivals]
    near = any(
        statistic - other < _CLEARLY or square - least < _CLEAR_SHARE * square
        for other, least in found
    )
    return near, max(other for other, _ in found)
