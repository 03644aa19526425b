"""Settings of the identification."""

from dataclasses import dataclass, field

from frictioncli.errors import OptionError
from frictioncli.options import option

METHODS = ("joint", "paper")
TEMPERATURES = ("motor", "housing", "mean")

LEAST_PAIRS = 3
"""Least number of pairs for a fit."""

LEAST_OPPOSING = 0.8
"""Least share of pairs in which friction opposes the motion."""


def not_opposing(share: float) -> str:
    """Return what is said where friction opposes the motion in a share of the pairs only."""
    return (
        f"it opposes motion in {100 * share:.0f} % of the pairs only: has friction already been"
        " removed from this torque, or is it another joint's? Try the other torque or current"
        " columns"
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class FitSettings:
    """How the friction model is identified.

    Attributes
    ----------
    method : {"joint", "paper"}
        All parameters at once from all pairs, or one after the other as in the paper.
    temperature : {"auto", "motor", "housing", "mean"}
        Temperature that friction depends on. ``auto`` is the motor temperature, or that of the
        housing where the log has no other; with method ``paper`` it is the mean of both where the
        log has both.
    """

    method: str = field(default="joint", metadata=option(f"Identification: {', '.join(METHODS)}."))
    temperature: str = field(
        default="auto",
        metadata=option(f"Temperature in the model: auto, {', '.join(TEMPERATURES)}."),
    )

    def __post_init__(self) -> None:
        allowed_temperatures = ("auto", *TEMPERATURES)
        for value, allowed in ((self.method, METHODS), (self.temperature, allowed_temperatures)):
            if value not in allowed:
                raise OptionError(f"'{value}' is not one of {', '.join(allowed)}")
