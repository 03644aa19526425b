"""Settings of reading logs."""

import math
from dataclasses import dataclass, field
from pathlib import Path

from frictioncli.errors import OptionError
from frictioncli.logs.channels import units
from frictioncli.logs.channels.channel_names import MAX_JOINT
from frictioncli.options import NO_OPTION, option

AUTO = "auto"
"""In place of a torque constant: it is found from a torque that is logged beside the current."""


def torque_constant(text: str) -> float | str:
    """Return a torque constant as it is typed: ``auto``, or a number.

    Raises
    ------
    OptionError
        If it is neither.
    """
    if text.strip().lower() == AUTO:
        return AUTO
    try:
        return float(text)
    except ValueError:
        raise OptionError(f"torque constant {text!r}: expected auto, or N·m/A, not 0") from None


@dataclass(frozen=True, kw_only=True)
class IngestSettings:
    """What is to be read, and what the logs do not say; None is found from the logs.

    Attributes
    ----------
    joints : tuple of int or None
        Joints to read, from 1; None for every joint with a torque channel.
    map_file : Path or None
        Mapping file, see :mod:`frictioncli.logs.channels.channel_map`.
    gear_ratio : float or None
        Motor turns per joint turn, negative if motor and joint turn in opposite directions. [-]
    rated_torque : float or None
        Torque that 100 % stands for, where torques are in percent. [N·m]
    torque_constant : float or str or None
        Torque at the joint per motor current, negative if the current counts the other way; or
        ``auto``. [N·m/A]
    time_unit, position_unit, velocity_unit, torque_unit, temperature_unit : str or None
        Unit of that quantity in the logs, whatever their headers say: s, ms, us; deg, rad, udeg;
        deg/s, rad/s, rpm, mdeg/s; N·m, mN·m, A, mA, %; °C, K, °F, m°C, mK.
    batch_bytes : int
        Size of the part of a log that is held in memory at once. [byte]
    """

    joints: tuple[int, ...] | None = field(
        default=None,
        metadata=option("Joint to read, from 1; repeatable. Default: all with torque.", "--joint"),
    )
    map_file: Path | None = field(
        default=None,
        metadata=option("TOML file that names channels and units, or time=1,...", "--map"),
    )
    gear_ratio: float | None = field(
        default=None, metadata=option("Motor turns per joint turn, for motor-side channels.")
    )
    rated_torque: float | None = field(
        default=None, metadata=option("Torque at 100 %, for torques in % [N·m].")
    )
    torque_constant: float | str | None = field(
        default=None,
        metadata=option(
            "Torque at the joint per motor current [N·m/A], or auto: from a torque in the same"
            " log.",
            typed=str,
            metavar="auto|VALUE",
            convert=torque_constant,
        ),
    )
    time_unit: str | None = field(default=None, metadata=option("Force the unit: s, ms, us."))
    position_unit: str | None = field(
        default=None, metadata=option("Force the unit: deg, rad, udeg.")
    )
    velocity_unit: str | None = field(
        default=None, metadata=option("Force the unit: deg/s, rad/s, rpm.")
    )
    torque_unit: str | None = field(
        default=None, metadata=option("Force the unit: N·m (or Nm), mNm, A, mA, %.")
    )
    temperature_unit: str | None = field(
        default=None, metadata=option("Force the unit: degC, K, degF.")
    )
    batch_bytes: int = field(default=1 << 22, metadata=NO_OPTION)

    def __post_init__(self) -> None:
        if self.joints is not None and not (
            self.joints and all(1 <= joint <= MAX_JOINT for joint in self.joints)
        ):
            given = ", ".join(map(str, self.joints)) or "none"
            raise OptionError(f"joints {given}: expected joint numbers from 1 to {MAX_JOINT}")
        if self.gear_ratio is not None and (
            not math.isfinite(self.gear_ratio) or self.gear_ratio == 0
        ):
            raise OptionError(
                f"gear ratio {self.gear_ratio}: expected motor turns per joint turn, not 0"
            )
        if self.rated_torque is not None and not 0 < self.rated_torque < math.inf:
            raise OptionError(f"rated torque {self.rated_torque}: expected N·m, > 0")
        constant = self.torque_constant
        if isinstance(constant, str) and constant != AUTO:
            raise OptionError(f"torque constant {constant!r}: expected auto, or N·m/A, not 0")
        if isinstance(constant, float | int) and (not math.isfinite(constant) or constant == 0):
            raise OptionError(f"torque constant {constant:g}: expected auto, or N·m/A, not 0")
        if self.batch_bytes < 1:
            raise OptionError(f"batch size {self.batch_bytes}: expected at least 1 byte")
        self.forced_units()

    def forced_units(self) -> dict[str, str]:
        """Return the units that the user has set, by canonical name of the channel.

        Raises
        ------
        OptionError
            If a unit is not known.
        """
        given = {
            "time": self.time_unit,
            "position": self.position_unit,
            "velocity": self.velocity_unit,
            "torque": self.torque_unit,
            "motor_temperature": self.temperature_unit,
            "housing_temperature": self.temperature_unit,
        }
        forced: dict[str, str] = {}
        for quantity, text in given.items():
            if text is None:
                continue
            unit = units.canonical(text, quantity)
            if unit is None or unit not in units.FACTORS[quantity]:
                raise OptionError(
                    f"{quantity.replace('_', ' ')} unit {text!r}: expected one of"
                    f" {', '.join(units.FACTORS[quantity])}"
                )
            forced[quantity] = unit
        return forced

    def as_dict(self) -> dict[str, object]:
        """Return plain values for the provenance of a table."""
        map_name = "" if self.map_file is None else str(self.map_file)
        # a map in one line is its own text
        map_name = map_name if "=" in map_name else map_name.replace("\\", "/").rpartition("/")[2]
        return {
            "joints": None if self.joints is None else list(self.joints),
            "map_file": map_name or None,
            "gear_ratio": self.gear_ratio,
            "rated_torque": self.rated_torque,
            "torque_constant": self.torque_constant,
            "units": self.forced_units(),
        }
