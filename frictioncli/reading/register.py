"""What a temperature register showed in one recording, taken in piece by piece."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from frictioncli.reading import staircase

_MAX_LEVELS = 1000


@dataclass(slots=True)
class Register:
    """What a joint's motor temperature register showed in one recording.

    ``first`` is the time of the first reading, ``last`` time and value of the last one; times count
    from the recording's first sample. [s, °C]
    """

    changes: list[staircase.Changes] = field(default_factory=list)
    levels: set[float] = field(default_factory=set)
    first: float | None = None
    last: tuple[float, float] | None = None

    def see(self, time: NDArray[np.float64], reading: NDArray[np.float64], wait: float) -> None:
        """Take in the next samples."""
        present = np.isfinite(reading)
        time, reading = time[present], reading[present]
        if not len(time):
            return
        if self.last is not None:
            time = np.concatenate(([self.last[0]], time))
            reading = np.concatenate(([self.last[1]], reading))
        if self.first is None:
            self.first = float(time[0])
        self.last = (float(time[-1]), float(reading[-1]))
        if len(self.levels) < _MAX_LEVELS:
            self.levels.update(np.unique(reading).tolist())
            self.changes.append(staircase.find_changes(time, reading, wait=wait))
