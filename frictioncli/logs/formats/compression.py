"""Compressed files: recognised by their first bytes and decompressed as a stream."""

import bz2
import gzip
import io
import lzma
import zlib
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, cast

import pyarrow as pa

from frictioncli.logs.log_source import Refusal

if TYPE_CHECKING:
    from _typeshed import WriteableBuffer

STREAM_ERRORS = (OSError, EOFError, zlib.error, lzma.LZMAError)
"""Exceptions that reading a damaged or truncated stream raises."""
SUFFIXES = (".gz", ".zst", ".xz", ".bz2")
"""Suffixes of compressed files, to name them only; their first bytes decide what they are."""

_MAGIC = (
    (b"\x1f\x8b", "gzip"),
    (b"\x28\xb5\x2f\xfd", "zstd"),
    (b"\xfd7zXZ\0", "xz"),
    (b"BZh", "bzip2"),
)
_BZIP2_BLOCKS = (b"1AY&SY", b"\x17rE8P\x90")
"""Beginnings of the first block of a bzip2 stream; text may begin with ``BZh`` too."""
_MAGIC_BYTES = 10
"""Length of the beginning that identifies the compression. [byte]"""
_XZ_MEMORY = 1 << 27
"""Memory limit of an xz stream, twice what the strongest preset needs. [byte]"""
_XZ_READ = 1 << 16  # [byte]


def _compression_of(path: Path) -> str | None:
    """Return the compression of a file, ``gzip``, ``zstd``, ``xz`` or ``bzip2``; None if plain.

    Raises
    ------
    OSError
        If the file cannot be opened.
    """
    with path.open("rb") as stream:
        return _compression(stream.read(_MAGIC_BYTES))


def _compression(beginning: bytes) -> str | None:
    for magic, name in _MAGIC:
        if beginning.startswith(magic) and (name != "bzip2" or beginning[4:] in _BZIP2_BLOCKS):
            return name
    return None


def open_bytes(path: Path) -> BinaryIO:
    """Open a file for reading and decompress it while it is read.

    Reading raises one of :data:`STREAM_ERRORS` where the compressed stream is damaged or
    truncated. Memory does not grow with the size of the content.

    Raises
    ------
    OSError
        If the file cannot be opened.
    """
    stream = path.open("rb")
    compression = _compression(stream.read(_MAGIC_BYTES))
    if compression is None:
        stream.seek(0)
        return stream
    stream.close()
    if compression == "gzip":
        return cast(BinaryIO, gzip.open(path, "rb"))
    if compression == "zstd":
        return cast(BinaryIO, pa.CompressedInputStream(pa.OSFile(str(path)), "zstd"))
    if compression == "xz":
        return cast(BinaryIO, io.BufferedReader(_XzStream(path.open("rb"))))
    return cast(BinaryIO, bz2.open(path, "rb"))


def is_compressed(stream: BinaryIO) -> bool:
    """Return whether a stream from :func:`open_bytes` is decompressed while it is read."""
    return not isinstance(getattr(stream, "raw", None), io.FileIO)


def refuse_compressed(path: Path, what: str) -> Refusal | None:
    """Return why a compressed container cannot be read, or None where it is not compressed.

    Parameters
    ----------
    path : Path
        A file whose decompressed beginning is that of a container.
    what : str
        The container in words, for example ``a Parquet table``.
    """
    compression = _compression_of(path)
    if compression is None:
        return None
    return Refusal(
        "format_not_read",
        f"{what} packed with {compression}: it cannot be read from the middle; unpack it first",
    )


class _XzStream(io.RawIOBase):
    """Decompressed content of an xz file; unlike ``lzma.open``, with a memory limit."""

    def __init__(self, compressed: BinaryIO) -> None:
        self._compressed = compressed
        self._decoder = _xz_decoder()
        self._next = b""

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: "WriteableBuffer") -> int:
        view = memoryview(buffer)
        while not self._decoder.eof or self._find_next_stream():
            if self._decoder.needs_input and not self._next:
                self._next = self._compressed.read(_XZ_READ)
                if not self._next:
                    raise EOFError("the xz stream ends before its end mark")
            content = self._decoder.decompress(self._next, len(view))
            self._next = b""
            if content:
                view[: len(content)] = content
                return len(content)
        return 0

    def _find_next_stream(self) -> bool:
        """Prepare for the next of several concatenated streams; False where there is none."""
        self._next = self._decoder.unused_data.lstrip(b"\0")
        while not self._next and (block := self._compressed.read(_XZ_READ)):
            self._next = block.lstrip(b"\0")
        if self._next:
            self._decoder = _xz_decoder()
        return bool(self._next)

    def close(self) -> None:
        self._compressed.close()
        super().close()


def _xz_decoder() -> lzma.LZMADecompressor:
    return lzma.LZMADecompressor(format=lzma.FORMAT_XZ, memlimit=_XZ_MEMORY)
