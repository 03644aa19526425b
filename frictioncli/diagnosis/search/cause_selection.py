"""Causes on the run that was held out: which of them hold, which did not last, which are refuted.

A change of friction or payload has its history on the new run, which is an input and no parameter.
A cause beyond doubt of which the new run has nothing did not last: it stays a cause, and the
extended model does not predict it there. A cause that the new run contradicts is not named.
"""

from collections.abc import Sequence
from dataclasses import replace

from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.new_run import NewRunTest, new_run_test
from frictioncli.diagnosis.search.step import Step

BEYOND_DOUBT = 1e-6
"""Greatest p-value of a property of the joint that stays named though the new run lacks it."""

_NOTHING = 0.2
"""Greatest amplitude on the new run that counts as nothing, beside its interval."""

_ROUNDS = 2
"""Times that the histories of all changes are fitted on the new run, each beside the others."""


def judged_on_new_run(causes: Sequence[Cause], step: Step, new: Problem) -> tuple[Cause, ...]:
    """Return causes with whether they hold on a new run, and their standing after it.

    Parameters
    ----------
    causes : sequence of Cause
        Causes that are named.
    step : Step
        The last step of the search: the rows seen, and their noise.
    new : Problem
        Rows of a run that was held out.

    Returns
    -------
    tuple of Cause
        In the same order; changes with their history on the new run.
    """
    found = list(causes)
    changes = [number for number, one in enumerate(found) if _is_change(one)]
    for _ in range(_ROUNDS if len(changes) > 1 else 1):
        for number in changes:
            found[number] = _with_test(found[number], _tested(found, number, step, new))
    for number, one in enumerate(found):
        if not _is_change(one):
            found[number] = _with_test(one, _tested(found, number, step, new))
    return tuple(found)


def _is_change(cause: Cause) -> bool:
    return cause.fit.effect.moments is not None


def _tested(causes: Sequence[Cause], number: int, step: Step, new: Problem) -> NewRunTest:
    """Return the test of one of the causes on the new run, beside the others."""
    others = [one.fit for other, one in enumerate(causes) if other != number]
    return new_run_test(
        causes[number].fit, step.problem, new, step.weighted_fit(), step.noise(), others
    )


def _with_test(cause: Cause, test: NewRunTest) -> Cause:
    """Return a cause with what the new run shows of it."""
    judged = replace(cause, fit=replace(cause.fit, shape=test.shape), holds_on_new_run=test.holds)
    if test.holds is not False or _is_change(cause):
        return judged
    nothing = abs(test.amplitude) <= max(2 * test.error, _NOTHING)
    if nothing and cause.test.p_value < BEYOND_DOUBT:
        return judged
    reason = f"the run that was held out has {test.amplitude:.2g} times of it"
    return replace(judged, standing="visible", reason=reason)
