r"""Whether a cause that was found is there on a run that was kept out.

What the base and the other causes, fitted to the runs seen, leave of the new run's torque is fitted
by the torque :math:`u` that the cause would add there, times an amplitude *a*,

.. math:: r = X \delta + a\, u + e, \quad \delta \sim N(0, \Sigma), \quad e \sim N(0, V)

by generalised least squares, with the columns *X* of base and other causes, the covariance
:math:`\Sigma` of their estimates from the runs seen, and the noise *V* of the new run, drift
included: a day that is a little off as a whole is no evidence. An amplitude of 1 is what the runs
seen predict, 0 is absence. Where the cause is there, its torque is off by the errors of its own
coefficients and shape: it counts as absent only if it is so with these errors in :math:`\delta`.

When a change was there is an input of the new run, as its temperature is, and no parameter of the
joint. Where the history that the runs seen suggest does not fit, it is estimated on the new run.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.load_levels import two_level_history
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.fit.weighted_fit import WeightedFit
from frictioncli.diagnosis.search.new_run_residual import NewRunResidual
from frictioncli.effects.history import (
    Shape,
    Stretch,
    distinct,
    present,
    spans_with,
    stretches,
    with_run,
)
from frictioncli.effects.history_search import refined_history
from frictioncli.effects.pair_series import measured_share
from frictioncli.model.noise import Noise

_SIGNIFICANT = 3.0
"""Standard errors by which an amplitude must differ from 0."""

_ALIKE = (1 / 3, 3.0)
"""Amplitudes that are compatible with the one predicted."""

_ABSENT = 0.5
"""An amplitude whose interval ends below this is absence."""

_TWO_SIDED = 1.96
"""Standard errors of a 95 % interval."""

_CONVINCING = 3.0
"""Log likelihood ratio that a history needs beside the number of histories that were tried."""

_MOMENTS = 24
"""Moments of the new run from which on, or up to which, a change is tried."""

_STRETCHES = 8
"""Moments between which a stretch of the new run is tried."""

_SHOWN = 0.5
"""Greatest standard error with which the run can show a cause of the size that is predicted. A run
in which next to nothing of it is left, as of running-in, does not contradict it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class NewRunTest:
    """A cause on the run that was kept out.

    Attributes
    ----------
    holds : bool or None
        Whether it is there; None where its size there is below what the run can show.
    amplitude, error : float
        Its estimate there over what the other runs predict, and its standard error; an infinite
        error where it adds no torque there. [-]
    shape : dict of str to float
        Its shape; of a change with its history in all runs, the new one included.
    """

    holds: bool | None
    amplitude: float
    error: float
    shape: dict[str, float]


def holds_on_new_run(
    fit: EffectFit,
    problem: Problem,
    new: Problem,
    weighted_fit: WeightedFit,
    noises: tuple[Noise, Noise],
    others: Sequence[EffectFit],
) -> bool | None:
    """Return whether a cause is there on the held-out run, None where that cannot be tested.

    Parameters
    ----------
    fit, problem, new, weighted_fit, noises, others
        As of :func:`new_run_test`.
    """
    return new_run_test(fit, problem, new, weighted_fit, noises, others).holds


def new_run_test(
    fit: EffectFit,
    problem: Problem,
    new: Problem,
    weighted_fit: WeightedFit,
    noises: tuple[Noise, Noise],
    others: Sequence[EffectFit],
) -> NewRunTest:
    """Test whether a cause is there on the held-out run, and when, if it is a change.

    Parameters
    ----------
    fit : EffectFit
        The cause.
    problem, new : Problem
        The runs seen, and the held-out run with the base model of the former.
    weighted_fit : WeightedFit
        Weights of the runs seen.
    noises : (Noise, Noise)
        Noise of friction and load there.
    others : sequence of EffectFit
        The other causes, with their history on the new run where they are changes.
    """
    residual = NewRunResidual.of(fit, problem, new, weighted_fit, noises, others)
    if fit.effect.moments is not None:
        return _test_of_change(residual, fit.shape)
    test = _tested(residual.with_own_noise(fit.shape), fit.shape)
    if test.holds is not False:
        return test
    # where it is there, its torque is as far off as its own errors allow
    doubtful = NewRunResidual.of(fit, problem, new, weighted_fit, noises, others, own_errors=True)
    return _tested(doubtful.with_own_noise(fit.shape), fit.shape)


def _tested(residual: NewRunResidual, shape: Shape) -> NewRunTest:
    """Return the test of a cause at one shape."""
    amplitude, error = residual.amplitude(shape)
    holds = None
    if amplitude > _SIGNIFICANT * error and _ALIKE[0] <= amplitude <= _ALIKE[1]:
        holds = True
    elif error < _SHOWN and amplitude + _TWO_SIDED * error < _ABSENT:
        holds = False
    return NewRunTest(holds=holds, amplitude=amplitude, error=error, shape=shape)


def _test_of_change(residual: NewRunResidual, shape: Shape) -> NewRunTest:
    """Return the test of a change, with its history on the new run.

    The history that the runs seen suggest comes first, then presence throughout the run or none;
    one whose moments are chosen on the run must be so much likelier as their number demands.
    """
    new, table = residual.new, residual.new.all_runs
    share = measured_share(table)[new.rows]
    (span,) = spans_with(table, share)
    absent, whole = (with_run(shape, span, parts) for parts in ([], [span]))
    parts = [[part] for part in parts_of(share, span)]
    levels = two_level_history(new)
    if levels is not None:
        parts += [stretches(levels), _between(stretches(levels), span)]
    tried = distinct((with_run(shape, span, one) for one in parts), share)
    # with drift only a history with all moments right explains more than a wrong one
    quiet = residual.without_drift()
    best = max((shape, whole, *tried), key=quiet.evidence)
    best = refined_history(best, table, new.rows, quiet.evidence)
    residual = residual.with_own_noise(best)
    simple = max((shape, whole), key=residual.evidence)
    chosen_by = _CONVINCING + float(np.log(max(len(tried), 1)))
    if residual.evidence(best) - max(residual.evidence(simple), 0.0) > chosen_by:
        simple = best
    found = _tested(residual, simple)
    if found.holds and residual.evidence(simple) > _CONVINCING:
        return found
    # not there: would it have been seen, as the runs seen suggest it or else throughout?
    suggested = shape if present(share, shape).any() else whole
    missed = _tested(residual, suggested)
    if missed.holds is False:
        return replace(missed, shape=absent)
    return replace(missed, holds=None, shape=shape)


def _between(parts: Sequence[Stretch], span: Stretch) -> list[Stretch]:
    """Return what of a span lies between some stretches within it."""
    edges = [span[0], *(edge for part in parts for edge in part), span[1]]
    return list(zip(edges[::2], edges[1::2], strict=True))


def parts_of(share: Array, span: Stretch) -> list[Stretch]:
    """Return the stretches to try on a run.

    Parameters
    ----------
    share : ndarray
        Shares of all pairs measured before its rows. [-]
    span : (float, float)
        The stretch of the run.
    """
    known = np.unique(share)
    places = np.unique(np.linspace(0, len(known) - 1, _MOMENTS + 2).round().astype(np.intp))[1:-1]
    moments = known[places].tolist()
    few = moments[:: max(len(moments) // _STRETCHES, 1)]
    return [
        *((moment, span[1]) for moment in moments),
        *((span[0], moment) for moment in moments),
        *combinations(few, 2),
    ]
