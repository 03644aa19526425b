"""What a search found, judged by the rows seen and by a run that was held out."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.ramps.timing import TorqueTiming
from frictioncli.diagnosis.ramps.timing_rivals import TimingRivals
from frictioncli.diagnosis.search.between_runs import without_differences_of_runs
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.cause_selection import judged_together, uncertain_causes
from frictioncli.diagnosis.search.decays import with_one_decay, without_slow_recovery
from frictioncli.diagnosis.search.preparation import Preparation
from frictioncli.diagnosis.search.search_result import SearchResult
from frictioncli.diagnosis.search.shown import shown_by_residuals
from frictioncli.diagnosis.search.size_on_new_run import with_size_on_new_run
from frictioncli.diagnosis.search.standing import with_standing, without_linear_lag
from frictioncli.diagnosis.search.stated_size import sizes_beside_each_other
from frictioncli.diagnosis.search.structure import Structure
from frictioncli.diagnosis.search.timing_causes import DELAY, judged_by_timing
from frictioncli.diagnosis.search.understood import understood

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

    def without_names(self, names: Collection[str], standing: str, reason: str) -> "JudgedCauses":
        """Return them where some have lost their name.

        Parameters
        ----------
        names : collection of str
            Effects of those.
        standing, reason : str
            What they are now, and why.
        """
        causes = tuple(
            replace(one, standing=standing, reason=reason) if one.fit.effect.name in names else one
            for one in self.causes
        )
        return replace(self, causes=causes)

    def with_newer(self, newer: Sequence[Cause]) -> "JudgedCauses":
        """Return them, some as they are now.

        Parameters
        ----------
        newer : sequence of Cause
            These.
        """
        return replace(self, causes=_with(self.causes, newer))


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
        causes = with_size_on_new_run(causes, names_of(possible), found.step, self.new, self.margin)
        causes = without_linear_lag(causes, self.problem)
        causes = without_differences_of_runs(causes, found.step, self.measured[0])
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

    def without_parts(self, judged: JudgedCauses) -> tuple[JudgedCauses, Structure | None]:
        """Return causes of which none has a name that may be a part of structure, and that.

        Parameters
        ----------
        judged : JudgedCauses
            Causes with their standing.
        """
        step = judged.found.step
        kept, structure = understood(step, judged.named, self.margin, self.alpha)
        if structure is None:
            return judged, None
        reason = f"structure along {structure.axis} remains that no effect explains"
        lost = names_of(judged.named) - names_of(kept)
        return judged.without_names(lost, "visible", reason), structure

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
        certain = judged.without_names(uncertain, "undetermined", _UNCERTAIN)
        certain = certain.with_newer(without_slow_recovery(certain.named, self.problem))
        shown = [one for one in certain.causes if one.standing in ("named", "visible")]
        return certain.with_newer(with_one_decay(shown, self.problem))


def names_of(causes: Sequence[Cause]) -> set[str]:
    """Return the names of the effects that causes were found as.

    Parameters
    ----------
    causes : sequence of Cause
        The causes.
    """
    return {one.fit.effect.name for one in causes}


def _with(causes: Sequence[Cause], newer: Sequence[Cause]) -> tuple[Cause, ...]:
    """Return causes, some of them as they are now."""
    known = {one.fit.effect.name: one for one in newer}
    return tuple(known.get(one.fit.effect.name, one) for one in causes)
