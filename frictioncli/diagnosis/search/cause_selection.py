"""Causes on the run that was held out: which of them hold, which did not last, which are refuted.

A change of friction or payload has its history on the new run, which is an input and no parameter.
A cause beyond doubt of which the new run has nothing did not last: it stays a cause, and the
extended model does not predict it there. A cause that the new run contradicts is not named, nor one
that makes its prediction worse.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.extension import Extension, extend, refit, rms_misfit
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.fit.left_by_base import Z95
from frictioncli.diagnosis.fit.weighted_fit import WeightedFit
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.doubtful_steps import doubtful_with_new_run
from frictioncli.diagnosis.search.new_run import NewRunTest, new_run_test
from frictioncli.diagnosis.search.standing import without_cancelling
from frictioncli.diagnosis.search.step import Step
from frictioncli.effects.base import Effect
from frictioncli.effects.rest_recovery import EFFECT as REST_RECOVERY
from frictioncli.effects.sensor_lag import EFFECT as SENSOR_LAG
from frictioncli.effects.thermal_lag import EFFECT as THERMAL_LAG

BEYOND_DOUBT = 1e-6
"""Greatest p-value of a property of the joint that stays named though the new run lacks it, and of
any cause whose coefficient may be zero in the extended model."""

_NOTHING = 0.2
"""Greatest amplitude on the new run that counts as nothing, beside its interval."""

_AT_BOUND = 0.99
"""Share of the range of a time from which on it lies on the bound of what is tried."""

_SETTLES = 0.5
"""Share of the excess at the start of a run from which friction settles rather than recovers."""

WORSE = 1.05
"""RMS misfit of a new run with a cause over that without it from which on the run refutes it."""

_WORSE_WITH_LAG = 1.25
"""The same with a lag of the gear, whose network is never exact: a gear that something else has
warmed is far off."""

_MADE_WORSE = "with it, the misfit on the held-out run is {times:.2g} times as large"

_ROUNDS = 2
"""Times that the histories of all changes are fitted on the new run, each beside the others."""


def judged_together(
    causes: Sequence[Cause], step: Step, problem: Problem, new: Problem | None
) -> tuple[Cause, ...]:
    """Return causes judged on a new run, if there is one; of two that cancel, one has no name.

    Parameters
    ----------
    causes : sequence of Cause
        Causes that are named.
    step : Step
        The last step of the search.
    problem : Problem
        The rows seen.
    new : Problem or None
        Rows of a run that was held out.
    """
    judged = tuple(causes) if new is None else judged_on_new_run(causes, step, new)
    kept = without_cancelling(judged, problem)
    lost = [one for before, one in zip(judged, kept, strict=True) if one is not before]
    if new is None or not lost:
        return kept
    # the others are judged as if those were not there
    names = {one.fit.effect.name for one in lost}
    rest = [one for one in causes if one.fit.effect.name not in names]
    return (*judged_on_new_run(rest, step, new), *lost)


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
        elif doubt := doubtful_with_new_run(one.fit, step.problem, new):
            found[number] = replace(one, standing="undetermined", reason=doubt)
    return tuple(found)


def refuted_by_new_run(causes: Sequence[Cause], step: Step, new: Problem) -> tuple[Cause, ...]:
    """Return causes that make the prediction of a new run clearly worse, no longer named.

    A slow cause that goes on as it did may be far off a day later, though something of its sign is
    there. The worst goes first, and the others are judged without it. Changes have their history on
    the new run; a lag is judged with its temperature; effects of the measurement belong to the log.

    Parameters
    ----------
    causes : sequence of Cause
        Causes that are named, judged on the new run.
    step : Step
        The last step of the search.
    new : Problem
        Rows of a run that was held out.
    """
    weighted_fit = step.predicting_fit()
    among = [one for one in causes if one.standing == "named" and one.holds_on_new_run is not False]

    def missed(named: Sequence[Cause]) -> float:
        return missed_of_new_run([one.fit for one in named], step.problem, new, weighted_fit)

    refuted: list[Cause] = []
    while True:
        with_all, without = missed(among), {}
        for cause in among:
            if predicts_new_run(cause.fit.effect):
                without[cause.fit.effect.name] = missed([one for one in among if one is not cause])
        worst = min(without, key=lambda name: without[name], default=None)
        if worst is None or with_all <= WORSE * without[worst]:
            return tuple(refuted)
        reason = _MADE_WORSE.format(times=with_all / without[worst])
        (gone,) = (one for one in among if one.fit.effect.name == worst)
        refuted.append(replace(gone, standing="visible", reason=reason))
        among.remove(gone)


def refuted_lag(
    causes: Sequence[Cause],
    step: Step,
    missed_with: Callable[[Sequence[EffectFit]], float],
    measured: tuple[Problem, Problem],
) -> str:
    """Return why a lag of the gear makes the prediction of a new run worse; empty if it does not.

    What warmed the gear before a run is not logged. Where that decides, the measured temperature
    predicts the run better.

    Parameters
    ----------
    causes : sequence of Cause
        Causes that are named, judged on the new run.
    step : Step
        The last step of the search.
    missed_with : callable
        RMS misfit of a new run by the model with a lag, of which some effects are a part. [N·m]
    measured : (Problem, Problem)
        The rows seen, and those of the new run, about the measured temperature.
    """
    among = [one for one in causes if one.standing == "named"]
    others = [one.fit for one in among if one.fit.effect.name != THERMAL_LAG.name]
    if len(others) == len(among):
        return ""
    without = missed_of_new_run(others, *measured, step.predicting_fit())
    times = missed_with([one.fit for one in among]) / without
    return _MADE_WORSE.format(times=times) if times > _WORSE_WITH_LAG else ""


def predicts_new_run(effect: Effect) -> bool:
    """Return whether an effect says by itself what it adds on a new run.

    Changes have their history there, a lag of the gear has its own temperature, and effects of the
    measurement belong to the log.

    Parameters
    ----------
    effect : Effect
        The effect.
    """
    return not effect.measurement and effect.moments is None and effect.name != THERMAL_LAG.name


def missed_of_new_run(
    fits: Sequence[EffectFit], problem: Problem, new: Problem, weighted_fit: WeightedFit
) -> float:
    """Return the RMS misfit of a new run, the base fitted beside some effects to the runs seen.

    Parameters
    ----------
    fits : sequence of EffectFit
        The effects.
    problem, new : Problem
        The rows seen, and those of the new run.
    weighted_fit : WeightedFit
        Weights of the rows seen.

    Returns
    -------
    float
        The misfit. [N·m]
    """
    return rms_misfit(new, refit(problem, weighted_fit, fits))


def uncertain_causes(
    causes: Sequence[Cause], problem: Problem, weighted_fit: WeightedFit
) -> frozenset[str]:
    """Return the names of causes whose only coefficient may be zero in the extended model.

    What smooth errors of the model could add along it counts there, and what is not fitted. Of what
    is there beyond doubt only the part that the base could imitate may be zero; of an effect of the
    measurement that part counts as well. Zero may be, too, the excess of friction after rests that
    recovers more slowly than any that is tried.

    Parameters
    ----------
    causes : sequence of Cause
        Causes that are named.
    problem : Problem
        The runs seen.
    weighted_fit : WeightedFit
        Weights of both channels.
    """
    extension = extend(problem, weighted_fit, [one.fit for one in causes])
    return frozenset(
        cause.fit.effect.name
        for number, cause in enumerate(causes)
        if _recovers_without_end(extension, number)
        or (
            extension.may_be_zero(number)
            and (cause.test.p_value >= BEYOND_DOUBT or cause.fit.effect.measurement)
        )
    )


def _recovers_without_end(extension: Extension, number: int) -> bool:
    """Return whether an effect is friction that recovers in no rest, with an excess of any size.

    Where little of it is there at the start of a run, it then grows steadily, as friction that
    rises over each day. Where most is, it is friction that settles, and the night was the rest.
    """
    fit = extension.effects[number]
    if fit.effect is not REST_RECOVERY:
        return False
    (rest,) = (one for one in fit.effect.shape if one.name == "rest_time")
    if fit.shape["at_start"] > _SETTLES:
        return False
    error = extension.errors[extension.place(number)][0]
    return rest.share(fit.shape["rest_time"]) >= _AT_BOUND and fit.coefficients[0] <= Z95 * error


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
    # the sensor is the same one on every run
    comes_back = cause.fit.effect.recurs or cause.fit.effect is SENSOR_LAG
    if nothing and cause.test.p_value < BEYOND_DOUBT and not comes_back:
        return judged
    reason = f"on the held-out run it is {test.amplitude:.2g} times as large"
    return replace(judged, standing="visible", reason=reason)
