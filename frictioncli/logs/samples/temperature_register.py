"""What a temperature register showed in one recording, taken in piece by piece."""

from dataclasses import dataclass, field

import numpy as np

from frictioncli.arrays import Array
from frictioncli.logs.samples import quantized_temperature

_FIRST_ROWS = 256


@dataclass(slots=True)
class TemperatureRegister:
    """What a joint's motor temperature register showed in one recording.

    Attributes
    ----------
    changes : list of Changes
        Moments of change, in order; none where the readings rule a register of steps out.
    levels : set of float
        Distinct readings, as far as they were needed to rule it out. [°C]
    first : float or None
        Time of the first reading from the recording's first sample. [s]
    last : tuple of float, or None
        Time and value of the last reading. [s, °C]
    smooth : bool
        The readings rule a register of steps out; further ones are passed over.
    """

    changes: list[quantized_temperature.Changes] = field(default_factory=list)
    levels: set[float] = field(default_factory=set)
    first: float | None = None
    last: tuple[float, float] | None = None
    smooth: bool = False

    def see(self, time: Array, reading: Array, wait: float) -> None:
        """Take in the next samples."""
        if self.smooth or not len(reading):
            return
        if not (np.isfinite(reading.min()) and np.isfinite(reading.max())):
            present = np.isfinite(reading)
            time, reading = time[present], reading[present]
            if not len(time):
                return
        self._see_steps(time, reading, wait)
        if self.first is None:
            self.first = float(time[0])
        self.last = (float(time[-1]), float(reading[-1]))

    def _see_steps(self, time: Array, reading: Array, wait: float) -> None:
        # a smooth one mostly shows within its first readings
        for some in (reading[:_FIRST_ROWS], reading):
            changed = some[1:][some[1:] != some[:-1]]
            levels = np.append(changed, [some[0], *self.levels])
            levels = np.unique(np.round(levels, 6))
            if quantized_temperature.is_continuous(levels):
                self.smooth = True
                # two of them are enough to rule it out for the whole run
                close = int(np.argmin(np.diff(levels)))
                self.levels = set(levels[close : close + 2].tolist())
                self.changes.clear()
                return
        self.levels = set(levels.tolist())
        if self.last is not None:
            border = np.array([[self.last[0], time[0]], [self.last[1], reading[0]]])
            self._note(quantized_temperature.find_changes(*border, wait=wait))
        self._note(quantized_temperature.find_changes(time, reading, wait=wait))

    def _note(self, found: quantized_temperature.Changes) -> None:
        if len(found.time):
            self.changes.append(found)
