"""From what a search found to the causes that are named, and what stands beside them.

What the search accepted and nobody names extends no model. It must not take from the measurement
what corrects the log, nor from the noise what the model leaves: both are judged anew beside the
named causes alone, until all that stands there has a name.
"""

from dataclasses import dataclass, replace

from frictioncli.diagnosis.ramps.timing_rivals import TimingRivals
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.cause_selection import BEYOND_DOUBT
from frictioncli.diagnosis.search.judging import JudgedCauses, Judging, names_of
from frictioncli.diagnosis.search.measurement import measurement_causes
from frictioncli.diagnosis.search.payload_rivals import with_payload_rivals
from frictioncli.diagnosis.search.search_result import SearchResult
from frictioncli.diagnosis.search.step import Step
from frictioncli.diagnosis.search.structure import Structure
from frictioncli.diagnosis.search.understood import structure_beside
from frictioncli.diagnosis.search.without_a_name import (
    beyond_doubt_without_a_name,
    change_over_time,
)
from frictioncli.effects.thermal_lag import EFFECT as THERMAL_LAG


@dataclass(frozen=True, slots=True, kw_only=True)
class NamedCauses:
    """The causes of a joint that are named, and what stands beside them.

    Attributes
    ----------
    causes : tuple of Cause
        The causes, effects of the measurement first.
    others : tuple of Cause
        What was found and is not named, with the reason.
    structure : Structure or None
        Structure without a name.
    measurement : tuple of Cause
        Effects of the measurement, as they are estimated beside these causes.
    timing : TimingRivals or None
        By how much the torque is late, and whether by a delay or a filter.
    step : Step
        Base and these causes, with the noise that suits them best.
    """

    causes: tuple[Cause, ...]
    others: tuple[Cause, ...]
    structure: Structure | None
    measurement: tuple[Cause, ...]
    timing: TimingRivals | None
    step: Step


def named_causes(judging: Judging, first: JudgedCauses) -> NamedCauses:
    """Return the causes that are named, and all that stands beside them alone.

    Parameters
    ----------
    judging : Judging
        Rows and demands.
    first : JudgedCauses
        What the search found, judged.
    """
    step = first.found.step
    judged, structure = judging.without_parts(first)
    judged = judging.without_uncertain(judged)
    lost_on_the_way: tuple[Cause, ...] = ()
    while not _all_named(judged):
        unnamed = [one for one in judged.causes if one.standing != "named"]
        lost_on_the_way += tuple(one for one in unnamed if not one.fit.effect.measurement)
        if THERMAL_LAG.name not in names_of(judged.named):
            judging = judging.without_lag()
        judged = judging.without_uncertain(judging.judged(_beside_named(judging, judged)))
        judged = without_imitations(judged, first, judging.alpha)
        judged, _ = judging.without_parts(judged)
    others = [one for one in judged.causes if one.standing != "named"]
    rows = [judging.problem] if judging.new is None else [judging.problem, judging.new]
    rivalled = with_payload_rivals(judged.named, judged.found.step, rows)
    if rivalled.step is not step:
        # what lost its name was a part of the structure, or all of it
        left = structure_beside(rivalled.step, rivalled.causes, judging.margin, judging.alpha)
        structure = left if rivalled.step is not judged.found.step else left or structure
    there = beyond_doubt_without_a_name(first.causes, names_of(judged.named), judging.margin)
    if structure is None and all(one.fit.effect.measurement for one in rivalled.causes):
        structure = change_over_time(there)
    return NamedCauses(
        causes=rivalled.causes,
        others=(*others, *lost_on_the_way, *rivalled.replaced),
        structure=structure,
        measurement=judged.found.measurement,
        timing=judged.timing,
        step=rivalled.step,
    )


def _all_named(judged: JudgedCauses) -> bool:
    """Return whether all that stands beside the base is named, or of the measurement."""
    accepted = judged.found.step.accepted
    return {one.effect.name for one in accepted} <= names_of(judged.named)


def _beside_named(judging: Judging, judged: JudgedCauses) -> SearchResult:
    """Return what was found as it is beside the named causes alone."""
    found, names = judged.found, names_of(judged.named)
    accepted = [one for one in found.step.accepted if one.effect.name in names]
    precomputed = found.step.precomputed
    effects = tuple(one.fit.effect for one in found.measurement)
    if found.step.problem is not judging.problem:
        beside = judging.preparation.beside(judging.problem)
        precomputed, effects = beside.precomputed, beside.effects
    step = Step.of(precomputed, accepted)
    return replace(
        found,
        causes=tuple(one for one in judged.named if not one.fit.effect.measurement),
        measurement=measurement_causes(step, effects),
        step=step,
    )


def without_imitations(judged: JudgedCauses, first: JudgedCauses, alpha: float) -> JudgedCauses:
    """Return causes of which no effect of the measurement stands for one that has lost its name.

    What is there beyond doubt and too small for a name is no part of the model; an effect of the
    measurement that was noise beside it then looks like it, and stays what it was.

    Parameters
    ----------
    judged : JudgedCauses
        What stands beside the named causes alone.
    first : JudgedCauses
        Everything that the search found, each beside all others.
    alpha : float
        Significance level.
    """
    named = names_of(judged.named)
    lost = any(
        one.standing == "visible"
        and one.test.p_value < BEYOND_DOUBT
        and one.fit.effect.name not in named
        and not one.fit.effect.measurement
        for one in first.causes
    )
    noise = [
        one
        for one in first.causes
        if lost and one.fit.effect.measurement and one.test.p_value >= alpha
    ]
    return judged.with_newer(noise)
