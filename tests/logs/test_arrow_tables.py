"""Parquet and Feather files as logs."""

import decimal

import numpy as np
import pyarrow as pa
import pyarrow.feather as feather
import pyarrow.parquet as pq
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from frictioncli.errors import LogError
from frictioncli.logs.formats import open_log
from frictioncli.logs.ingest import ingest
from frictioncli.logs.log_source import CsvHints, Refusal

from .containers import COLUMNS, POSITION, TEMPERATURE, TIME, TORQUE, VELOCITY, assert_same_as_csv
from .logs import kuka_columns, write

WRITERS = {
    "parquet": lambda table, path: pq.write_table(table, path, row_group_size=97),
    "feather": lambda table, path: feather.write_feather(table, path, chunksize=97),
    "arrow": lambda table, path: feather.write_feather(table, path, compression="uncompressed"),
}
formats = pytest.mark.parametrize("ending", WRITERS)


def written(table, folder, ending):
    path = folder / f"log.{ending}"
    WRITERS[ending](table, path)
    return path


def refused(path):
    found = open_log(path, CsvHints())
    assert isinstance(found, Refusal)
    return found


@formats
def test_a_table_gives_the_samples_of_the_csv(tmp_path, ending):
    assert_same_as_csv(written(pa.table(COLUMNS), tmp_path, ending), tmp_path)


@formats
def test_units_in_the_metadata_of_fields(tmp_path, ending):
    units = {"timestamp": "ms", "position_2": "rad", "velocity_2": "rad/s", "torque_2": "mN·m"}
    values = (TIME * 1e3, np.radians(POSITION), np.radians(VELOCITY), TORQUE * 1e3)
    fields = [pa.field(name, pa.float64(), metadata={"unit": u}) for name, u in units.items()]
    kelvin = pa.field("motor_temperature_2", pa.float64(), metadata={"units": "K"})
    schema = pa.schema([*fields, kelvin])
    table = pa.table([*values, TEMPERATURE + 273.15], schema=schema)
    assert_same_as_csv(written(table, tmp_path, ending), tmp_path)


@formats
def test_time_stamps_lists_structures_and_decimals(tmp_path, ending):
    """Nanoseconds since 1970, a list per joint, a list of fixed length, a decimal, a label."""
    begin = 1_700_000_000_000_000_000
    stamps = begin + np.round(TIME * 1e9).astype(np.int64)
    table = pa.table(
        {
            "timestamp": pa.array(stamps, pa.timestamp("ns", tz="UTC")),
            "state": pa.array([{"position": [0.0, q, 1.0]} for q in POSITION]),
            "velocity": pa.array([[0.0, v, 0.0] for v in VELOCITY], pa.list_(pa.float64(), 3)),
            "torque": pa.array([[9.0, tau, 0.0] for tau in TORQUE]),
            "temperature_1": pa.array(
                [decimal.Decimal(f"{t:.12f}") for t in TEMPERATURE], pa.decimal128(18, 12)
            ),
            "mode": ["auto"] * len(TIME),
        }
    )
    path = written(table, tmp_path, ending)
    source = open_log(path, CsvHints())
    assert source.columns[:4] == (
        "timestamp [s]",
        "state.position[0]",
        "state.position[1]",
        "state.position[2]",
    )
    assert "mode" not in source.columns
    values = {
        name: np.concatenate([b.values[i] for b in source.batches([i], 1 << 10)])
        for i, name in enumerate(source.columns)
    }
    np.testing.assert_allclose(values["timestamp [s]"] - 1.7e9, TIME, atol=3e-7)
    np.testing.assert_array_equal(values["state.position[1]"], POSITION)
    np.testing.assert_array_equal(values["velocity[1]"], VELOCITY)
    np.testing.assert_array_equal(values["torque[1]"], TORQUE)
    np.testing.assert_allclose(values["temperature_1"], TEMPERATURE, atol=1e-12)


@settings(max_examples=40)
@given(
    values=st.lists(st.none() | st.integers(-(2**40), 2**40), min_size=2, max_size=60),
    rows=st.integers(1, 70),
    size=st.integers(1, 2000),
    kind=st.sampled_from([pa.int64(), pa.float64(), pa.duration("us"), pa.timestamp("ms")]),
    ending=st.sampled_from(["parquet", "feather"]),
)
def test_numbers_nulls_and_batches(tmp_path_factory, values, rows, size, kind, ending):
    """All rows are read in order, with NaN for nulls, whatever the size of parts and batches."""
    path = tmp_path_factory.mktemp("arrow") / f"log.{ending}"
    table = pa.table({"x": pa.array(values, pa.int64()).cast(kind)})
    if ending == "parquet":
        pq.write_table(table, path, row_group_size=rows)
    else:
        feather.write_feather(table, path, chunksize=rows)
    source = open_log(path, CsvHints())
    parts = list(source.batches([0], size))
    steps = {pa.duration("us"): 1e6, pa.timestamp("ms"): 1e3}.get(kind, 1.0)
    expected = [np.nan if value is None else value / steps for value in values]
    found = np.concatenate([part.values[0] for part in parts])
    np.testing.assert_allclose(found, expected, rtol=1e-15)
    lines = np.concatenate([part.lines for part in parts])
    assert lines.tolist() == list(range(1, len(values) + 1))


def test_rows_are_rejected_with_their_number_and_values(tmp_path):
    columns = {name: values.copy() for name, values in COLUMNS.items()}
    columns["torque_2 [Nm]"][[0, 7]] = np.nan
    path = written(pa.table(columns), tmp_path, "parquet")
    summary = ingest([path], tmp_path / "work")
    assert summary.rows_rejected == {"missing_value": 2}
    rejected = pq.read_table(tmp_path / "work" / "rejected.parquet").to_pydict()
    assert rejected["row"] == [1, 8]
    assert "position_2 [deg] -49.9856" not in rejected["text"][0]
    assert f"time [s] {TIME[7]:.9g}; position_2 [deg] {POSITION[7]:.9g}" in rejected["text"][1]


def test_lists_of_another_length_lose_their_rows(tmp_path):
    position = [[0.0, q] for q in POSITION]
    position[-1] = [POSITION[-1]]
    table = pa.table({"time": TIME, "position": position, "effort": [[0.0, t] for t in TORQUE]})
    summary = ingest([written(table, tmp_path, "parquet")], tmp_path / "work")
    assert summary.rows_rejected == {"missing_value": 1}


def test_numbers_as_text_are_refused_by_name(tmp_path):
    table = pa.table({"time": TIME, "position": [f"{q:.3f}" for q in POSITION], "torque": TORQUE})
    assert (
        "columns position hold numbers as text" in refused(written(table, tmp_path, "feather")).text
    )


def test_the_first_of_two_columns_with_the_same_name_is_read(tmp_path):
    table = pa.table([TIME, POSITION, POSITION * 0, TORQUE], ["time", "q", "q", "torque"])
    summary = ingest([written(table, tmp_path, "feather")], tmp_path / "work")
    assert summary.rows_kept == len(TIME)


def test_our_own_tables_are_no_logs(tmp_path):
    ingest([write(tmp_path / "log.csv", kuka_columns())], tmp_path / "work")
    for name in ("samples", "recordings", "rejected"):
        found = refused(tmp_path / "work" / f"{name}.parquet")
        assert "a table written by frictioncli" in found.text


@formats
def test_damaged_files_are_refused(tmp_path, ending):
    path = written(pa.table(COLUMNS), tmp_path, ending)
    whole = path.read_bytes()
    for length in (8, len(whole) // 2, len(whole) - 3):
        path.write_bytes(whole[:length])
        assert refused(path).reason == "unreadable_file"
    path.write_bytes(whole[:-80] + bytes(64) + whole[-16:])
    with pytest.raises(LogError, match="no usable log"):
        ingest([path], tmp_path / "work")
    assert not (tmp_path / "work" / "samples.parquet").exists()


@formats
def test_a_table_without_rows_is_refused(tmp_path, ending):
    empty = pa.table({name: values[:0] for name, values in COLUMNS.items()})
    assert refused(written(empty, tmp_path, ending)).reason == "too_few_rows"


def test_a_compressed_table_must_be_decompressed(tmp_path):
    path = written(pa.table(COLUMNS), tmp_path, "parquet")
    packed = tmp_path / "log.parquet.zst"
    packed.write_bytes(pa.Codec("zstd").compress(path.read_bytes(), asbytes=True))
    assert "a Parquet table packed with zstd" in refused(packed).text


def test_the_suffix_does_not_matter(tmp_path):
    path = written(pa.table(COLUMNS), tmp_path, "parquet")
    assert_same_as_csv(path.rename(tmp_path / "log.csv"), tmp_path)


def test_a_table_of_many_columns_is_opened_once(tmp_path, monkeypatch):
    """Opening takes a time proportional to the number of all columns; 60,000 took minutes."""
    table = pa.table({f"column {number}": np.arange(3.0) for number in range(1000)})
    pq.write_table(table, tmp_path / "log.parquet")
    opened = []

    class Counted(pq.ParquetFile):
        def __init__(self, *arguments, **more):
            opened.append(arguments)
            super().__init__(*arguments, **more)

    monkeypatch.setattr(pq, "ParquetFile", Counted)
    source = open_log(tmp_path / "log.parquet", CsvHints())
    assert source.columns == tuple(table.column_names)
    assert len(opened) == 1
