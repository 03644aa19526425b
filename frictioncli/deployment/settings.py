"""Settings of the export of a model."""

import math
from dataclasses import dataclass, field

from frictioncli.correction.settings import (
    LONGEST_TIME_OPTION,
    READINGS,
    SCALE_OPTION,
    ScheduleSettings,
)
from frictioncli.errors import OptionError
from frictioncli.options import option

TARGETS = ("c", "urdf", "mjcf", "json", "csv")
"""Forms in which a model can be written."""

STATEFUL = ("c", "json")
"""Forms with a state: they hold corrections and the extended model."""

EXTENDED = (*STATEFUL, "csv")
"""Forms that hold the extended model, or its empirical term."""

_SCHEDULE = ScheduleSettings()


@dataclass(frozen=True, slots=True, kw_only=True)
class ExportSettings:
    """Form of the file and what it holds.

    Attributes
    ----------
    to : str
        One of :data:`TARGETS`.
    joint : int or None
        Joint; needed where the model has several.
    extended : bool
        Whether the extended model is exported, as far as its effects need no past; as ``csv`` its
        empirical term.
    criterion : str
        Reading of criterion (20) that decides when to correct.
    k : float
        Scale of criterion (20).
    tmax : float
        Time after which a correction is forced. [s]
    temperature, load : float or None
        Operating point at which a simpler form must fit best; None: the middle of the measured
        temperatures and the root mean square over the range of loads. [°C], [N·m]
    lowest, highest : float or None
        Range of speeds in which a simpler form must fit; None: as measured. [deg/s]
    tolerance : float or None
        Greatest error of interpolation in the table; None: a thousandth of the greatest friction
        in it. [torque unit]
    torque_constant : float or None
        Torque at the joint per unit of the torque in the log, where that is not N·m at the joint.
        [N·m/A]
    """

    to: str = field(metadata=option(f"Form of the file: {', '.join(TARGETS)}."))
    joint: int | None = field(
        default=None, metadata=option("Joint, from 1; needed where the model has several.")
    )
    extended: bool = field(
        default=False,
        metadata=option(
            "Use extended-model.json: the gear's temperature and effects without memory; with csv"
            " its empirical term."
        ),
    )
    criterion: str = field(
        default=_SCHEDULE.criterion, metadata=option(f"When to correct: {', '.join(READINGS)}.")
    )
    k: float = field(default=_SCHEDULE.k, metadata=SCALE_OPTION)
    tmax: float = field(default=_SCHEDULE.tmax, metadata=LONGEST_TIME_OPTION)
    temperature: float | None = field(
        default=None,
        metadata=option(
            "Temperature at which the form must fit best [°C]; default: middle of the data."
        ),
    )
    load: float | None = field(
        default=None,
        metadata=option(
            "Load at which the form must fit best [N·m]; default: RMS over the data's range."
        ),
    )
    lowest: float | None = field(
        default=None, metadata=option("Lowest speed to fit [deg/s]; default: lowest in the data.")
    )
    highest: float | None = field(
        default=None, metadata=option("Highest speed to fit [deg/s]; default: highest in the data.")
    )
    tolerance: float | None = field(
        default=None,
        metadata=option(
            "csv: largest error of linear interpolation [torque unit]; default: 1/1000 of the"
            " friction."
        ),
    )
    torque_constant: float | None = field(
        default=None,
        metadata=option("urdf, mjcf: torque at the joint per unit of the log's torque [N·m/A]."),
    )

    def __post_init__(self) -> None:
        if self.to not in TARGETS:
            raise OptionError(f"--to {self.to}: expected one of {', '.join(TARGETS)}")
        if self.criterion not in READINGS:
            raise OptionError(
                f"--criterion {self.criterion}: a controller can use {' or '.join(READINGS)};"
                " the others need the whole log"
            )
        if self.extended and self.to not in EXTENDED:
            raise OptionError(
                f"--extended --to {self.to}: effects with memory cannot be written in that format;"
                f" expected --to {' or '.join(STATEFUL)}, or csv for the empirical term"
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
