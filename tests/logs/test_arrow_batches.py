"""Batches of Arrow files: large ones are read a few rows at a time, none is mapped."""

import subprocess
import sys

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from pyarrow.feather import write_feather

from frictioncli.logs.formats import arrow_batches, arrow_blocks, open_log
from frictioncli.logs.formats.arrow_batches import batches_of
from frictioncli.logs.log_source import CsvHints, Refusal, UnreadableLog

from .containers import COLUMNS, assert_same_as_csv

COUNT = 1_003


def every_type(count=COUNT):
    """Return columns of every layout, with rows that are missing."""
    draw = np.random.default_rng(5)
    some = draw.random(count) < 0.3
    numbers = draw.normal(size=count)
    texts = ["ä" * (i % 5) for i in range(count)]
    lists = [[float(i)] * (i % 4) for i in range(count)]
    pairs = pa.FixedSizeListArray.from_arrays(pa.array(draw.normal(size=2 * count)), 2)
    return {
        "number": numbers,
        "gaps": pa.array(numbers, mask=some),
        "flag": pa.array(numbers > 0, mask=some),
        "short": pa.array(range(count), pa.int16()),
        "time": pa.array(range(count), pa.timestamp("us", tz="UTC")),
        "decimal": pa.array(range(count)).cast(pa.decimal128(25, 2)),
        "bytes": pa.array([b"abc"] * count, pa.binary(3)),
        "text": pa.array(texts, mask=some),
        "long text": pa.array(texts, pa.large_string()),
        "list": pa.array(lists, mask=some),
        "long list": pa.array(lists, pa.large_list(pa.float32())),
        "flags": pa.array([[i % 3 == 0] * (i % 4) for i in range(count)]),
        "pair": pairs,
        "inside": pa.StructArray.from_arrays(
            [pa.array(numbers, mask=some), pairs], ["a", "b"], mask=pa.array(some)
        ),
        "none": pa.nulls(count),
        "label": pa.array(texts).dictionary_encode(),
        "texts": pa.array([[text] for text in texts]),
    }


@pytest.mark.parametrize("rows", [1, 8, 64, 100, 5_000])
@pytest.mark.parametrize("largest", [500, COUNT])
def test_slices_are_the_rows_that_pyarrow_reads(tmp_path, monkeypatch, rows, largest):
    monkeypatch.setattr(arrow_batches, "_WHOLE_BYTES", 0)
    table, path = pa.table(every_type()), tmp_path / "log.arrow"
    with pa.ipc.new_file(path, table.schema) as writer:
        writer.write_table(table, max_chunksize=largest)
    for names in (table.column_names, ["list", "number"], ["label"], ["flag", "texts"]):
        found = list(batches_of(path, names, rows))
        assert max(batch.num_rows for batch in found) <= max(rows, 8)
        assert pa.Table.from_batches(found).cast(table.select(names).schema) == table.select(names)
        for batch in found:
            batch.validate(full=True)


def test_large_batches_give_the_samples_of_the_csv(tmp_path, monkeypatch):
    monkeypatch.setattr(arrow_batches, "_WHOLE_BYTES", 0)
    path = tmp_path / "log.arrow"
    write_feather(pa.table(COLUMNS), path, compression="uncompressed")
    assert_same_as_csv(path, tmp_path)


def test_columns_that_must_be_loaded_whole_are_bounded(tmp_path, monkeypatch):
    monkeypatch.setattr(arrow_batches, "_WHOLE_BYTES", 0)
    monkeypatch.setattr(arrow_blocks, "_MOST_BYTES", 1_000)
    path = tmp_path / "log.arrow"
    write_feather(pa.table(every_type()), path, compression="uncompressed")
    assert len(list(batches_of(path, ["number"], 100))) == 11
    with pytest.raises(UnreadableLog, match="smaller batches"):
        list(batches_of(path, ["number", "label"], 100))


def test_numbers_that_begin_with_their_highest_byte_are_left_to_pyarrow(tmp_path, monkeypatch):
    """The footer is made to say so; pyarrow then turns the numbers round."""
    monkeypatch.setattr(arrow_batches, "_WHOLE_BYTES", 0)
    path, numbers = tmp_path / "log.arrow", np.arange(100, dtype=np.int64)
    write_feather(pa.table({"number": numbers}), path, compression="uncompressed")
    content = bytearray(path.read_bytes())
    footer = len(content) - 10 - int.from_bytes(content[-10:-6], "little")

    def number(at, size=4):
        return int.from_bytes(content[at : at + size], "little", signed=True)

    root = footer + number(footer)
    field = root + number(root - number(root) + 4 + 2 * 1, 2)
    schema = field + number(field)
    order = schema - number(schema) + 4
    assert number(order, 2) == 0  # by default: the lowest byte first
    # any other value than 0 means the highest; there is one in the schema's own offset
    content[order : order + 2] = (4).to_bytes(2, "little")
    path.write_bytes(content)
    with path.open("rb") as stream:
        assert arrow_blocks.blocks_of(stream).is_big_endian
    found = pa.Table.from_batches(batches_of(path, ["number"], 10))
    assert found["number"].to_numpy().tolist() == numbers.byteswap().tolist()


def test_any_byte_changed_is_refused_or_read(tmp_path, monkeypatch):
    """No damage makes a slice read beyond a buffer: the library checks every array."""
    monkeypatch.setattr(arrow_batches, "_WHOLE_BYTES", 0)
    path = tmp_path / "log.arrow"
    table = pa.table({name: every_type(40)[name] for name in ("gaps", "list", "text", "inside")})
    write_feather(table, path, compression="uncompressed")
    good, read = path.read_bytes(), 0
    for at in range(8, len(good), 3):
        path.write_bytes(good[:at] + bytes([good[at] ^ 0x5A]) + good[at + 1 :])
        found = open_log(path, CsvHints())
        if isinstance(found, Refusal):
            continue
        try:
            for batch in batches_of(path, table.column_names, 8):
                batch.validate()
                read += 1
        except (ValueError, IndexError, TypeError, UnreadableLog, pa.ArrowException):
            continue
    assert read > 100


CUT = """
import os, sys
from pathlib import Path
from frictioncli import parquet_footer
from frictioncli.logs.formats import arrow_batches, open_log
from frictioncli.logs.log_source import CsvHints, UnreadableLog
arrow_batches._WHOLE_BYTES = parquet_footer._LARGE_BYTES = int(sys.argv[2])
path = Path(sys.argv[1])
log = open_log(path, CsvHints())
batches = log.batches(range(len(log.columns)), 1000)
next(batches)
os.truncate(path, 4096)
try:
    for batch in batches:
        pass
except UnreadableLog as error:
    print(error)
"""


@pytest.mark.parametrize("ending", ["arrow", "feather", "parquet"])
@pytest.mark.parametrize("whole", [10, 1 << 30])
def test_a_file_that_is_cut_while_it_is_read_is_told(tmp_path, ending, whole):
    """Of a mapped file the system would end the process (SIGBUS)."""
    path = tmp_path / f"log.{ending}"
    count = 300_000
    table = pa.table(
        {name: np.random.default_rng(1).normal(size=count) for name in COLUMNS}
        | {"time": np.arange(count) * 0.01}
    )
    if ending == "parquet":
        pq.write_table(table, path, row_group_size=20_000)
    else:
        compression = "zstd" if ending == "feather" else "uncompressed"
        write_feather(table, path, compression=compression, chunksize=20_000)
    call = [sys.executable, "-c", CUT, str(path), str(whole)]
    done = subprocess.run(call, capture_output=True, text=True, check=False)
    assert done.returncode == 0, (done.returncode, done.stderr)
    assert "copy it again" in done.stdout
