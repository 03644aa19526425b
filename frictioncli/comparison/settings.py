"""Settings of the comparison of runs."""

import re
from dataclasses import dataclass, field

from frictioncli.errors import OptionError
from frictioncli.options import option

USUAL_MARGIN = 5.0
"""Change that is to be detected where no threshold is given. [%]"""


@dataclass(frozen=True, slots=True)
class Threshold:
    """Greatest acceptable change of friction.

    Attributes
    ----------
    value : float
        Size of the change, up or down.
    unit : str
        ``%`` of the mean friction, or ``torque`` for the unit of torque.
    """

    value: float
    unit: str

    def percent(self, mean_friction: float) -> float:
        """Return the threshold in per cent of a mean friction.

        Parameters
        ----------
        mean_friction : float
            Mean friction torque. [torque unit]

        Returns
        -------
        float
            Threshold. [%]

        Examples
        --------
        >>> Threshold(1.5, "torque").percent(mean_friction=50.0)
        3.0
        """
        return self.value if self.unit == "%" else 100 * self.value / mean_friction


def threshold_of(text: str) -> Threshold:
    """Return the threshold for a text: ``3%``, or ``1.5`` in the unit of torque.

    Parameters
    ----------
    text : str
        Number, with or without a per cent sign.

    Raises
    ------
    OptionError
        If the text is neither.

    Examples
    --------
    >>> threshold_of("3%")
    Threshold(value=3.0, unit='%')
    """
    match = re.fullmatch(r"\s*(\d+(?:\.\d*)?|\.\d+)\s*(%?)\s*", text)
    if match is None:
        raise OptionError(
            f"--fail-above {text}: expected a percentage of the mean friction, as 3%, or a number"
            " in the unit of torque, as 1.5"
        )
    return Threshold(float(match[1]), match[2] or "torque")


@dataclass(frozen=True, slots=True, kw_only=True)
class ComparisonSettings:
    """How runs are compared.

    Attributes
    ----------
    joint : int or None
        Joint to compare; None: the only one that all work folders have.
    day_to_day : float
        Assumed standard deviation of friction from day to day in an unchanged joint. [%]
    fail_above : Threshold or None
        Change above which the command ends with status 3, for monitoring.
    """

    joint: int | None = field(
        default=None, metadata=option("Joint, from 1; needed where folders share several.")
    )
    day_to_day: float = field(
        default=1.0,
        metadata=option(
            "Assumed standard deviation of friction from day to day without any change [%]."
        ),
    )
    fail_above: Threshold | None = field(
        default=None,
        metadata=option(
            "Exit with status 3 if friction has risen or fallen by more than this: 3% (of the mean"
            " friction) or 1.5 (in the unit of torque, N·m or A).",
            metavar="X",
            typed=str,
            convert=threshold_of,
        ),
    )

    def __post_init__(self) -> None:
        if not 0 < self.day_to_day <= 100:
            raise OptionError(f"day-to-day {self.day_to_day:g} %: expected above 0 and up to 100")
