"""Headers and text between the rows of a log cost these lines, and no others."""

import pytest

from frictioncli.logs.ingest import ingest

from .logs import kuka_columns, text_of

TEXT = "emergency stop; by operator, see log book"


def log_with(between, at, *, repeated=1):
    header, *rows = text_of(kuka_columns()).splitlines()
    text = [header if between == "header" else between] * repeated
    return "\n".join([header, *rows[:at], *text, *rows[at:]]) + "\n", len(rows)


@pytest.mark.parametrize("at", [10, 250, -1])
@pytest.mark.parametrize(
    ("between", "repeated"), [("header", 1), ("header", 3), (TEXT, 100), ("a;b;c;d", 100)]
)
def test_other_rows_are_kept(between, repeated, at, tmp_path):
    text, rows = log_with(between, at, repeated=repeated)
    (tmp_path / "log.csv").write_text(text)
    summary = ingest([tmp_path / "log.csv"], tmp_path / "work")
    assert summary.rows_kept == rows
    assert sum(summary.rows_rejected.values()) == repeated


def test_text_behind_the_last_row_is_rejected(tmp_path):
    header, *rows = text_of(kuka_columns()).splitlines()
    (tmp_path / "log.csv").write_text("\n".join([header, *rows, *[TEXT] * 100]))
    summary = ingest([tmp_path / "log.csv"], tmp_path / "work")
    assert summary.rows_kept == len(rows)
    assert summary.rows_rejected == {"wrong_field_count": 100}
