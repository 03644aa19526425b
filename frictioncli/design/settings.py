"""Settings of the command ``plan``."""

import math
from dataclasses import dataclass, field

from frictioncli.errors import OptionError
from frictioncli.options import option

PROGRAMS = ("csv", "krl", "urscript")
"""Forms of the robot program."""

GREATEST_SPEED = 360.0
"""Greatest speed that may be set. [deg/s]"""

GREATEST_ANGLE = 360.0
"""Greatest absolute angle that may be set. [deg]"""

AXES = (1, 6)
"""Least and greatest axis number."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PlanSettings:
    """Time budget, limits that the user sets, and form of the robot program.

    Attributes
    ----------
    minutes : float
        Total time with the check on the next day. [min]
    low, high : float or None
        Range of the angle; None: the measured one. [deg]
    max_speed : float or None
        Highest speed; None: the highest measured. [deg/s]
    max_temperature : float or None
        Motor temperature at which heating moves end; None: the highest measured, at least 65 °C
        [°C].
    payload : tuple of float
        Payloads that may be mounted; none: the mounted one stays. [kg]
    to : {"csv", "krl", "urscript"}
        Form of the robot program.
    rated_speed : float or None
        Speed of the axis at 100 %; KUKA programs state speeds in whole per cent of it. [deg/s]
    joint : int or None
        Joint to plan for; None: the one with the most pairs.
    seed : int
        Seed of the random order of speeds.
    """

    minutes: float = field(
        default=45.0,
        metadata=option("Total time, including the check on the next day [min]."),
    )
    low: float | None = field(
        default=None, metadata=option("Lowest angle [deg]; default: lowest measured.", "--from")
    )
    high: float | None = field(
        default=None,
        metadata=option("Highest angle [deg]; default: highest measured.", "--to-angle"),
    )
    max_speed: float | None = field(
        default=None, metadata=option("Highest speed [deg/s]; default: highest measured.")
    )
    max_temperature: float | None = field(
        default=None,
        metadata=option(
            "Motor temperature at which heating ends [°C]; default: highest measured, at least 65."
        ),
    )
    payload: tuple[float, ...] = field(
        default=(), metadata=option("Payload that may be mounted [kg], repeatable.")
    )
    to: str = field(default="csv", metadata=option(f"Robot program: {', '.join(PROGRAMS)}."))
    rated_speed: float | None = field(
        default=None,
        metadata=option("Speed of the axis at 100 % [deg/s]; KUKA programs need it."),
    )
    joint: int | None = field(
        default=None,
        metadata=option(
            "Joint to plan for, from 1; default: the one with most pairs.", "--joint", "--axis"
        ),
    )
    seed: int = field(default=0, metadata=option("Seed of the random order of speeds."))

    def __post_init__(self) -> None:
        given = (self.low, self.high, self.max_speed, self.max_temperature, self.rated_speed)
        numbers = [self.minutes, *self.payload, *(one for one in given if one is not None)]
        if not all(map(math.isfinite, numbers)):
            raise OptionError("an option of the plan is not a number; expected finite numbers")
        if not 5.0 <= self.minutes <= 24 * 60.0:
            raise OptionError(f"--minutes {self.minutes:g}: expected 5 to 1440")
        for name, angle in (("from", self.low), ("to-angle", self.high)):
            if angle is not None and abs(angle) > GREATEST_ANGLE:
                raise OptionError(
                    f"--{name} {angle:g} deg: expected -{GREATEST_ANGLE:g} to {GREATEST_ANGLE:g}"
                )
        if self.low is not None and self.high is not None and self.low >= self.high:
            raise OptionError(
                f"--from {self.low:g} and --to-angle {self.high:g} deg: expected the lower angle"
                " first, and a stroke between them"
            )
        for name, speed in (("max-speed", self.max_speed), ("rated-speed", self.rated_speed)):
            if speed is not None and not 0 < speed <= GREATEST_SPEED * (1 + (name[0] == "r")):
                raise OptionError(
                    f"--{name} {speed:g} deg/s: expected more than 0 and at most"
                    f" {GREATEST_SPEED * (1 + (name[0] == 'r')):g}"
                )
        if self.max_temperature is not None and not 20 <= self.max_temperature <= 100:
            raise OptionError(f"--max-temperature {self.max_temperature:g} °C: expected 20 to 100")
        if any(not 0 <= mass <= 1000 for mass in self.payload):
            raise OptionError("--payload: expected masses of 0 to 1000 kg")
        if self.to not in PROGRAMS:
            raise OptionError(f"--to {self.to}: expected one of {', '.join(PROGRAMS)}")
        if self.to == "krl" and self.rated_speed is None:
            raise OptionError(
                "--to krl: KUKA programs state speeds in per cent of the axis' rated speed; give it"
                " with --rated-speed (in deg/s, see the robot's data sheet)"
            )
        if self.joint is not None and not AXES[0] <= self.joint <= AXES[1]:
            raise OptionError(f"--joint {self.joint}: expected {AXES[0]} to {AXES[1]}")
