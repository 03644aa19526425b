"""What the user can tell ``ingest`` beyond the logs themselves."""

import math
from dataclasses import dataclass
from pathlib import Path

from frictioncli.errors import OptionError
from frictioncli.logs.channels import units


@dataclass(frozen=True, kw_only=True)
class IngestSettings:
    """Settings of reading; what is None is found from the logs.

    Attributes
    ----------
    joints : tuple of int or None
        Joints to read, counted from 1; None for every joint with a torque channel.
    map_file : Path or None
        Mapping file, see :mod:`frictioncli.logs.channels.channel_map`.
    gear_ratio : float or None
        Motor turns per joint turn, negative where they turn against each other. [-]
    time_unit, position_unit, velocity_unit, torque_unit, temperature_unit : str or None
        Unit in which the logs hold that quantity, whatever they say: s, ms, us; deg, rad, udeg;
        deg/s, rad/s, rpm, mdeg/s; N·m, mN·m, A, mA; °C, K, °F, m°C, mK.
    batch_bytes : int
        How much of a log is held in memory at a time. [byte]
    """

    joints: tuple[int, ...] | None = None
    map_file: Path | None = None
    gear_ratio: float | None = None
    time_unit: str | None = None
    position_unit: str | None = None
    velocity_unit: str | None = None
    torque_unit: str | None = None
    temperature_unit: str | None = None
    batch_bytes: int = 1 << 22

    def __post_init__(self) -> None:
        if self.joints is not None and (not self.joints or min(self.joints) < 1):
            raise OptionError(f"joints {self.joints}: expected joint numbers from 1")
        if self.gear_ratio is not None and (
            not math.isfinite(self.gear_ratio) or self.gear_ratio == 0
        ):
            raise OptionError(
                f"gear ratio {self.gear_ratio}: expected motor turns per joint turn, not 0"
            )
        if self.batch_bytes < 1:
            raise OptionError(f"batch size {self.batch_bytes}: expected at least 1 byte")
        self.forced_units()

    def forced_units(self) -> dict[str, str]:
        """Return canonical name -> unit for the units that the user forces.

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
        """Return the settings as plain values for provenance."""
        return {
            "joints": None if self.joints is None else list(self.joints),
            "map_file": None if self.map_file is None else self.map_file.name,
            "gear_ratio": self.gear_ratio,
            "units": self.forced_units(),
        }
