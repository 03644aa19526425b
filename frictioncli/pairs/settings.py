"""Settings of the stage ``pair``."""

from dataclasses import dataclass, field

from frictioncli.errors import OptionError


@dataclass(frozen=True, slots=True, kw_only=True)
class SteadySettings:
    """What counts as constant velocity.

    Attributes
    ----------
    min_speed : float
        Below this the joint stands. [deg/s]
    speed_tolerance : float
        Greatest departure from the plateau's speed, as a share of it, where noise asks for less.
    settling : float
        Time dropped after acceleration ends, at most a quarter of the plateau. [s]
    min_samples : int
        Least number of samples of a constant-velocity part.
    """

    min_speed: float = 0.2
    speed_tolerance: float = 0.02
    settling: float = 0.2
    min_samples: int = 3

    def __post_init__(self) -> None:
        if self.min_speed <= 0 or not 0 < self.speed_tolerance < 0.5:
            raise OptionError(
                f"minimum speed {self.min_speed:g} deg/s and speed tolerance"
                f" {self.speed_tolerance:g}: expected > 0, and between 0 and 0.5"
            )
        if self.settling < 0 or self.min_samples < 2:
            raise OptionError(
                f"settling {self.settling:g} s and minimum of {self.min_samples} samples: expected"
                " >= 0 s and at least 2"
            )


@dataclass(frozen=True, slots=True, kw_only=True)
class PairingSettings:
    """What makes two counter-directed spans a pair.

    Attributes
    ----------
    steady : SteadySettings
        What counts as constant velocity.
    bin_width : float
        Width of the angle bins. [deg]
    same_speed : float
        Greatest difference of speed, as a share of it.
    same_temperature : float
        Greatest difference of motor temperature. [°C]
    longest_pause : float
        Greatest time between the end of one span and the start of the other. [s]
    """

    steady: SteadySettings = field(default_factory=SteadySettings)
    bin_width: float = 5.0
    same_speed: float = 0.03
    same_temperature: float = 2.0
    longest_pause: float = 600.0

    def __post_init__(self) -> None:
        if not 0 < self.bin_width <= 180:
            raise OptionError(f"bin width {self.bin_width:g} deg: expected between 0 and 180")
        if not 0 < self.same_speed < 0.5:
            raise OptionError(f"speed difference {self.same_speed:g}: expected between 0 and 0.5")
