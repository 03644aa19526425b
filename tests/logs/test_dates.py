"""Dates and times of day are read in the forms that controllers and spreadsheets write."""

from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from hypothesis import given
from hypothesis import strategies as st

from frictioncli import schemas, tables
from frictioncli.logs.formats.moments import is_moment, moment_form, seconds
from frictioncli.logs.ingest import IngestSettings, ingest

from .logs import back_and_forth

TIME, POSITION, VELOCITY, TORQUE = back_and_forth()
NAMES = ("position [deg]", "velocity [deg/s]", "torque [Nm]")
NOON = datetime(2024, 3, 14, 11, 59, 57)
MIDNIGHT = datetime(2024, 3, 14, 23, 59, 57)


def stamps(start, form):
    """Return the times of the log as text, to the millisecond."""
    moments = [start + timedelta(milliseconds=round(1000 * t)) for t in TIME]
    return [moment.strftime(form.replace("%f", f"{moment:%f}"[:3])) for moment in moments]


def log(path, header, cells, delimiter=";", decimal=".", encoding="utf-8"):
    """Write a log whose first columns are texts."""
    numbers = zip(POSITION, VELOCITY, TORQUE, strict=True)
    rows = [delimiter.join((*header, *NAMES))]
    for texts, row in zip(zip(*cells, strict=True), numbers, strict=True):
        values = (f"{value:.6f}".replace(".", decimal) for value in row)
        rows.append(delimiter.join((*texts, *values)))
    path.write_bytes("\n".join(rows).encode(encoding))
    return path


def read(path, work, **settings):
    summary = ingest([path], work, IngestSettings(**settings))
    recordings = tables.read(work / "recordings.parquet", schemas.RECORDINGS)
    return summary, tables.read(work / "samples.parquet", schemas.SAMPLES), recordings


@pytest.mark.parametrize("start", [NOON, MIDNIGHT])
@pytest.mark.parametrize(
    ("form", "delimiter", "decimal"),
    [
        ("%d.%m.%Y %H:%M:%S.%f", ";", "."),
        ("%d.%m.%Y %H:%M:%S,%f", ";", ","),
        ("%d.%m.%y %H:%M:%S,%f", "\t", ","),
        ("%d-%m-%Y %H:%M:%S.%f", ",", "."),
        ("%m/%d/%Y %I:%M:%S.%f %p", ",", "."),
        ("%m/%d/%y %I:%M:%S.%f%p", ",", "."),
        ("%d/%m/%Y %H:%M:%S:%f", ",", "."),
        ("%Y/%m/%d %H:%M:%S.%f", ",", "."),
        ("%Y-%m-%d %I:%M:%S.%f %p", ",", "."),
        ('"%Y-%m-%dT%H:%M:%S,%f"', ",", "."),
        ("%Y%m%d%H%M%S%f", ",", "."),
        ("%Y%m%d%H%M%S.%f", ";", ","),
        ("%Y%m%d_%H%M%S_%f", ",", "."),
        ("%Y%m%dT%H%M%S.%f", " ", "."),
    ],
)
def test_a_date_with_time_of_day(tmp_path, form, delimiter, decimal, start):
    path = log(tmp_path / "log.csv", ["Time"], [stamps(start, form)], delimiter, decimal)
    summary, samples, recordings = read(path, tmp_path / "work")
    assert summary.rows_read == summary.rows_kept == len(TIME)
    np.testing.assert_allclose(samples["time"], TIME, atol=1e-6)
    np.testing.assert_allclose(samples["torque"], TORQUE)
    assert recordings["started_at"][0] == start.replace(tzinfo=UTC).isoformat()
    assert not any("day and month" in note for note in summary.notes)


@pytest.mark.parametrize("form", ["%H:%M:%S.%f", "%I:%M:%S.%f %p", "%H:%M:%S,%f"])
@pytest.mark.parametrize("start", [NOON, MIDNIGHT])
@pytest.mark.parametrize("size", [500, 1 << 22])
def test_a_time_of_day_alone_passes_midnight(tmp_path, form, start, size):
    path = log(tmp_path / "log.csv", ["Time"], [stamps(start, form)])
    summary, samples, _ = read(path, tmp_path / "work", batch_bytes=size)
    assert summary.rows_read == summary.rows_kept == len(TIME)
    np.testing.assert_allclose(samples["time"], TIME, atol=1e-6)


@pytest.mark.parametrize(
    ("date", "clock", "delimiter", "encoding"),
    [
        ("%d.%m.%Y", "%H:%M:%S,%f", "\t", "utf-16"),
        ("%m/%d/%Y", "%I:%M:%S.%f %p", ",", "utf-8"),
        ("%Y-%m-%d", "%H:%M:%S.%f", " ", "utf-8"),
    ],
)
def test_date_and_time_of_day_in_two_columns(tmp_path, date, clock, delimiter, encoding):
    cells = [stamps(MIDNIGHT, date), stamps(MIDNIGHT, clock)]
    form = {"delimiter": delimiter, "encoding": encoding, "decimal": ".,"["," in clock]}
    path = log(tmp_path / "log.txt", ["Datum", "Zeit"], cells, **form)
    summary, samples, recordings = read(path, tmp_path / "work")
    assert summary.rows_kept == len(TIME)
    np.testing.assert_allclose(samples["time"], TIME, atol=1e-6)
    assert recordings["started_at"][0] == MIDNIGHT.replace(tzinfo=UTC).isoformat()


@pytest.mark.parametrize("column", ["1", "2", "time [s]"])
def test_a_map_may_name_either_column(tmp_path, column):
    cells = [stamps(NOON, "%d.%m.%Y"), stamps(NOON, "%H:%M:%S.%f")]
    path = log(tmp_path / "log.csv", ["Datum", "Zeit"], cells)
    channels = Path(f"time={column},position=3:deg,torque=5:Nm")
    _, samples, _ = read(path, tmp_path / "work", map_file=channels)
    np.testing.assert_allclose(samples["time"], TIME, atol=1e-6)


def test_a_row_counter_beside_a_date_is_not_the_time(tmp_path):
    counter = [str(row) for row in range(len(TIME))]
    cells = [counter, stamps(NOON, "%m/%d/%Y %I:%M:%S.%f %p")]
    path = log(tmp_path / "log.csv", ["Tick", "Date/Time"], cells, ",")
    np.testing.assert_allclose(read(path, tmp_path / "work")[1]["time"], TIME, atol=1e-6)


@pytest.mark.parametrize(("separator", "order"), [("/", "month/day/year"), (".", "day.month.year")])
def test_a_day_that_may_be_the_month_is_told(tmp_path, separator, order):
    start = datetime(2024, 3, 4, 11)
    form = separator.join(("%d", "%m", "%Y")) + " %H:%M:%S.%f"
    path = log(tmp_path / "log.csv", ["Time"], [stamps(start, form)])
    summary, samples, _ = read(path, tmp_path / "work")
    np.testing.assert_allclose(samples["time"], TIME, atol=1e-6)
    told = [note for note in summary.notes if "day and month in Time cannot be told apart" in note]
    assert len(told) == 1
    assert f"read as {order}" in told[0]


def test_the_next_day_tells_day_from_month(tmp_path):
    """With the other order a month would pass at midnight."""
    start = datetime(2024, 3, 4, 23, 59, 57)
    path = log(tmp_path / "log.csv", ["Time"], [stamps(start, "%d/%m/%Y %H:%M:%S.%f")])
    summary, samples, recordings = read(path, tmp_path / "work")
    np.testing.assert_allclose(samples["time"], TIME, atol=1e-6)
    assert recordings["started_at"][0].startswith("2024-03-04T23:59:57")
    assert not any("day and month" in note for note in summary.notes)


def test_damaged_dates_cost_their_rows_only(tmp_path):
    texts = stamps(NOON, "%d.%m.%Y %H:%M:%S.%f")
    texts[0], texts[30], texts[31] = "", "31.02.2024 11:59:57.360", "14.03.2024 11:61:57.372"
    path = log(tmp_path / "log.csv", ["Time"], [texts])
    summary, samples, _ = read(path, tmp_path / "work")
    assert summary.rows_read == len(TIME)
    assert summary.rows_rejected == {"missing_value": 3}
    np.testing.assert_allclose(samples["time"], np.delete(TIME, [0, 30, 31]) - TIME[1], atol=1e-6)


FORMS = ["%d.%m.%Y %H:%M:%S.%f", "%m/%d/%Y %I:%M:%S.%f %p", "%Y/%m/%d %H:%M:%S.%f", "%d.%m.%Y"]
FORMS += ["%Y%m%d%H%M%S%f"]


@pytest.mark.parametrize("form", FORMS)
@given(moments=st.lists(st.datetimes(datetime(1000, 1, 1)), min_size=1, max_size=20))
def test_seconds_are_those_of_the_calendar(form, moments):
    first = datetime(2024, 12, 31)  # which tells the order
    cells = [moment.strftime(form).zfill(len(first.strftime(form))) for moment in (first, *moments)]
    cells = [cell for cell in cells if is_moment(cell)]
    expected = [
        (datetime.strptime(cell, form) - datetime(1970, 1, 1)) / timedelta(seconds=1)
        for cell in cells
    ]
    found = moment_form([cells[0]])
    assert found is not None
    np.testing.assert_allclose(seconds(pa.array(cells), found), expected, rtol=0, atol=2e-5)


@pytest.mark.parametrize(
    "cell",
    [
        *("1.5", "1.234.567,8", "12:30", "192.168.2.10", "1.2", "v1.2.3", "", "1e5", "14.03."),
        # since 1970 in ns and us; no month 13, no hour 24; a date alone; digits of a number
        *("1710417533008000000", "1710417533008000", "20241314115853", "20240314245853"),
        *("20240314", "0.20240314115853", "12024031411585300"),
    ],
)
def test_what_is_no_date(cell):
    assert not is_moment(cell)


def test_a_counter_that_looks_like_a_date_now_and_then_is_a_number(tmp_path):
    """A clock in ns since the controller was started 5.6 h ago, every 12 ms."""
    ticks = [f"{20_180_000_000_000 + round(1e9 * t)}" for t in TIME]
    assert any(is_moment(tick) for tick in ticks)
    path = log(tmp_path / "log.csv", ["time [ns]"], [ticks])
    summary, samples, _ = read(path, tmp_path / "work")
    assert summary.rows_kept == len(TIME)
    np.testing.assert_allclose(samples["time"], TIME, atol=1e-6)
