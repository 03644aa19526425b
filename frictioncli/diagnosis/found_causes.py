"""Search for the causes of one joint, repeated until those that are named hold on a new run."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.cause_selection import (
    BEYOND_DOUBT,
    refuted_by_new_run,
    refuted_lag,
)
from frictioncli.diagnosis.search.judging import JudgedCauses, Judging
from frictioncli.diagnosis.search.measurement import clear_effects, doubtful_filter
from frictioncli.diagnosis.search.new_run_rivals import refuted_by_return, without_refuted_rivals
from frictioncli.diagnosis.search.preparation import Preparation
from frictioncli.diagnosis.search.search_result import SearchResult
from frictioncli.diagnosis.thermal.lag_search import search_with_lag
from frictioncli.diagnosis.thermal.refine import LAG, RefinedLag, missed_with_lag
from frictioncli.effects.base import Effect


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundCauses:
    """Result of the search.

    Attributes
    ----------
    search : SearchResult
        The last search.
    judged : JudgedCauses
        What it found, with its standing.
    judging : Judging
        By what that was judged.
    lag : RefinedLag or None
        The lag of the gear, where it is one of the causes: then the rows are linear about the
        temperature of the gear.
    refuted : tuple of Cause
        Causes of earlier searches that the new run refutes.
    """

    search: SearchResult
    judged: JudgedCauses
    judging: Judging
    lag: RefinedLag | None
    refuted: tuple[Cause, ...]


def found_causes(
    judging: Judging, effects: Sequence[Effect], search: Callable[..., SearchResult]
) -> FoundCauses:
    """Search for causes, once more if the measurement turns out to be another beside them.

    What the joint adds may have made an effect of the measurement impossible or undetermined, or
    possible. If one more takes the name of a cause, it is the cause in another form, and not there.

    Parameters
    ----------
    judging : Judging
        The rows about the measured temperature, and by what causes are judged.
    effects : sequence of Effect
        The catalogue.
    search : callable
        As of :func:`frictioncli.diagnosis.thermal.lag_search.search_with_lag`.
    """
    base, _ = judging.measured
    before = judging.preparation.beside(base)
    first = _not_refuted(judging, effects, search, clear_effects(before))
    known = [
        one.fit
        for one in first.search.causes
        if one.test.p_value < BEYOND_DOUBT and one.fit.effect.name != LAG
    ]
    lost = doubtful_filter(first.search.measurement)
    if not known or not (lost or first.search.refused):
        return first
    preparation = Preparation(known, judging.preparation)
    clear = clear_effects(preparation.beside(base), known)
    if not lost and set(clear) <= set(before.effects):
        return first
    again = _not_refuted(replace(judging, preparation=preparation), effects, search, clear)
    return again if _names(first.judged) <= _names(again.judged) else first


def _names(judged: JudgedCauses) -> set[str]:
    """Return the names of the properties of the joint that are named."""
    effects = (one.fit.effect for one in judged.named)
    return {one.name for one in effects if not one.measurement}


def _not_refuted(
    judging: Judging,
    effects: Sequence[Effect],
    search: Callable[..., SearchResult],
    measurement: Sequence[Effect],
) -> FoundCauses:
    """Search for causes; without those that a new run refutes, search again."""
    base, new = judging.measured
    search = partial(search, preparation=judging.preparation)
    refuted: tuple[Cause, ...] = ()
    while True:
        gone = {one.fit.effect.name for one in refuted}
        tried = [one for one in effects if one.name not in gone]
        found, lag = search_with_lag(base, new, tried, search, judging.margin, measurement)
        judging = judging.without_lag()
        if lag is not None:
            judging = replace(judging, problem=lag.problem, new=lag.new)
        judged = judging.judged(found)
        worse: tuple[Cause, ...] = ()
        if judging.new is not None:
            worse = refuted_by_new_run(judged.named, found.step, judging.new)
            worse = worse or refuted_by_return(judged.named, found, judging.new)
        if not worse:
            break
        refuted += worse
    if judging.new is not None:
        kept = without_refuted_rivals(judged.causes, found, judging.new)
        judged = replace(judged, causes=kept)
    if judging.new is not None and new is not None and lag is not None:
        # nothing else may take its place: the runs seen show it
        weighted_fit = found.step.predicting_fit()
        missed = partial(missed_with_lag, lag, weighted_fit)
        reason = refuted_lag(judged.named, found.step, missed, (base, new))
        if reason:
            judged = judged.without_names({LAG}, "visible", reason)
    return FoundCauses(search=found, judged=judged, judging=judging, lag=lag, refuted=refuted)
