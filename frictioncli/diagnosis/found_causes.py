"""Search for the causes of one joint, repeated until those that are named hold on a new run."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.cause_selection import BEYOND_DOUBT, refuted_by_new_run
from frictioncli.diagnosis.search.measurement import clear_effects
from frictioncli.diagnosis.search.named_causes import JudgedCauses, Judging
from frictioncli.diagnosis.search.new_run_rivals import refuted_by_return, without_refuted_rivals
from frictioncli.diagnosis.search.preparation import Preparation
from frictioncli.diagnosis.search.search_result import SearchResult
from frictioncli.diagnosis.thermal.lag_search import search_with_lag
from frictioncli.diagnosis.thermal.refine import LAG, RefinedLag
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
    """Search for causes; without those that a new run refutes, search again.

    Parameters
    ----------
    judging : Judging
        The rows about the measured temperature, and by what causes are judged.
    effects : sequence of Effect
        The catalogue.
    search : callable
        As of :func:`frictioncli.diagnosis.thermal.lag_search.search_with_lag`.
    """
    base, new = judging.measured
    measurement = clear_effects(judging.preparation.beside(base))
    refuted: tuple[Cause, ...] = ()
    judged_again = False
    while True:
        gone = {one.fit.effect.name for one in refuted}
        tried = [one for one in effects if one.name not in gone]
        searching = partial(search, preparation=judging.preparation)
        found, lag = search_with_lag(base, new, tried, searching, judging.margin, measurement)
        if not judged_again:
            judged_again = True
            told = _told_beside(found, base, judging.preparation)
            if told is not None:
                preparation, measurement = told
                judging = replace(judging, preparation=preparation)
                continue
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
    return FoundCauses(search=found, judged=judged, judging=judging, lag=lag, refuted=refuted)


def _told_beside(
    found: SearchResult, base: Problem, before: Preparation
) -> tuple[Preparation, tuple[Effect, ...]] | None:
    """Return what searches share, and what is clear of the measurement, beside what was found.

    None unless one more effect of the measurement is then clearly there: what the joint adds may
    have made it impossible or undetermined.

    Parameters
    ----------
    found : SearchResult
        Result of a search.
    base : Problem
        The rows about the measured temperature.
    before : Preparation
        What the search was prepared with.
    """
    known = [
        one.fit
        for one in found.causes
        if one.test.p_value < BEYOND_DOUBT and one.fit.effect.name != LAG
    ]
    if not known or not found.refused:
        return None
    preparation = Preparation(known)
    clear = clear_effects(preparation.beside(base), known)
    if set(clear) <= set(before.beside(base).effects):
        return None
    return preparation, clear
