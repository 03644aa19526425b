"""What a search for causes found: causes, tests of all others, and what was given up again."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from frictioncli.diagnosis.fit.hypotheses import HypothesisTest
from frictioncli.diagnosis.search.catalogue import Catalogue
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.confounded import confounded, unclaimed
from frictioncli.diagnosis.search.detectable_size import SHAPES, Rules, detectable_size
from frictioncli.diagnosis.search.effect_size import sizes_of
from frictioncli.diagnosis.search.planted_rivals import PlantedRivals
from frictioncli.diagnosis.search.planted_torque import error_forms
from frictioncli.diagnosis.search.standing import level_of
from frictioncli.diagnosis.search.step import Step
from frictioncli.diagnosis.search.structure import Structure
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
    catalogue : Catalogue
        All hypotheses.
    """

    causes: tuple[Cause, ...]
    measurement: tuple[Cause, ...]
    refused: tuple[Cause, ...]
    rejected: dict[str, HypothesisTest]
    dropped: dict[str, str]
    step: Step
    catalogue: Catalogue

    @property
    def floor(self) -> float:
        """RMS of the noise of a pair's rows in the channels that are simulated [N·m]."""
        problem = self.step.problem
        channels = self.step.noise()[: 1 if problem.has_load_channel else 2]
        distance = problem.layout.distance
        return float(np.sqrt(sum(noise.unpredictable(distance) ** 2 for noise in channels)))

    def detectable_sizes(
        self,
        effects: Sequence[Effect],
        alpha: float,
        margin: float,
        structure: Structure | None = None,
    ) -> dict[str, float | None]:
        """Return the smallest RMS size of each effect that would be named in four of five shapes.

        Parameters
        ----------
        effects : sequence of Effect
            The catalogue.
        alpha : float
            Significance level of the whole search.
        margin : float
            Smallest size worth a name. [N·m]
        structure : Structure, optional
            Structure without a name.

        Returns
        -------
        dict of str to (float or None)
            Sizes [N·m]; None where the data lack what the effect needs, cannot tell it from an
            effect of another input or do not tell where it begins, and where it would have to be
            larger than half of the torque that there is, or where something like it that may be
            noise is there already.
        """
        count = max(len(self.rejected) + len(self.causes), 1)
        found: dict[str, float | None] = dict.fromkeys(effect.name for effect in effects)
        rules = Rules(
            level=alpha / count,
            margin=margin,
            structure=structure,
            unnamed=frozenset(one.name for one in effects if confounded(one, self.step.problem)),
            forms=error_forms(self.step.problem, SHAPES),
        )
        rivals = PlantedRivals(self.step, self.catalogue, frozenset(self.dropped))
        known = {cause.fit.effect.name: cause for cause in self.causes}
        for effect in effects:
            if unclaimed(effect, self.step.problem):
                continue
            cause = known.get(effect.name)
            if cause is not None and cause.test.p_value < level_of(effect, alpha):
                beside = replace(rivals, step=self._without(cause))
                found[effect.name] = detectable_size(effect, cause.test, rules, beside)
            elif cause is None and effect.name in self.rejected:
                test = self.rejected[effect.name]
                found[effect.name] = detectable_size(effect, test, rules, rivals)
        return found

    def may_be_noise(self, effect: Effect, alpha: float) -> bool:
        """Return whether these data show something like an effect that may be noise.

        Parameters
        ----------
        effect : Effect
            The effect.
        alpha : float
            Significance level of the whole search.
        """
        return any(
            one.fit.effect.name == effect.name and one.test.p_value >= level_of(effect, alpha)
            for one in self.causes
        )

    def _without(self, cause: Cause) -> Step:
        """Return base and all other causes, as if a cause were not in the data."""
        others = [one for one in self.step.accepted if one.effect.name != cause.fit.effect.name]
        step, fit = Step.of(self.step.precomputed, others), cause.fit
        return step.planted(step.problem.basis(fit.effect, fit.shape), -fit.coefficients)


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
