"""Settings of the stage ``export``."""

import math
from dataclasses import dataclass

from frictioncli.correction.settings import READINGS, ScheduleSettings
from frictioncli.errors import OptionError

TARGETS = ("c", "urdf", "mjcf", "json", "csv")
"""What a model can be written as."""

STATEFUL = ("c", "json")
"""Targets that carry a state: corrections and the extended model."""

_SCHEDULE = ScheduleSettings()


@dataclass(frozen=True, slots=True, kw_only=True)
class ExportSettings:
    """What ``export`` writes.

    Attributes
    ----------
    to : str
        One of :data:`TARGETS`.
    joint : int or None
        The joint; needed where the model has several.
    extended : bool
        Whether the extended model is carried as far as it can be.
    criterion : str
        Reading of criterion (20) that the corrections start with.
    k : float
        Scale of criterion (20).
    tmax : float
        Time after which a correction is forced. [s]
    temperature, load : float or None
        Where a simpler form must fit best; the middle of the data's temperatures and the root mean
        square of the range of loads if none. [°C], [N·m]
    lowest, highest : float or None
        Speeds between which a simpler form must fit; those of the data if none. [deg/s]
    tolerance : float or None
        Greatest error of interpolation in the table; a thousandth of the greatest friction in it if
        none. [torque unit]
    torque_constant : float or None
        Torque at the joint per unit of the log's torque, where that is not N·m at the joint.
        [N·m/A]
    """

    to: str
    joint: int | None = None
    extended: bool = False
    criterion: str = _SCHEDULE.criterion
    k: float = _SCHEDULE.k
    tmax: float = _SCHEDULE.tmax
    temperature: float | None = None
    load: float | None = None
    lowest: float | None = None
    highest: float | None = None
    tolerance: float | None = None
    torque_constant: float | None = None

    def __post_init__(self) -> None:
        if self.to not in TARGETS:
            raise OptionError(f"--to {self.to}: expected one of {', '.join(TARGETS)}")
        if self.criterion not in READINGS:
            raise OptionError(
                f"--criterion {self.criterion}: a controller decides by {' or '.join(READINGS)};"
                " the others look at the whole log"
            )
        if self.extended and self.to not in STATEFUL:
            raise OptionError(
                f"--extended --to {self.to}: effects with a memory have no place in that form;"
                f" expected --to {' or '.join(STATEFUL)}"
            )
        for name in ("k", "tmax", "tolerance", "torque_constant", "lowest", "highest"):
            self._check(name, "a number > 0", least=0.0)
        for name in ("temperature", "load"):
            self._check(name, "a number", least=-math.inf)
        if self.lowest is not None and self.highest is not None and self.lowest >= self.highest:
            raise OptionError(
                f"--lowest {self.lowest:g} --highest {self.highest:g}: expected a range of speeds"
            )

    def _check(self, name: str, expected: str, least: float) -> None:
        value = getattr(self, name)
        if value is not None and not least < value < math.inf:
            option = name.replace("_", "-")
            raise OptionError(f"--{option} {value:g}: expected {expected}")
