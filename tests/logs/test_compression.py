"""Compressed logs give the content of the plain file; damaged ones are refused."""

import bz2
import gzip
import lzma
import tracemalloc
import zlib

import pyarrow as pa
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from frictioncli import schemas, tables
from frictioncli.errors import LogError
from frictioncli.logs.formats.compression import open_bytes
from frictioncli.logs.formats.encoding import line_blocks, read_head
from frictioncli.logs.ingest import ingest
from frictioncli.logs.log_source import UnreadableLog

from .logs import kuka_columns, text_of, write


def zstd(content: bytes) -> bytes:
    return pa.Codec("zstd").compress(content, asbytes=True)


PACKERS = {".gz": gzip.compress, ".zst": zstd, ".xz": lzma.compress, ".bz2": bz2.compress}
packed = pytest.mark.parametrize("ending", PACKERS)


@packed
@settings(max_examples=15)
@given(
    parts=st.lists(st.binary(min_size=1, max_size=3000), min_size=1, max_size=3),
    size=st.integers(1, 4000),
)
def test_concatenated_streams_are_one_file(tmp_path_factory, ending, parts, size):
    path = tmp_path_factory.mktemp("packed") / f"log{ending}"
    path.write_bytes(b"".join(PACKERS[ending](part) for part in parts))
    found = bytearray()
    with open_bytes(path) as stream:
        while block := stream.read(size):
            assert len(block) <= size
            found += block
    assert bytes(found) == b"".join(parts)


@packed
def test_a_compressed_log_gives_the_samples_of_the_plain_one(tmp_path, ending):
    text = text_of(kuka_columns()).encode()
    plain = write(tmp_path / "plain" / "log.csv", kuka_columns())
    (tmp_path / "packed").mkdir()
    log = tmp_path / "packed" / f"log.csv{ending}"
    log.write_bytes(PACKERS[ending](text))
    read = {}
    for name, path in (("plain", plain), ("packed", log)):
        ingest([path], tmp_path / name / "work")
        read[name] = tables.read(tmp_path / name / "work" / "samples.parquet", schemas.SAMPLES)
    assert read["packed"]["recording"].unique().tolist() == ["log"]
    assert read["plain"].drop(columns="run").equals(read["packed"].drop(columns="run"))


@packed
def test_the_suffix_does_not_matter(tmp_path, ending):
    log = tmp_path / "log.csv"
    log.write_bytes(PACKERS[ending](b"a;b\n1;2\n"))
    assert read_head(log).content == b"a;b\n1;2\n"


def test_text_that_begins_like_a_compressed_file_is_text(tmp_path):
    log = tmp_path / "log.csv"
    log.write_bytes(b"BZhub;Winkel\n1;2\n")
    assert read_head(log).content == b"BZhub;Winkel\n1;2\n"


@packed
def test_a_stream_cut_anywhere_is_refused(tmp_path, ending):
    whole = PACKERS[ending](text_of(kuka_columns()).encode())
    log = tmp_path / f"log.csv{ending}"
    for share in (0.02, 0.5, 0.98):
        log.write_bytes(whole[: int(share * len(whole))])
        with pytest.raises(UnreadableLog, match=r"cannot be (opened|read beyond line \d+)"):
            list(line_blocks(log, "utf-8", 1 << 12))


@packed
def test_a_damaged_stream_is_refused_by_ingest(tmp_path, ending):
    damaged = bytearray(PACKERS[ending](text_of(kuka_columns(seconds=60.0)).encode()))
    middle = len(damaged) // 2
    damaged[middle : middle + 40] = bytes(40)
    log = tmp_path / f"log.csv{ending}"
    log.write_bytes(damaged)
    with pytest.raises(LogError, match=r"no usable log; .*log\.csv.* cannot be"):
        ingest([log], tmp_path / "work")
    assert not (tmp_path / "work" / "samples.parquet").exists()


@pytest.mark.slow
@pytest.mark.parametrize(
    "ending",
    [pytest.param(one, marks=pytest.mark.long if one == ".bz2" else ()) for one in PACKERS],
)
def test_memory_is_bounded_whatever_the_decompressed_size(tmp_path, ending):
    """32 MiB of equal lines are compressed to a few kilobytes."""
    lines = b"0;0;0;0;0;0;00;\n" * (1 << 21)
    log = tmp_path / f"log.csv{ending}"
    log.write_bytes(PACKERS[ending](lines))
    size = len(lines)
    assert log.stat().st_size < size / 500
    del lines
    tracemalloc.start()
    try:
        assert sum(len(piece.content) for piece in line_blocks(log, "utf-8", 1 << 20)) == size
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < 16 << 20


def test_an_xz_header_cannot_request_gigabytes(tmp_path):
    """The dictionary size in the block header, after 12 bytes of stream header, is raised."""
    packed = bytearray(lzma.compress(b"a;b\n1;2\n"))
    length = (packed[12] + 1) * 4
    at = packed.index(b"\x21\x01", 12, 12 + length) + 2
    packed[at] = 40  # 4 GiB
    packed[12 + length - 4 : 12 + length] = zlib.crc32(packed[12 : 12 + length - 4]).to_bytes(
        4, "little"
    )
    log = tmp_path / "log.csv.xz"
    log.write_bytes(packed)
    with pytest.raises(UnreadableLog, match=r"[Mm]emory"):
        read_head(log)
