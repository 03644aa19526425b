"""Packed files: recognised by their first bytes and unpacked as a stream, never as a whole."""

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

DAMAGED = (OSError, EOFError, zlib.error, lzma.LZMAError)
"""What reading a damaged or truncated stream raises."""
ENDINGS = (".gz", ".zst", ".xz", ".bz2")
"""Endings of packed files, for names only: what a file is, its first bytes decide."""

_MAGIC = (
    (b"\x1f\x8b", "gzip"),
    (b"\x28\xb5\x2f\xfd", "zstd"),
    (b"\xfd7zXZ\0", "xz"),
    (b"BZh", "bzip2"),
)
_BZIP2_BLOCKS = (b"1AY&SY", b"\x17rE8P\x90")
"""How the first block of a bzip2 stream begins; text may begin with ``BZh`` too."""
_START = 10
"""So many first bytes tell how a file is packed."""
_XZ_MEMORY = 1 << 27
"""What an xz stream may ask for: twice the need of the strongest preset. [bytes]"""
_XZ_READ = 1 << 16


def packing_of(path: Path) -> str | None:
    """Return how a file is packed by its first bytes: gzip, zstd, xz, bzip2, or None.

    Raises
    ------
    OSError
        If the file cannot be opened.
    """
    with path.open("rb") as stream:
        return _packing(stream.read(_START))


def _packing(start: bytes) -> str | None:
    for magic, name in _MAGIC:
        if start.startswith(magic) and (name != "bzip2" or start[4:] in _BZIP2_BLOCKS):
            return name
    return None


def open_bytes(path: Path) -> BinaryIO:
    """Open a file for reading, unpacking it on the way.

    What the file is packed with must be whole: reading raises one of :data:`DAMAGED` where it is
    not. Memory does not grow with the size of the content.

    Raises
    ------
    OSError
        If the file cannot be opened.
    """
    stream = path.open("rb")
    packing = _packing(stream.read(_START))
    if packing is None:
        stream.seek(0)
        return stream
    stream.close()
    if packing == "gzip":
        return cast(BinaryIO, gzip.open(path, "rb"))
    if packing == "zstd":
        return cast(BinaryIO, pa.CompressedInputStream(pa.OSFile(str(path)), "zstd"))
    if packing == "xz":
        return cast(BinaryIO, io.BufferedReader(_XzStream(path.open("rb"))))
    return cast(BinaryIO, bz2.open(path, "rb"))


def is_packed(stream: BinaryIO) -> bool:
    """Tell whether what :func:`open_bytes` opened is unpacked on the way."""
    return not isinstance(getattr(stream, "raw", None), io.FileIO)


def refuse_packed(path: Path, what: str) -> Refusal | None:
    """Return why a packed container cannot be read, or None where it is not packed.

    Parameters
    ----------
    path : Path
        A file whose unpacked beginning is a container's.
    what : str
        The container, for example ``a Parquet table``.
    """
    packing = packing_of(path)
    if packing is None:
        return None
    return Refusal(
        "format_not_read",
        f"{what} packed with {packing}: it cannot be read from the middle; unpack it first",
    )


class _XzStream(io.RawIOBase):
    """An xz file unpacked; unlike ``lzma.open``, with a limit to the memory a header can ask."""

    def __init__(self, packed: BinaryIO) -> None:
        self._packed = packed
        self._decoder = _xz_decoder()
        self._next = b""

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: "WriteableBuffer") -> int:
        view = memoryview(buffer)
        while not self._decoder.eof or self._find_next_stream():
            if self._decoder.needs_input and not self._next:
                self._next = self._packed.read(_XZ_READ)
                if not self._next:
                    raise EOFError("the xz stream ends before its end mark")
            content = self._decoder.decompress(self._next, len(view))
            self._next = b""
            if content:
                view[: len(content)] = content
                return len(content)
        return 0

    def _find_next_stream(self) -> bool:
        """Get ready for a stream that follows the one just ended; False where there is none."""
        self._next = self._decoder.unused_data.lstrip(b"\0")
        while not self._next and (block := self._packed.read(_XZ_READ)):
            self._next = block.lstrip(b"\0")
        if self._next:
            self._decoder = _xz_decoder()
        return bool(self._next)

    def close(self) -> None:
        self._packed.close()
        super().close()


def _xz_decoder() -> lzma.LZMADecompressor:
    return lzma.LZMADecompressor(format=lzma.FORMAT_XZ, memlimit=_XZ_MEMORY)
