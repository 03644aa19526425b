"""Rows of a log in windows of fixed length, with neighbouring rows as context.

Results do not depend on how the log was cut into chunks, and memory is bounded by one window.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from frictioncli.arrays import Array
from frictioncli.logs.samples.log_rows import LogRows, concatenate_rows

CONTEXT = 8
"""Neighbouring rows before and after a window."""

_ROWS = 1 << 15


@dataclass(frozen=True, slots=True)
class Window:
    """Consecutive rows of a log.

    Attributes
    ----------
    rows : LogRows
        The rows, with up to ``CONTEXT`` neighbouring rows on either side.
    new : slice
        The rows without the context, each in exactly one window.
    """

    rows: LogRows
    new: slice

    def steps(self) -> Array:
        """Return the time step to each new row [s]; the first row of a log has none."""
        time = self.rows.time
        return np.diff(time[max(self.new.start - 1, 0) : self.new.stop])


@dataclass(slots=True)
class Windows:
    """Cuts chunks of any size into windows."""

    _held: list[LogRows] = field(default_factory=list)
    _length: int = 0
    _before: int = 0

    def update(self, rows: LogRows) -> Iterator[Window]:
        """Add rows and yield the windows that are complete."""
        if not len(rows):
            return
        self._held.append(rows)
        self._length += len(rows)
        while self._length >= self._before + _ROWS + CONTEXT:
            yield self._window(_ROWS)

    def flush(self) -> Iterator[Window]:
        """Yield the last window at the end of the log."""
        remaining = self._length - self._before
        if remaining > 0:
            yield self._window(remaining)

    def _window(self, length: int) -> Window:
        rows = self._held[0]
        for block in self._held[1:]:
            rows = concatenate_rows(rows, block)
        new = slice(self._before, self._before + length)
        start = max(new.stop - CONTEXT, 0)
        rest = rows.take(slice(start, None))
        self._held, self._length, self._before = [rest], len(rest), new.stop - start
        return Window(rows.take(slice(0, new.stop + CONTEXT)), new)
