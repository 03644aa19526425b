"""A property of the joint beside which an effect of the measurement is physically impossible.

Of two that cancel each other one explains what is not there. Where the effect of the measurement is
clearly there without the other, the other is given up. Where it is not, nothing speaks for it: it
takes what the form of the other, which is never exact, misses, and is given up itself.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.measurement import CLEAR, measurement_causes
from frictioncli.diagnosis.search.possible import beyond_bounds
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.diagnosis.search.step import Step
from frictioncli.effects.base import Effect
from frictioncli.wording import in_words

_SURELY = 4.0
"""Standard errors by which an effect of the measurement is beyond its bounds without doubt."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Cancelling:
    """Two effects that cancel each other.

    Attributes
    ----------
    effect : EffectFit
        The property of the joint.
    measured : Cause
        The effect of the measurement, impossible beside it, with the reason.
    stands_alone : bool
        Whether the effect of the measurement is clearly there without the other.
    """

    effect: EffectFit
    measured: Cause
    stands_alone: bool

    @property
    def reason(self) -> str:
        """Why the property of the joint is given up."""
        name = in_words(self.measured.fit.effect.name)
        return f"with it, the fitted {name} would be physically impossible"


def cancelling(
    precomputed: Precomputed, beside: Sequence[Effect], accepted: Sequence[EffectFit]
) -> Cancelling | None:
    """Return an accepted effect that cancels one of the measurement, and that; None if none does.

    Beside it the effect of the measurement is physically impossible, and without it is not.

    Parameters
    ----------
    precomputed : Precomputed
        The data and the noise models.
    beside : sequence of Effect
        Effects of the measurement that stand beside the base.
    accepted : sequence of EffectFit
        Properties of the joint, the last one accepted last.
    """
    problem = precomputed.problem

    def fitted(effects: Sequence[EffectFit]) -> dict[str, Cause]:
        found = measurement_causes(Step.of(precomputed, effects), beside)
        return {one.fit.effect.name: one for one in found}

    def impossible(causes: dict[str, Cause]) -> dict[str, str]:
        reasons = {name: beyond_bounds(one.fit, problem, _SURELY) for name, one in causes.items()}
        return {name: why for name, why in reasons.items() if why}

    measured = fitted(accepted)
    reasons = impossible(measured)
    for one in reversed(accepted if reasons else ()):
        alone = fitted([other for other in accepted if other is not one])
        gone = reasons.keys() - impossible(alone).keys()
        if gone:
            name = min(gone)
            refused = replace(measured[name], standing="undetermined", reason=reasons[name])
            stands = alone[name].test.p_value < CLEAR
            return Cancelling(effect=one, measured=refused, stands_alone=stands)
    return None
