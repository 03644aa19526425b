"""Motor temperature register of a joint: its changes in one recording and over a whole run."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.logs.samples.quantized_temperature import (
    Knots,
    Recordings,
    RegisterChanges,
    find_changes,
    find_step,
    interpolation_knots,
    is_continuous,
)

_FIRST_ROWS = 256


@dataclass(slots=True)
class TemperatureRegister:
    """Readings of a joint's motor temperature register in one recording.

    Attributes
    ----------
    changes : tuple of RegisterChanges
        Changes in order; none where the readings are continuous.
    levels : tuple of float
        Distinct readings; of continuous ones only two that show it. [°C]
    first : float or None
        Time of the first reading since the recording's first sample. [s]
    last : tuple of float, or None
        Time and value of the last reading. [s, °C]
    continuous : bool
        The readings come from no quantized register; further ones are ignored.
    """

    changes: tuple[RegisterChanges, ...] = ()
    levels: tuple[float, ...] = ()
    first: float | None = None
    last: tuple[float, float] | None = None
    continuous: bool = False

    def update(self, time: Array, reading: Array, longest: float) -> None:
        """Add the next readings.

        Parameters
        ----------
        time : ndarray, shape (n,)
            Time since the recording's first sample. [s]
        reading : ndarray, shape (n,)
            Readings; NaN are ignored. [°C]
        longest : float
            Longest time between two samples that still dates a change. [s]
        """
        if self.continuous or not len(reading):
            return
        if not (np.isfinite(reading.min()) and np.isfinite(reading.max())):
            present = np.isfinite(reading)
            time, reading = time[present], reading[present]
            if not len(time):
                return
        self._update_changes(time, reading, longest)
        if self.first is None:
            self.first = float(time[0])
        self.last = (float(time[-1]), float(reading[-1]))

    def _update_changes(self, time: Array, reading: Array, longest: float) -> None:
        # continuous readings mostly show as such within the first rows
        for readings in (reading[:_FIRST_ROWS], reading):
            changed = readings[1:][readings[1:] != readings[:-1]]
            levels = np.append(changed, [readings[0], *self.levels])
            levels = np.unique(np.round(levels, 6))
            if is_continuous(levels):
                self.continuous = True
                # the two closest levels suffice to show it for the whole run
                closest = int(np.argmin(np.diff(levels)))
                self.levels = tuple(levels[closest : closest + 2].tolist())
                self.changes = ()
                return
        self.levels = tuple(levels.tolist())
        if self.last is not None:
            border = np.array([[self.last[0], time[0]], [self.last[1], reading[0]]])
            self._add(find_changes(*border, longest=longest))
        self._add(find_changes(time, reading, longest=longest))

    def _add(self, found: RegisterChanges) -> None:
        if len(found.time):
            self.changes += (found,)


def run_knots(
    registers: Sequence[tuple[float, TemperatureRegister]], *, starts_known: bool
) -> tuple[Knots | None, ...]:
    """Return the knots of a joint's motor temperature for each recording of a run.

    Parameters
    ----------
    registers : sequence of (float, TemperatureRegister)
        Start of each recording in the run [s], and its register.
    starts_known : bool
        Changes in one recording then serve the others too; else each recording stands alone.

    Returns
    -------
    tuple of Knots or None
        One per recording; None where the readings are not quantized or change too rarely.
    """
    levels = {level for _, register in registers for level in register.levels}
    step = find_step(np.array(sorted(levels)))
    if step is None:
        return (None,) * len(registers)
    if starts_known:
        return (_knots(registers, step),) * len(registers)
    return tuple(_knots([one], step) for one in registers)


def _knots(registers: Sequence[tuple[float, TemperatureRegister]], step: float) -> Knots | None:
    found = [(start, changes) for start, register in registers for changes in register.changes]
    spans = [
        (start + register.first, start + register.last[0], register.last[1])
        for start, register in registers
        if register.first is not None and register.last is not None
    ]
    if not found or not spans:
        return None
    changes = RegisterChanges(
        np.concatenate([start + changes.time for start, changes in found]),
        np.concatenate([changes.before for _, changes in found]),
        np.concatenate([changes.after for _, changes in found]),
    )
    return interpolation_knots(changes, step=step, recordings=Recordings(*np.array(spans).T))
