"""Settings of the diagnosis."""

from dataclasses import dataclass, field

from frictioncli.errors import OptionError
from frictioncli.options import option


@dataclass(frozen=True, slots=True, kw_only=True)
class DiagnosisSettings:
    """Significance level and limits of the search for causes.

    Attributes
    ----------
    alpha : float
        Greatest probability of finding any cause where there is none (family-wise error rate). [-]
    seed : int
        Seed of the simulated noise.
    most : int
        Greatest number of causes.
    """

    alpha: float = field(
        default=0.05, metadata=option("Chance of finding a cause where there is none.")
    )
    seed: int = field(default=0, metadata=option("Seed of the simulated noise."))
    most: int = field(default=4, metadata=option("Greatest number of causes, up to 4."))

    def __post_init__(self) -> None:
        if not 0 < self.alpha < 0.5:
            raise OptionError(f"alpha {self.alpha:g}: expected between 0 and 0.5")
        if not 1 <= self.most <= 4:
            raise OptionError(f"at most {self.most} causes: expected 1 to 4")
