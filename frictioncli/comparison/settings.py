"""Settings of the stage ``compare``."""

import re
from dataclasses import dataclass

from frictioncli.errors import OptionError

USUAL_MARGIN = 5.0
"""Change that should not go unseen, where no threshold is given. [%]"""


@dataclass(frozen=True, slots=True)
class Threshold:
    """A change of friction that is too much.

    Attributes
    ----------
    value : float
        How much, whatever the direction.
    unit : str
        ``%`` of the mean friction, or ``torque`` for the torque's unit.
    """

    value: float
    unit: str

    def percent(self, mean_friction: float) -> float:
        """Return it as a share of a mean friction in the torque's unit. [%]."""
        return self.value if self.unit == "%" else 100 * self.value / mean_friction


@dataclass(frozen=True, slots=True, kw_only=True)
class ComparisonSettings:
    """How runs are compared.

    Attributes
    ----------
    joint : int or None
        Joint to compare; none if the work folders have one in common.
    day_to_day : float
        Assumed standard deviation of a joint's friction from day to day without any change. [%]
    fail_above : Threshold or None
        Change that is a finding for a monitoring job.
    """

    joint: int | None = None
    day_to_day: float = 1.0
    fail_above: Threshold | None = None

    def __post_init__(self) -> None:
        if not 0 < self.day_to_day <= 100:
            raise OptionError(f"day-to-day {self.day_to_day:g} %: expected above 0 and up to 100")


def threshold_of(text: str) -> Threshold:
    """Return the threshold that a text means: ``3%``, or ``1.5`` in the torque's unit.

    Raises
    ------
    OptionError
        If it is neither.
    """
    found = re.fullmatch(r"\s*(\d+\.?\d*|\.\d+)\s*(%?)\s*", text)
    if found is None:
        raise OptionError(
            f"--fail-above {text}: expected a percentage of the mean friction, as 3%, or a number"
            " in the unit of torque, as 1.5"
        )
    return Threshold(float(found[1]), found[2] or "torque")
