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
    margin : float or None
        Smallest size worth a name; by default 0.5 % of the mean friction, at least 0.1 N·m.
        [torque unit]
    """

    alpha: float = field(
        default=0.05,
        metadata=option("Significance level: probability of finding a cause where there is none."),
    )
    seed: int = field(default=0, metadata=option("Seed of the simulated noise."))
    most: int = field(default=4, metadata=option("Maximum number of causes, up to 4."))
    margin: float | None = field(
        default=None,
        metadata=option(
            "Smallest size worth naming [torque unit]; default: 0.5 % of the mean friction, at"
            " least 0.1 N·m."
        ),
    )

    def __post_init__(self) -> None:
        if self.margin is not None and not self.margin >= 0:
            raise OptionError(f"margin {self.margin:g}: expected 0 or more")
        if not 0 < self.alpha < 0.5:
            raise OptionError(f"alpha {self.alpha:g}: expected between 0 and 0.5")
        if not 1 <= self.most <= 4:
            raise OptionError(f"at most {self.most} causes: expected 1 to 4")
