"""Settings of segmentation, pairing and separation."""

from dataclasses import dataclass, field
from pathlib import Path

from frictioncli.errors import OptionError
from frictioncli.options import option

_SETTLING = 0.2
"""Time dropped after an acceleration, if not told otherwise. [s]"""

_SHARE = 0.25
"""Greatest share of a segment that this may be: more would leave little of fast moves."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SteadySettings:
    """What counts as motion at constant speed.

    Attributes
    ----------
    min_speed : float
        Speed below which the joint is at rest. [deg/s]
    speed_tolerance : float
        Greatest deviation from the speed of a segment, relative to it; more is allowed where the
        noise of the velocity is larger. [-]
    settling : float
        Time dropped after an acceleration, at most :attr:`settling_share` of the segment, and once
        more after the ringing of a servo that goes on beyond it. [s]
    min_samples : int
        Least number of samples of a constant-speed segment.
    """

    min_speed: float = field(
        default=0.2, metadata=option("Speed below which the joint is at rest [deg/s].")
    )
    speed_tolerance: float = field(
        default=0.02, metadata=option("Allowed deviation from constant speed [fraction of it].")
    )
    settling: float = field(
        default=_SETTLING,
        metadata=option(
            "Time dropped after acceleration [s]; at most a quarter of a constant-speed part, more"
            " in proportion if set above the default."
        ),
    )
    min_samples: int = field(
        default=3, metadata=option("Minimum number of samples of a constant-speed part.")
    )

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

    @property
    def settling_share(self) -> float:
        """Greatest share of a segment that is dropped: a quarter, more of a longer time [-].

        Whose link still rings when the usual time is over can so drop all that rings, at the cost
        of the fastest moves.
        """
        return min(_SHARE * max(self.settling / _SETTLING, 1.0), 1.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class PairingSettings:
    """What makes two segments of opposite direction a pair.

    Attributes
    ----------
    steady : SteadySettings
        What counts as motion at constant speed.
    bin_width : float
        Width of the angle bins. [deg]
    same_speed : float
        Greatest difference of speed, relative to it. [-]
    same_temperature : float
        Greatest difference of motor temperature. [K]
    longest_pause : float
        Longest time between the end of one segment and the start of the other. [s]
    """

    steady: SteadySettings = field(default_factory=SteadySettings)
    bin_width: float = field(default=5.0, metadata=option("Width of the angle bins [deg]."))
    same_speed: float = field(
        default=0.03, metadata=option("Largest difference of speed between partners [fraction].")
    )
    same_temperature: float = field(
        default=2.0, metadata=option("Largest difference of temperature between partners [°C].")
    )
    longest_pause: float = field(
        default=600.0, metadata=option("Longest pause between partners [s].")
    )

    def __post_init__(self) -> None:
        if not 0 < self.bin_width <= 180:
            raise OptionError(f"bin width {self.bin_width:g} deg: expected between 0 and 180")
        if not 0 < self.same_speed < 0.5:
            raise OptionError(f"speed difference {self.same_speed:g}: expected between 0 and 0.5")


_SIGNS = {"auto": None, "+1": 1, "1": 1, "+": 1, "-1": -1, "-": -1}


def sign_number(text: str) -> int | None:
    """Return the sign of friction for the text of ``--sign``; None for ``auto``.

    Parameters
    ----------
    text : str
        As typed.

    Raises
    ------
    OptionError
        If the text is no sign.
    """
    if text not in _SIGNS:
        raise OptionError(f"--sign {text}: expected auto, +1 or -1")
    return _SIGNS[text]


WAYS = ("auto", "pairs", "regression")
"""How friction torque may be separated from load torque."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SeparationSettings:
    """How friction torque is separated from load torque.

    Attributes
    ----------
    by : {"auto", "pairs", "regression"}
        ``pairs``: by equation (8) in pairs of moves at constant speed. ``regression``: by
        regression of all samples in motion. ``auto``: the former, and the latter for a joint of
        which too few pairs were found.
    urdf : Path or None
        Kinematics of the arm, for a regression of joints that move together.
    sign : {1, -1} or None
        Sign of friction in forward motion. 1: torque is load + friction; -1: load - friction;
        None: found from the data.
    """

    by: str = field(
        default="auto",
        metadata=option(
            "Method: pairs of moves at constant speed, regression of all motion, or auto"
            " (regression where pairs are too few)."
        ),
    )
    urdf: Path | None = field(
        default=None,
        metadata=option("Kinematics of the arm, for a regression of joints that move together."),
    )
    sign: int | None = field(
        default=None,
        metadata=option(
            "Torque in forward motion: +1 load + friction, -1 load - friction, auto.",
            typed=str,
            default="auto",
            convert=sign_number,
        ),
    )

    def __post_init__(self) -> None:
        if self.by not in WAYS:
            raise OptionError(f"--by {self.by}: expected {', '.join(WAYS)}")
