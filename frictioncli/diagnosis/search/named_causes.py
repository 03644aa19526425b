"""From what a search found to the causes that are named, and what stands beside them.

What the search accepted and nobody names extends no model. It must not take from the measurement
what corrects the log, nor from the noise what the model leaves: both are judged anew beside the
named causes alone, until all that stands there has a name.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.ramps.timing import TorqueTiming
from frictioncli.diagnosis.ramps.timing_rivals import TimingRivals
from frictioncli.diagnosis.search.between_runs import without_differences_of_runs
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.cause_selection import (
    BEYOND_DOUBT,
    judged_together,
    uncertain_causes,
)
from frictioncli.diagnosis.search.decays import with_one_decay
from frictioncli.diagnosis.search.lack_of_fit import Structure
from frictioncli.diagnosis.search.measurement import measurement_causes
from frictioncli.diagnosis.search.preparation import Preparation
from frictioncli.diagnosis.search.search_result import SearchResult
from frictioncli.diagnosis.search.shown import shown_by_residuals
from frictioncli.diagnosis.search.size_on_new_run import with_size_on_new_run
from frictioncli.diagnosis.search.standing import with_standing, without_linear_lag
from frictioncli.diagnosis.search.stated_size import sizes_beside_each_other
from frictioncli.diagnosis.search.step import Step
from frictioncli.diagnosis.search.timing_causes import DELAY, judged_by_timing
from frictioncli.diagnosis.search.torque_scale import with_torque_scale
from frictioncli.diagnosis.search.understood import structure_beside, understood
from frictioncli.diagnosis.search.without_a_name import (
    beyond_doubt_without_a_name,
    change_over_time,
)
from frictioncli.effects.thermal_lag import EFFECT as THERMAL_LAG

_UNCERTAIN = "its coefficient in the extended model may be zero"


@dataclass(frozen=True, slots=True, kw_only=True)
class JudgedCauses:
    """What a search found, judged by the rows seen and by a run that was held out.

    Attributes
    ----------
    found : SearchResult
        What the search found.
    causes : tuple of Cause
        Everything, with its standing.
    timing : TimingRivals or None
        By how much the torque is late, and whether by a delay or a filter.
    """

    found: SearchResult
    causes: tuple[Cause, ...]
    timing: TimingRivals | None

    @property
    def named(self) -> tuple[Cause, ...]:
        """What has a name."""
        return tuple(one for one in self.causes if one.standing == "named")


@dataclass(frozen=True, slots=True, kw_only=True)
class Judging:
    """Rows and demands by which causes are judged.

    Attributes
    ----------
    problem, new : Problem, Problem or None
        The rows seen, and those of a run that was held out.
    measured : (Problem, Problem or None)
        The same about the measured temperature, where a lag of the gear has moved it.
    preparation : Preparation
        What is known of these problems.
    starts : TorqueTiming or None
        Delay and filter by the starts of moves.
    margin : float
        Smallest size worth a name. [N·m]
    alpha : float
        Significance level.
    """

    problem: Problem
    new: Problem | None
    measured: tuple[Problem, Problem | None]
    preparation: Preparation
    starts: TorqueTiming | None
    margin: float
    alpha: float

    def judged(self, found: SearchResult) -> JudgedCauses:
        """Return what a search found with its standing.

        Parameters
        ----------
        found : SearchResult
            What the search found.
        """
        everything = (*self._with_shown(found), *found.causes)
        # without a margin only what is doubtful for other reasons has no name
        at_all = with_standing(everything, self.problem, 0.0, self.alpha)
        possible = [
            one for one in at_all if one.standing == "named" and not one.fit.effect.measurement
        ]
        sized = sizes_beside_each_other(
            possible, found.step, found.measurement, self.measured[0], self.margin
        )
        first = with_standing(_with(everything, sized), self.problem, self.margin, self.alpha)
        causes, timing = judged_by_timing(first, self.starts)
        causes = with_size_on_new_run(causes, _names(possible), found.step, self.new, self.margin)
        causes = without_linear_lag(causes, self.problem)
        causes = without_differences_of_runs(causes, found.step)
        named = [cause for cause in causes if cause.standing == "named"]
        held = judged_together(named, found.step, self.problem, self.new)
        return JudgedCauses(found=found, causes=_with(causes, held), timing=timing)

    def _with_shown(self, found: SearchResult) -> tuple[Cause, ...]:
        """Return the effects of the measurement; of significant ones, with what residuals show.

        A delay that the starts of moves show need not show there: friction that grows with speed
        may hide it.
        """
        step, beside = found.step, found.measurement
        known = {DELAY} if self.starts is not None and self.starts.best != "none" else set()
        return tuple(
            replace(
                one,
                shown=shown_by_residuals(
                    step.precomputed,
                    one.fit,
                    [*step.accepted, *(other.fit for other in beside if other is not one)],
                ),
            )
            if one.test.p_value < self.alpha and one.fit.effect.name not in known
            else one
            for one in beside
        )

    def without_lag(self) -> "Judging":
        """Return the same about the measured temperature."""
        problem, new = self.measured
        return replace(self, problem=problem, new=new)

    def without_uncertain(self, judged: JudgedCauses) -> JudgedCauses:
        """Return causes of which none has a name whose coefficient may be zero.

        Parameters
        ----------
        judged : JudgedCauses
            Causes with their standing.
        """
        weighted_fit = judged.found.step.predicting_fit()
        uncertain = uncertain_causes(judged.named, self.problem, weighted_fit)
        if judged.timing is not None and judged.timing.best != "none":
            # what the starts of moves tell of the delay counts, too
            uncertain -= {DELAY}
        certain = _unnamed(judged, uncertain, "undetermined", _UNCERTAIN)
        once = with_one_decay(certain.named, self.problem)
        return replace(certain, causes=_with(certain.causes, once))


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
    kept, structure = understood(step, first.named, judging.margin, judging.alpha)
    judged = first
    if structure is not None:
        lost = _names(first.named) - _names(kept)
        reason = f"structure along {structure.axis} remains that no effect explains"
        judged = _unnamed(first, lost, "visible", reason)
    judged = judging.without_uncertain(judged)
    lost_on_the_way: tuple[Cause, ...] = ()
    while not _all_named(judged):
        unnamed = [one for one in judged.causes if one.standing != "named"]
        lost_on_the_way += tuple(one for one in unnamed if not one.fit.effect.measurement)
        if THERMAL_LAG.name not in _names(judged.named):
            judging = judging.without_lag()
        judged = judging.without_uncertain(judging.judged(_beside_named(judging, judged)))
        judged = without_imitations(judged, first, judging.alpha)
    others = [one for one in judged.causes if one.standing != "named"]
    rows = [judging.problem] if judging.new is None else [judging.problem, judging.new]
    scaled = with_torque_scale(judged.named, judged.found.step, rows)
    if scaled.step is not step:
        # what lost its name was a part of the structure, or all of it
        left = structure_beside(scaled.step, scaled.causes, judging.margin, judging.alpha)
        structure = left if scaled.step is not judged.found.step else left or structure
    there = beyond_doubt_without_a_name(first.causes, _names(judged.named), judging.margin)
    if structure is None and all(one.fit.effect.measurement for one in scaled.causes):
        structure = change_over_time(there)
    return NamedCauses(
        causes=scaled.causes,
        others=(*others, *lost_on_the_way, *scaled.replaced),
        structure=structure,
        measurement=judged.found.measurement,
        timing=judged.timing,
        step=scaled.step,
    )


def _all_named(judged: JudgedCauses) -> bool:
    """Return whether all that stands beside the base is named, or of the measurement."""
    accepted = judged.found.step.accepted
    return {one.effect.name for one in accepted} <= _names(judged.named)


def _beside_named(judging: Judging, judged: JudgedCauses) -> SearchResult:
    """Return what was found as it is beside the named causes alone."""
    found, names = judged.found, _names(judged.named)
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
    named = _names(judged.named)
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
    return replace(judged, causes=_with(judged.causes, noise))


def _unnamed(
    judged: JudgedCauses, names: Iterable[str], standing: str, reason: str
) -> JudgedCauses:
    """Return causes of which some have lost their name."""
    lost = frozenset(names)
    causes = tuple(
        replace(one, standing=standing, reason=reason) if one.fit.effect.name in lost else one
        for one in judged.causes
    )
    return replace(judged, causes=causes)


def _with(causes: Sequence[Cause], newer: Sequence[Cause]) -> tuple[Cause, ...]:
    """Return causes, some of them as they are now."""
    known = {one.fit.effect.name: one for one in newer}
    return tuple(known.get(one.fit.effect.name, one) for one in causes)


def _names(causes: Sequence[Cause]) -> set[str]:
    return {one.fit.effect.name for one in causes}
