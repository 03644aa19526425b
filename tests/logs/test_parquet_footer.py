"""Footers of Parquet files that are read part by part."""

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from frictioncli import parquet_footer, schemas, tables
from frictioncli.logs.formats import arrow_tables, open_log
from frictioncli.logs.log_source import CsvHints, Refusal
from frictioncli.parquet_footer import large_footer
from frictioncli.provenance import Provenance

from .containers import COLUMNS, assert_same_as_csv

ROW_GROUP = 97


@pytest.fixture
def small_limits(monkeypatch):
    """Every footer is large, and a part of it holds a few row groups."""
    monkeypatch.setattr(parquet_footer, "_LARGE_BYTES", 10)
    monkeypatch.setattr(parquet_footer, "_PART_BYTES", 200)


def examples():
    """Return tables with every kind of value that a footer tells of."""
    count = 5 * ROW_GROUP + 3
    numbers = np.random.default_rng(4).normal(size=count)
    texts = [f"{'long' * 30} {i}" for i in range(count)]
    nested = pa.array([{"a": {"b": i, "c": [i, 2]}} for i in range(count)])
    return {
        "numbers": pa.table({f"column {'x' * i}": numbers for i in range(60)}),
        "texts": pa.table({"text": texts, "none": pa.nulls(count), "flag": numbers > 0}),
        "nested": pa.table({"nested": nested, "label": pa.array(texts).dictionary_encode()}),
        "times": pa.table({"time": pa.array(range(count), pa.timestamp("us", tz="UTC"))}),
    }


@pytest.mark.parametrize("name", examples())
@pytest.mark.parametrize(
    "form",
    [
        {},
        {"version": "1.0", "data_page_version": "2.0", "compression": "zstd"},
        {"write_statistics": False, "use_dictionary": False, "store_schema": False},
        {"write_page_index": True, "write_page_checksum": True},
        {"sorting_columns": [pq.SortingColumn(0)], "row_group_size": 30},
    ],
)
def test_the_parts_describe_the_same_row_groups(tmp_path, small_limits, name, form):
    path, table = tmp_path / "log.parquet", examples()[name]
    pq.write_table(table, path, **{"row_group_size": ROW_GROUP, **form})
    whole, parts = pq.read_metadata(path), list(large_footer(path).parts())
    groups = [part.row_group(i).to_dict() for part in parts for i in range(part.num_row_groups)]
    assert groups == [whole.row_group(i).to_dict() for i in range(whole.num_row_groups)]
    assert len(parts) > 1
    assert all(part.metadata == whole.metadata for part in parts)
    read = [pq.ParquetFile(path, metadata=part).read() for part in parts]
    assert pa.concat_tables(read).equals(pq.read_table(path))


def test_a_log_with_a_large_footer_gives_the_samples_of_the_csv(tmp_path, small_limits):
    path = tmp_path / "log.parquet"
    pq.write_table(pa.table(COLUMNS), path, row_group_size=ROW_GROUP)
    assert_same_as_csv(path, tmp_path)


def test_a_table_of_the_work_folder_is_read_part_by_part(tmp_path, small_limits, monkeypatch):
    monkeypatch.setattr(tables, "_GROUP_BYTES", 1)
    path, inputs = tmp_path / "rejected.parquet", {"log.csv": "0" * 64}
    with tables.TableWriter(path, schemas.REJECTED, Provenance("ingest", {}, inputs)) as writer:
        for row in range(5):
            writer.write(
                pa.table({"run": ["a"], "recording": ["b"], "reason": [str(row)], "text": ["c"]})
            )
    assert len(list(large_footer(path).parts())) > 1
    rows = [batch.to_pylist() for batch in tables.batches(path, schemas.REJECTED)]
    assert [row["reason"] for part in rows for row in part] == ["0", "1", "2", "3", "4"]
    assert tables.metadata(path)["inputs"] == inputs


def test_small_footers_are_left_to_pyarrow(tmp_path):
    pq.write_table(examples()["numbers"], tmp_path / "log.parquet", row_group_size=20)
    assert large_footer(tmp_path / "log.parquet") is None


def test_too_many_columns_are_refused(tmp_path, small_limits, monkeypatch):
    monkeypatch.setattr(arrow_tables, "_LARGEST_GROUP", 1000)
    path = tmp_path / "log.parquet"
    pq.write_table(examples()["numbers"], path)
    found = open_log(path, CsvHints())
    assert isinstance(found, Refusal)
    assert "150,000 columns" in found.text


def test_a_damaged_footer_is_refused_or_read(tmp_path, small_limits):
    """Every byte of a footer changed: an error that names the damage, or parts."""
    path = tmp_path / "log.parquet"
    pq.write_table(examples()["texts"].slice(0, 4), path, row_group_size=2)
    good = path.read_bytes()
    length = int.from_bytes(good[-8:-4], "little")
    refused = 0
    for at in range(len(good) - 8 - length, len(good) - 8, 11):
        path.write_bytes(good[:at] + bytes([good[at] ^ 0x5A]) + good[at + 1 :])
        try:
            for part in large_footer(path).parts():
                assert part.num_row_groups
        except (ValueError, OSError, pa.ArrowException):
            refused += 1
    assert refused > 10
