"""Small containers that promise much, or nest deep: each is refused at once, with a reason."""

import struct
import zlib

import numpy as np
import pyarrow as pa
import pytest
from pyarrow.feather import write_feather
from scipy.io import loadmat, savemat

from frictioncli.errors import LogError
from frictioncli.logs.formats import array_files, arrow_blocks, open_log
from frictioncli.logs.formats.matlab_check import check_matlab
from frictioncli.logs.ingest import ingest
from frictioncli.logs.log_source import CsvHints, Refusal, UnreadableLog

MIB = 1 << 20


def refusal(path):
    found = open_log(path, CsvHints())
    assert isinstance(found, Refusal)
    assert len(found.text) < 500
    return found.text


def element(kind, content):
    return struct.pack("<II", kind, len(content)) + content + bytes(-len(content) % 8)


def matrix_head(kind):
    """Return flags, dimensions 1 x 1, and no name."""
    flags = element(6, struct.pack("<II", kind, 0))
    return flags + element(5, struct.pack("<ii", 1, 1)) + element(1, b"")


def matlab_file(path, *variables, packed=False):
    content = b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack("<HH", 0x0100, 0x4D49)
    for variable in variables:
        body = zlib.compress(variable)
        content += struct.pack("<II", 15, len(body)) + body if packed else variable
    path.write_bytes(content)
    return path


def nested(depth, kind, *, honest):
    """Return arrays in one another; if not honest, each says to end where its array begins."""
    head = matrix_head(kind)
    if kind == 2:  # one field with a name of eight characters
        head += struct.pack("<HHi", 5, 4, 8) + element(1, b"x\0\0\0\0\0\0\0")
    parts, inside = [], struct.pack("<II", 14, 0)
    length = len(inside)
    for _ in range(depth):
        stated = len(head) + length if honest else len(head)
        parts.append(struct.pack("<II", 14, stated) + head)
        length += 8 + len(head)
    return b"".join(reversed(parts)) + inside


@pytest.mark.parametrize("packed", [False, True])
@pytest.mark.parametrize("kind", [1, 2])
@pytest.mark.parametrize(
    ("honest", "reason"), [(True, "deeper than 64"), (False, "contradict themselves")]
)
def test_arrays_in_one_another_are_not_followed_without_end(tmp_path, packed, kind, honest, reason):
    """scipy follows them by recursion in C: 60,000 of them in 3 MB broke the process down."""
    path = matlab_file(tmp_path / "a.mat", nested(60_000, kind, honest=honest), packed=packed)
    assert reason in refusal(path)


@pytest.mark.parametrize("packed", [False, True])
def test_all_that_scipy_writes_passes_the_check(tmp_path, packed):
    cells = np.empty((2, 2), object)
    cells[:] = [[1.0, "two"], [np.arange(3), {"in": {"a": "struct"}}]]
    content = {
        "cells": cells,
        "records": np.array([(1, "a"), (2, "b")], [("x", float), ("name", object)]),
        "log": {"t": np.arange(5.0), "names": cells, "empty": np.empty((0, 0))},
        "complex": np.array([1 + 2j]),
        "text": "some text",
        "small": np.int8([1, 2]),
    }
    path = tmp_path / "a.mat"
    savemat(path, content, do_compression=packed)
    check_matlab(path, MIB)
    assert set(content) < set(loadmat(path))
    with pytest.raises(UnreadableLog, match="unpack to more than 0 MiB"):
        check_matlab(path, 1000)


def test_packed_arrays_are_bounded_before_they_are_unpacked(tmp_path, monkeypatch):
    zeros = np.zeros(2 * MIB // 8)
    savemat(tmp_path / "a.mat", {"time": zeros, "position": zeros}, do_compression=True)
    np.savez_compressed(tmp_path / "a.npz", time=zeros, position=zeros)
    for name in ("a.mat", "a.npz"):
        assert (tmp_path / name).stat().st_size < MIB // 20
        assert not isinstance(open_log(tmp_path / name, CsvHints()), Refusal)
    monkeypatch.setattr(array_files, "_MOST_BYTES", 3 * MIB)
    assert "unpack to more than 3 MiB" in refusal(tmp_path / "a.mat")
    assert "unpack to 4 MiB" in refusal(tmp_path / "a.npz")


@pytest.mark.long
def test_groups_of_hdf5_by_the_thousand(tmp_path):
    """The time of each was once proportional to the number of all."""
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        for number in range(4000):
            for name in ("time", "position", "torque"):
                file[f"episode{number}/{name}"] = np.arange(3.0)
    assert "several recordings" in refusal(tmp_path / "a.h5")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        group = file
        for _ in range(2000):
            group = group.create_group("g")
        group["time"] = np.arange(3.0)
    assert "32 groups in one another" in refusal(tmp_path / "a.h5")


def test_rows_of_hdf5_that_were_never_written(tmp_path):
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        for name in ("time", "position", "torque"):
            file.create_dataset(name, (10**13,), "f8", chunks=(1 << 20,), fillvalue=1.0)
    assert (tmp_path / "a.h5").stat().st_size < 10_000
    assert "declares 80000000000000 bytes and stores 0" in refusal(tmp_path / "a.h5")


def test_names_of_thousands_of_characters_are_cut_in_messages(tmp_path):
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        for number in range(20):
            file[f"{'very long ' * 500}{number}"] = np.arange(3.0)
    found = open_log(tmp_path / "a.h5", CsvHints())
    assert max(map(len, found.columns)) > 5000
    with pytest.raises(LogError) as error:
        ingest([tmp_path / "a.h5"], tmp_path / "work")
    assert "20 in all" in str(error.value)
    assert len(str(error.value)) < 2000


@pytest.mark.parametrize("compression", ["zstd", "lz4", "uncompressed"])
def test_batches_of_arrow_are_bounded_before_they_are_unpacked(tmp_path, monkeypatch, compression):
    """The lengths that the buffers state are those of numbers, texts, lists and dictionaries."""
    count = 30_000
    texts = pa.array(["a", None, "c"] * (count // 3))
    columns = {
        "time": np.arange(count) * 0.01,
        "state": pa.array([[0.5, 1.0]] * count),
        "phase": texts,
        "mode": texts.dictionary_encode(),
    }
    path = tmp_path / "a.feather"
    write_feather(pa.table(columns), path, compression=compression, chunksize=20_000)
    assert not isinstance(open_log(path, CsvHints()), Refusal)
    with path.open("rb") as stream, pa.ipc.open_file(stream) as file:
        blocks = arrow_blocks.blocks_of(stream)
        assert len(blocks.batches) == file.num_record_batches == 2
        for number in range(2):
            batch = file.get_batch(number)
            assert blocks.checked(number).rows == batch.num_rows
            length = sum(b.size for c in batch.columns for b in c.buffers() if b is not None)
            monkeypatch.setattr(arrow_blocks, "_MOST_BYTES", length + 64 * len(batch.columns))
            blocks.checked(number)
            monkeypatch.setattr(arrow_blocks, "_MOST_BYTES", int(0.9 * length))
            if compression == "uncompressed":
                blocks.checked(number)  # read a few rows at a time, not loaded
                continue
            with pytest.raises(UnreadableLog, match="smaller batches"):
                blocks.checked(number)
