"""Base of text logs whose rows are read one by one, as no table of numbers is written in them."""

from abc import abstractmethod
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from frictioncli.arrays import Numbers
from frictioncli.logs.formats.encoding import line_blocks
from frictioncli.logs.log_source import MAX_ROW_TEXT, RawBatch, SequentialSource


@dataclass(frozen=True, slots=True)
class TextRows(SequentialSource):
    """A text log with one sample in each line.

    Attributes
    ----------
    path : Path
        The file.
    encoding : str
        A Python encoding name.
    data_line : int
        Line number of the first row, from 1.
    """

    path: Path
    encoding: str
    data_line: int

    @abstractmethod
    def row(self, text: str, columns: Sequence[int]) -> list[float] | str:
        """Return the numbers of some columns in a row, or the reason why it is rejected."""

    def batches(self, columns: Collection[int], size: int) -> Iterator[RawBatch]:
        """Yield the rows in order, in batches of about ``size`` bytes of the file."""
        wanted = sorted(columns)
        for lines in self._lines(size):
            rows: list[list[float]] = []
            good: list[int] = []
            bad: dict[int, str] = {}
            for number, text in lines:
                row = self.row(text, wanted)
                if isinstance(row, str):
                    bad[number] = row
                else:
                    rows.append(row)
                    good.append(number)
            values = np.array(rows, np.float64).reshape(len(rows), len(wanted))
            yield RawBatch(
                np.array(good, np.int64),
                {column: values[:, place].copy() for place, column in enumerate(wanted)},
                np.array(list(bad), np.int64),
                tuple(bad.values()),
            )

    def texts(self, lines: Numbers, size: int) -> Iterator[tuple[int, str]]:
        """Yield (line, text) for the given line numbers, which must be ascending."""
        wanted = {int(line) for line in lines}
        for part in self._lines(size):
            yield from ((number, text[:MAX_ROW_TEXT]) for number, text in part if number in wanted)

    def _lines(self, size: int) -> Iterator[list[tuple[int, str]]]:
        """Yield the line numbers and texts of rows that are not blank."""
        charset = "cp1252" if self.encoding == "cp1252" else "utf-8-sig"
        for block in line_blocks(self.path, self.encoding, size):
            texts = block.content.decode(charset, "replace").split("\n")
            numbered = enumerate(texts, block.first_line)
            yield [(n, text) for n, text in numbered if n >= self.data_line and text.strip()]
