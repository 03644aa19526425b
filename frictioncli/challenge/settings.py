"""Settings of a challenge: what is planted, and how often."""

from dataclasses import dataclass, field

from frictioncli.errors import OptionError
from frictioncli.options import option


@dataclass(frozen=True, slots=True, kw_only=True)
class ChallengeSettings:
    """What is planted in a log.

    Attributes
    ----------
    effects : tuple of str
        Effects to plant one at a time, each ``NAME`` or ``NAME:SIZE``; SIZE is the root mean square
        of its torque over all pairs and angle bins. Without any, each effect that the log can show
        is planted at the usual size, and the smallest size found is searched for. [torque
        unit]
    share : float
        Usual size. [% of the mean friction]
    draws : int
        Number of shapes of its law in which each effect is planted.
    seed : int
        Seed of these shapes.
    search : bool or None
        Whether the least size that is found is searched for; None: where no effects are given.
    """

    effects: tuple[str, ...] = field(
        default=(),
        metadata=option(
            "Effect to plant, repeatable; SIZE is its RMS over all pairs [torque unit]."
            " Default: every effect that the log can show, at the smallest size that is found.",
            "--effect",
            metavar="NAME[:SIZE]",
        ),
    )
    share: float = field(
        default=10.0,
        metadata=option("Size of effects given without one [% of mean friction]."),
    )
    draws: int = field(default=1, metadata=option("Number of shapes per effect."))
    seed: int = field(default=0, metadata=option("Seed of the shapes."))
    search: bool | None = field(
        default=None,
        metadata=option(
            "Search for the smallest size that is found (default: if no --effect is given).",
            "--search/--no-search",
        ),
    )

    def __post_init__(self) -> None:
        if not 0.0 < self.share <= 100.0:
            raise OptionError(f"--share {self.share:g} %: expected above 0, up to 100")
        if not 1 <= self.draws <= 100:
            raise OptionError(f"--draws {self.draws}: expected 1 to 100")
        if self.seed < 0:
            raise OptionError(f"--seed {self.seed}: expected 0 or more")
