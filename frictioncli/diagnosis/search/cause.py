"""A cause of the misfit: an effect with its test, its credible set, its size and its standing."""

from dataclasses import dataclass

from frictioncli.diagnosis.fit.hypotheses import EffectFit, HypothesisTest
from frictioncli.diagnosis.search.shown import WHOLE, Shown

CONVINCING = 3.0
"""Log Bayes factor that an effect needs: with twenty effects, any of which may be at work, e³ is
about their number. An effect below it could not be told from most others anyway."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Cause:
    """A cause found: the effect accepted, and the effects that could replace it.

    Attributes
    ----------
    fit : EffectFit
        The effect accepted, fitted beside the other causes.
    test : HypothesisTest
        Its test beside the other causes, over all its shapes.
    effects : tuple of str
        Its credible set.
    probabilities : dict of str to float
        Probability of each effect that could replace it.
    size : float
        RMS in its channel. [N·m]
    size_interval : (float, float) or None
        95 % interval of that where it is not that of what is visible, nor in proportion to an only
        coefficient of the fit. [N·m]
    visible : float
        RMS of its residual after a fit of the base model. [N·m]
    visible_interval : (float, float)
        95 % interval of that. [N·m]
    shown : Shown
        What the residuals show of it at face value.
    standing : {"named", "visible", "negligible", "undetermined"}
        What may be said of it: it is named; it stands out of the noise but is not named; it is
        smaller than the margin; its size is not known well enough.
    reason : str
        Why it is not named, in words; empty where it is.
    holds_on_new_run : bool or None
        Whether it is there on the hold-out run too; None where that cannot be tested.
    only_on_new_run : bool
        Whether it begins on the hold-out run, so that it was found and fitted there.
    """

    fit: EffectFit
    test: HypothesisTest
    effects: tuple[str, ...]
    probabilities: dict[str, float]
    size: float
    visible: float
    visible_interval: tuple[float, float] = (0.0, float("inf"))
    size_interval: tuple[float, float] | None = None
    shown: Shown = WHOLE
    standing: str = "named"
    reason: str = ""
    holds_on_new_run: bool | None = None
    only_on_new_run: bool = False
