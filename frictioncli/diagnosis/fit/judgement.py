"""An effect, or any hypothesis, as it stands beside the base."""

from dataclasses import dataclass

from frictioncli.arrays import Array
from frictioncli.diagnosis.noise.significance import Chance
from frictioncli.effects.base import Effect


@dataclass(frozen=True, slots=True)
class Score:
    """An effect fitted beside the base.

    Attributes
    ----------
    effect : Effect
        The effect.
    shape : dict of str to float
        Shape parameters.
    coefficients : ndarray, shape (coefficients,)
        Its coefficients, the base refitted.
    covariance : ndarray, shape (coefficients, coefficients)
        Their covariance for this shape.
    statistic : float
        Twice the log likelihood ratio to the base alone.
    """

    effect: Effect
    shape: dict[str, float]
    coefficients: Array
    covariance: Array
    statistic: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Judged:
    """A hypothesis as it stands at one step.

    Attributes
    ----------
    name : str
        Its name.
    shape : dict of str to float
        Shape at which it explains most.
    coefficients, covariance : ndarray
        Its coefficients there.
    statistic : float
        Twice the log likelihood ratio to the base alone, there; 0 if no shape is physical.
    p_value : float
        Probability that noise explains as much, corrected for shapes and for the number of
        hypotheses.
    evidence : float
        Logarithm of its Bayes factor, averaged over shapes.
    freedom : int
        Coefficients that the data can tell.
    chance : Chance
        What noise alone gives over all its shapes.
    size_scale : float
        RMS in its channel for a white length of 1. [N·m]
    """

    name: str
    shape: dict[str, float]
    coefficients: Array
    covariance: Array
    statistic: float
    p_value: float
    evidence: float
    freedom: int
    chance: Chance
    size_scale: float

    def score(self, effect: Effect) -> Score:
        """Return it as the score of an effect."""
        return Score(effect, self.shape, self.coefficients, self.covariance, self.statistic)
