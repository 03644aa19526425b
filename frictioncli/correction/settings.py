"""Settings of the temperature correction: schedules, and how corrections are computed."""

import math
from dataclasses import dataclass, field

from frictioncli.errors import OptionError
from frictioncli.options import numbers_option, option

READINGS = ("first_degree", "latest_degree")
"""The two workable readings of criterion (20); see :mod:`frictioncli.correction.schedule`."""

CRITERIA = (*READINGS, "none", "equal", "uncertainty")
"""Rules that decide when to correct: two readings of (20), never, evenly in time, and where the
predicted uncertainty of friction demands it."""

MIDDLE_SPEED = 2 / 3
"""Share of the highest speed at which to correct: the paper's 67.5 of 101.2 deg/s."""


SCALE_OPTION = option("Scale k of criterion (20).")
LONGEST_TIME_OPTION = option("Time that forces a correction [min].", factor=60.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class CorrectionSettings:
    """How corrections are computed and evaluated.

    Attributes
    ----------
    correction_speed : float or None
        Speed of the pairs that corrections use; None: two thirds of the highest. [deg/s]
    smoothing_degree : int
        Degree of the polynomials in motor temperature that smooth the reference of (21).
    """

    correction_speed: float | None = field(
        default=None,
        metadata=option("Speed of correction pairs [deg/s]; default: 2/3 of the highest."),
    )
    smoothing_degree: int = field(
        default=3,
        metadata=option("Degree of the polynomial that smooths friction for epsilon (21)."),
    )

    def __post_init__(self) -> None:
        if not 0 <= self.smoothing_degree <= 9:
            raise OptionError(f"smoothing degree {self.smoothing_degree}: expected 0 to 9")
        if self.correction_speed is not None and self.correction_speed <= 0:
            raise OptionError(f"correction speed {self.correction_speed:g} deg/s: expected > 0")


@dataclass(frozen=True, slots=True, kw_only=True)
class ScheduleSettings:
    """When the temperature is corrected.

    Attributes
    ----------
    criterion : str
        One of :data:`CRITERIA`.
    k : float
        Scale of criterion (20).
    tmax : float
        Time after which a correction is forced. [s]
    bound : float
        Greatest standard deviation of the predicted friction with criterion ``uncertainty``; the
        default is the error that the paper reports. [torque unit]
    """

    criterion: str = field(
        default="first_degree", metadata=option(f"When to correct: {', '.join(CRITERIA)}.")
    )
    k: float = field(default=5.0, metadata=SCALE_OPTION)
    tmax: float = field(default=3600.0, metadata=LONGEST_TIME_OPTION)
    bound: float = field(
        default=2.0,
        metadata=option(
            "For criterion uncertainty: largest predicted standard deviation of friction at the"
            " highest speed (1 sigma, as epsilon is an RMS) [torque unit]."
        ),
    )

    def __post_init__(self) -> None:
        if self.criterion not in CRITERIA:
            raise OptionError(
                f"criterion '{self.criterion}': expected one of {', '.join(CRITERIA)}"
            )
        _check_positive("k", (self.k,))
        _check_positive("tmax", (self.tmax,))
        _check_positive("bound", (self.bound,))

    @property
    def by_time(self) -> bool:
        """Whether k and tmax decide, and not the bound."""
        return self.criterion not in ("none", "uncertainty")

    def columns(self) -> dict[str, str | float]:
        """Return the columns of the tables; NaN for a parameter that the criterion does not use."""
        return {
            "criterion": self.criterion,
            "k": self.k if self.by_time else math.nan,
            "tmax": self.tmax if self.by_time else math.nan,
            "bound": self.bound if self.criterion == "uncertainty" else math.nan,
        }

    def describe(self, unit: str) -> str:
        """Return the schedule as text.

        Parameters
        ----------
        unit : str
            Unit of torque.
        """
        text = f"criterion {self.criterion}"
        if self.by_time:
            text += f", k = {self.k:g}, tmax = {self.tmax / 60:g} min"
        elif self.criterion == "uncertainty":
            text += f", bound = {self.bound:g} {unit}"
        return text


@dataclass(frozen=True, slots=True, kw_only=True)
class EvaluationGrid:
    """The schedules that ``evaluate`` compares: every k with every tmax, and every bound.

    Attributes
    ----------
    k : tuple of float
        Scales of criterion (20).
    tmax : tuple of float
        Times after which a correction is forced. [s]
    bound : tuple of float
        Bounds of criterion ``uncertainty``. [torque unit]
    """

    k: tuple[float, ...] = field(
        default=(1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 15.0, 20.0),
        metadata=numbers_option("Scales k to evaluate; repeat the option or write 1,2,5.", "--k"),
    )
    tmax: tuple[float, ...] = field(
        default=(600.0, 1200.0, 1800.0, 3600.0, 7200.0),
        metadata=numbers_option("Values of tmax to evaluate [min], as --k.", "--tmax", factor=60.0),
    )
    bound: tuple[float, ...] = field(
        default=(0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0),
        metadata=numbers_option(
            "Bounds of criterion uncertainty to evaluate [torque unit], as --k.", "--bound"
        ),
    )

    def __post_init__(self) -> None:
        _check_positive("k", self.k)
        _check_positive("tmax", self.tmax)
        _check_positive("bound", self.bound)


def _check_positive(name: str, values: tuple[float, ...]) -> None:
    bad = [value for value in values if not value > 0]
    if bad or not values:
        found = ", ".join(f"{value:g}" for value in bad) or "nothing"
        raise OptionError(f"--{name}: found {found}, expected numbers > 0")
