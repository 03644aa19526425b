"""Settings of the stage ``fit``."""

from dataclasses import dataclass

from frictioncli.errors import OptionError

METHODS = ("joint", "paper")
TEMPERATURES = ("motor", "housing", "mean")


@dataclass(frozen=True, slots=True, kw_only=True)
class FitSettings:
    """How the model is identified.

    Attributes
    ----------
    method : {"joint", "paper"}
        All parameters at once from all pairs, or consecutively as in the source paper.
    temperature : {"auto", "motor", "housing", "mean"}
        The temperature that the friction function is given; ``auto`` is the motor's, and for the
        paper's method its mean with the housing's where the log has that.
    """

    method: str = "joint"
    temperature: str = "auto"

    def __post_init__(self) -> None:
        allowed_temperatures = ("auto", *TEMPERATURES)
        for value, allowed in ((self.method, METHODS), (self.temperature, allowed_temperatures)):
            if value not in allowed:
                raise OptionError(f"'{value}' is not one of {', '.join(allowed)}")
