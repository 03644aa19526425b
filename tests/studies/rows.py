"""The rows of a long study: kept in a file, so that a second call goes on where the first stopped.

A row holds, beside its world's key, a digest of the sources that it depends on.
"""

import csv
import hashlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

ROOT = Path(__file__).parents[2]

SOURCES = "sources"
"""Column of the digest."""


def sources_digest(*places: str) -> str:
    """Return a digest of the Python files of folders, relative to the repository.

    Raises
    ------
    FileNotFoundError
        If a folder holds none.
    """
    files = []
    for place in places:
        found = sorted((ROOT / place).rglob("*.py"))
        if not found:
            raise FileNotFoundError(f"{place}: no Python files")
        files += found
    return hashlib.sha256(b"\0".join(file.read_bytes() for file in files)).hexdigest()[:12]


@dataclass(frozen=True, slots=True)
class Rows:
    """A file of rows.

    Attributes
    ----------
    path : Path
        The file, CSV.
    columns : tuple of str
        Its columns; rows of an earlier study keep those that they have.
    key : tuple of str
        Columns that identify a world.
    """

    path: Path
    columns: tuple[str, ...]
    key: tuple[str, ...]

    def read(self, digest: str, *, keep: bool) -> pd.DataFrame:
        """Return the last row of each world, as text.

        Parameters
        ----------
        digest : str
            Of the present sources.
        keep : bool
            Whether rows of other sources are kept, where there are none of these.
        """
        if not self.path.exists():
            return pd.DataFrame(columns=list(self.columns), dtype=str)
        rows = pd.read_csv(self.path, dtype=str, keep_default_na=False)
        rows = rows.reindex(columns=list(self.columns)).fillna("")
        rows = rows[rows[SOURCES] != ""]
        fresh = rows[SOURCES] == digest
        if not keep:
            rows, fresh = rows[fresh], fresh[fresh]
        # a row of these sources goes before a later one of others
        order = fresh.astype(int).sort_values(kind="stable").index
        return rows.loc[order].drop_duplicates(list(self.key), keep="last", ignore_index=True)

    def done(self, digest: str, *, keep: bool) -> set[tuple[str, ...]]:
        """Return the keys of the worlds that :meth:`read` returns."""
        rows = self.read(digest, keep=keep)
        return set(zip(*(rows[name] for name in self.key), strict=True))

    @contextmanager
    def adding(self) -> Iterator[Callable[[dict[str, object]], None]]:
        """Give a function that adds a row, which is then in the file whatever happens."""
        self._with_columns()
        with self.path.open("a", encoding="utf-8", newline="") as stream:
            writer = csv.DictWriter(stream, self.columns)

            def add(row: dict[str, object]) -> None:
                writer.writerow(row)
                stream.flush()

            yield add

    def _with_columns(self) -> None:
        """Give the file the columns of this study."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        if not self.path.exists():
            pd.DataFrame(columns=list(self.columns)).to_csv(self.path, index=False)
            return
        with self.path.open(encoding="utf-8", newline="") as stream:
            present = next(csv.reader(stream), [])
        if present != list(self.columns):
            rows = pd.read_csv(self.path, dtype=str, keep_default_na=False)
            rows.reindex(columns=list(self.columns)).to_csv(self.path, index=False)
