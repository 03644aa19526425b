"""Text logs of thousands of columns: a line is longer than what other logs are told apart by."""

import numpy as np
import pytest

from frictioncli.logs.ingest import ingest
from tests.logs.logs import kuka_columns, text_of, write


@pytest.mark.parametrize(
    ("columns", "encoding", "newline"),
    [(3000, "utf-8", "\n"), (3000, "utf-16", "\r\n"), (6000, "cp1252", "\r")],
)
def test_all_rows_of_a_wide_log_are_read(tmp_path, columns, encoding, newline):
    log = kuka_columns(seconds=0.4)
    noise = np.random.default_rng(0).random((columns, len(next(iter(log.values())))))
    log |= {f"signal {number}": values for number, values in enumerate(noise)}
    path = write(tmp_path / "day" / "log.csv", log, encoding=encoding, newline=newline)
    assert len(text_of(log).partition("\n")[0]) + 12 * columns > 1 << 16  # header and row
    summary = ingest([path], tmp_path / "work")
    assert (summary.rows_read, summary.rows_kept) == (noise.shape[1], noise.shape[1])
