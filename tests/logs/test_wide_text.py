"""Text logs of thousands of columns: a line is longer than what other logs are told apart by."""

import warnings

import numpy as np
import pytest

from frictioncli.inspection.map_suggestion.suggest_map import suggested_map
from frictioncli.logs.ingest import IngestSettings, ingest
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


def test_times_that_no_clock_has_are_no_hindrance_for_a_suggestion(tmp_path):
    """Steps of 1e-300 s make velocities without end."""
    rows = "".join(f"{i}e-300;{50 * np.sin(i / 40)};{i % 7}\n" for i in range(300))
    path = tmp_path / "log.csv"
    path.write_text("t;q;tau\n" + rows, encoding="utf-8")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert "[channels]" in suggested_map([path], IngestSettings())
