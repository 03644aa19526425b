"""Settings of the stage ``diagnose``."""

from dataclasses import dataclass

from frictioncli.errors import OptionError


@dataclass(frozen=True, slots=True, kw_only=True)
class DiagnosisSettings:
    """How sure a finding must be.

    Attributes
    ----------
    alpha : float
        Greatest probability of finding any cause where there is none.
    seed : int
        Seed of the simulated noise.
    most : int
        Greatest number of causes.
    """

    alpha: float = 0.05
    seed: int = 0
    most: int = 4

    def __post_init__(self) -> None:
        if not 0 < self.alpha < 0.5:
            raise OptionError(f"alpha {self.alpha:g}: expected between 0 and 0.5")
        if not 1 <= self.most <= 4:
            raise OptionError(f"at most {self.most} causes: expected 1 to 4")
