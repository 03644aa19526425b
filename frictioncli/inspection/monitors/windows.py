"""Rows of a log in windows of fixed length with their neighbours.

What is found in a window depends neither on how a file was cut into batches nor on its length, and
memory is that of one window.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from frictioncli.arrays import Array
from frictioncli.logs.samples.log_rows import LogRows, concatenate_rows

CONTEXT = 8
"""Rows before and after a window that are shown with it."""

_ROWS = 1 << 15


@dataclass(frozen=True, slots=True)
class Window:
    """Consecutive rows of a log.

    Attributes
    ----------
    rows : LogRows
        The rows, with up to ``CONTEXT`` neighbours on either side.
    new : slice
        Those of them that no other window counts.
    """

    rows: LogRows
    new: slice

    def steps(self) -> Array:
        """Return the time [s] from the row before to each new row; the log's first row has none."""
        time = self.rows.time
        return np.diff(time[max(self.new.start - 1, 0) : self.new.stop])


@dataclass(slots=True)
class Windows:
    """Cuts blocks of any size into windows."""

    _held: list[LogRows] = field(default_factory=list)
    _length: int = 0
    _before: int = 0

    def update(self, block: LogRows) -> Iterator[Window]:
        """Take the next rows and yield the windows that are complete."""
        if not len(block):
            return
        self._held.append(block)
        self._length += len(block)
        while self._length >= self._before + _ROWS + CONTEXT:
            yield self._window(_ROWS)

    def rest(self) -> Iterator[Window]:
        """Yield what is left at the log's end."""
        left = self._length - self._before
        if left > 0:
            yield self._window(left)

    def _window(self, length: int) -> Window:
        whole = self._held[0]
        for block in self._held[1:]:
            whole = concatenate_rows(whole, block)
        new = slice(self._before, self._before + length)
        start = max(new.stop - CONTEXT, 0)
        rest = whole.take(slice(start, None))
        self._held, self._length, self._before = [rest], len(rest), new.stop - start
        return Window(whole.take(slice(0, new.stop + CONTEXT)), new)
