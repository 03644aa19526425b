"""What a search for causes found: causes, tests of all others, and what was given up again."""

from collections.abc import Sequence
from dataclasses import dataclass

from frictioncli.diagnosis.fit.hypotheses import HypothesisTest
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.confounded import unclaimed
from frictioncli.diagnosis.search.detectable_size import detectable_size
from frictioncli.diagnosis.search.effect_size import sizes_of
from frictioncli.diagnosis.search.step import Step
from frictioncli.effects import BY_NAME
from frictioncli.effects.base import Effect


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchResult:
    """Result of a search.

    Attributes
    ----------
    causes : tuple of Cause
        Causes found, strongest first.
    measurement : tuple of Cause
        Effects of the measurement that stand beside the base.
    refused : tuple of Cause
        Effects of the measurement that are impossible or not determined, with the reason.
    rejected : dict of str to HypothesisTest
        Tests of all other effects at the last step.
    dropped : dict of str to str
        Effects that were accepted and given up again, with the reason.
    step : Step
        The last step: base, causes, noise and discrepancy.
    """

    causes: tuple[Cause, ...]
    measurement: tuple[Cause, ...]
    refused: tuple[Cause, ...]
    rejected: dict[str, HypothesisTest]
    dropped: dict[str, str]
    step: Step

    def detectable_sizes(
        self, effects: Sequence[Effect], alpha: float, margin: float
    ) -> dict[str, float | None]:
        """Return the smallest RMS size of each effect that would be named four times in five.

        Parameters
        ----------
        effects : sequence of Effect
            The catalogue.
        alpha : float
            Significance level of the whole search.
        margin : float
            Smallest size worth a name. [N·m]

        Returns
        -------
        dict of str to (float or None)
            Sizes [N·m]; None where the data lack what the effect needs, cannot tell it from an
            effect of another input or do not tell where it begins, and where the base takes so
            much of it that it would have to be larger than the torque that there is.
        """
        count = max(len(self.rejected) + len(self.causes), 1)
        found: dict[str, float | None] = dict.fromkeys(effect.name for effect in effects)
        for effect in effects:
            step, test = self._beside_others(effect)
            if test is not None and not unclaimed(effect, step.problem):
                found[effect.name] = detectable_size(step, effect, test, alpha / count, margin)
        return found

    def _beside_others(self, effect: Effect) -> tuple[Step, HypothesisTest | None]:
        """Return the base with all causes but an effect, and the test of that effect there."""
        for cause in self.causes:
            if cause.fit.effect is effect:
                others = [one for one in self.step.accepted if one.effect is not effect]
                return Step.of(self.step.precomputed, others), cause.test
        return self.step, self.rejected.get(effect.name)


def given_up_causes(found: SearchResult, alpha: float) -> tuple[Cause, ...]:
    """Return effects that were accepted and given up again, and still stand out of the noise.

    Parameters
    ----------
    found : SearchResult
        Result of a search.
    alpha : float
        Significance level.
    """
    causes = []
    for name, reason in found.dropped.items():
        test = found.rejected.get(name)
        if test is None or test.p_value >= alpha:
            continue
        fit = test.effect_fit(BY_NAME[name])
        causes.append(
            Cause(
                fit=fit,
                test=test,
                effects=(name,),
                probabilities={name: 1.0},
                **sizes_of(found.step.precomputed, fit),
                standing="undetermined",
                reason=reason,
            )
        )
    return tuple(causes)
