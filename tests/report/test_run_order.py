"""Runs on the page stand in the order of their numbers."""

import pandas as pd

from frictioncli.report.data_section import _ingest_table


def test_day_10_follows_day_9_in_what_was_read():
    runs = ["day10", "day9", "day10"]
    columns = {key: [5, 7, 6] for key in ("rows_read", "rows_kept", "rows_rejected")}
    table = _ingest_table(pd.DataFrame({"run": runs} | columns))
    assert [row[:3] for row in table.rows] == [("day9", "1", "7"), ("day10", "2", "11")]
