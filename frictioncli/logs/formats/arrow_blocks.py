"""What the batches of an Arrow file are made of, told before they are loaded.

pyarrow loads a batch whole, and 100 kB can unpack to 3 GB of zeros. Each packed buffer begins with
its length; where the buffers are is told by the footer and by a description in front of each batch,
in the encoding of FlatBuffers. Format: https://arrow.apache.org/docs/format/Columnar.html, section
IPC File Format.
"""

import struct
from dataclasses import dataclass
from typing import BinaryIO

from frictioncli.logs.log_source import UnreadableLog

_MAGIC = b"ARROW1"
_SCHEMA, _DICTIONARIES, _BATCHES = 1, 2, 3
"""Fields of the footer."""
_BIG_ENDIAN = 0
"""Field of the schema; absent where numbers begin with their lowest byte."""
_BLOCK = struct.Struct("<qi4xq")
"""Location of a batch in the file, and length of its description and of its buffers. [byte]"""
_HEADER_KIND, _HEADER = 1, 2
_DICTIONARY_KIND, _DICTIONARY_DATA = 2, 1
_LENGTH, _BUFFERS, _COMPRESSION = 0, 2, 3
_BUFFER = struct.Struct("<qq")
_LONG = struct.Struct("<q")
_CONTINUED = 0xFFFFFFFF
_MOST_BYTES = 1 << 30
"""Most that a batch may unpack to. [byte]"""


@dataclass(frozen=True, slots=True)
class StoredBatch:
    """A batch in a file.

    Attributes
    ----------
    rows : int
        Its length.
    is_packed : bool
        Whether its buffers are compressed.
    buffers : tuple of (int, int)
        Location in the file and length of each. [byte]
    """

    rows: int
    is_packed: bool
    buffers: tuple[tuple[int, int], ...]

    @property
    def length(self) -> int:
        """Length of all buffers as they are stored, in bytes."""
        return sum(length for _, length in self.buffers)

    def check(self, stream: BinaryIO) -> None:
        """Raise ``UnreadableLog`` if the batch unpacks to too much."""
        if not self.is_packed:
            return
        unpacked = 0
        for begin, length in self.buffers:
            if length >= _LONG.size:  # -1: this one is not packed
                unpacked += max(_LONG.unpack(read_bytes(stream, begin, _LONG.size))[0], 0)
        refuse_above(unpacked, "unpacks to")


@dataclass(frozen=True, slots=True)
class Blocks:
    """Locations of the batches of a file.

    Attributes
    ----------
    stream : file
        The file.
    is_big_endian : bool
        Whether its numbers begin with their highest byte.
    batches : tuple of (int, int, int)
        Location of each batch, length of its description, location of its buffers. [byte]
    """

    stream: BinaryIO
    is_big_endian: bool
    batches: tuple[tuple[int, int, int], ...]

    def checked(self, number: int) -> StoredBatch | None:
        """Return a batch, None where it has no buffers.

        Raises
        ------
        UnreadableLog
            If it unpacks to too much.
        """
        return _checked(self.stream, *self.batches[number])


def blocks_of(stream: BinaryIO) -> Blocks:
    """Return the locations of the batches of an Arrow file; dictionaries are checked at once.

    Parameters
    ----------
    stream : file
        The file.

    Raises
    ------
    UnreadableLog
        If a dictionary unpacks to too much.
    struct.error, IndexError, ValueError
        If the file is damaged.
    """
    end = stream.seek(0, 2) - len(_MAGIC) - 4
    length = int.from_bytes(read_bytes(stream, end, 4), "little")
    content = read_bytes(stream, end - length, length)
    footer = _root(content, 0)
    for place in _blocks(content, footer, _DICTIONARIES):
        _checked(stream, *place)
    schema = _field(content, footer, _SCHEMA)
    order = None if schema is None else _field(content, _root(content, schema), _BIG_ENDIAN)
    is_big_endian = order is not None and content[order : order + 2] != b"\0\0"
    return Blocks(stream, is_big_endian, tuple(_blocks(content, footer, _BATCHES)))


def read_bytes(stream: BinaryIO, begin: int, length: int) -> bytes:
    """Return bytes of a file.

    Raises
    ------
    ValueError
        If the file ends before.
    """
    if begin < 0 or length < 0:
        raise ValueError("its footer is damaged")
    stream.seek(begin)
    content = stream.read(length)
    if len(content) < length:
        raise ValueError("it ends before its last row")
    return content


def refuse_above(length: int, what: str) -> None:
    """Raise ``UnreadableLog`` if a batch takes more memory than it may."""
    if length > _MOST_BYTES:
        raise UnreadableLog(
            f"an Arrow table with a batch that {what} {length >> 20} MiB, which is loaded at"
            f" once, more than {_MOST_BYTES >> 20}; save it in smaller batches"
        )


def _checked(stream: BinaryIO, begin: int, length: int, body: int) -> StoredBatch | None:
    content = read_bytes(stream, begin, length)
    message = _root(content, 8 if _number(content, 0) == _CONTINUED else 4)
    kind, header = _field(content, message, _HEADER_KIND), _field(content, message, _HEADER)
    if kind is None or header is None:
        return None
    batch: int | None = _root(content, header)
    if content[kind] == _DICTIONARY_KIND:
        data = _field(content, _root(content, header), _DICTIONARY_DATA)
        batch = None if data is None else _root(content, data)
    if batch is None:
        return None
    at, count = _vector(content, batch, _BUFFERS)
    found = [_BUFFER.unpack_from(content, at + number * _BUFFER.size) for number in range(count)]
    rows = _field(content, batch, _LENGTH)
    block = StoredBatch(
        0 if rows is None else _LONG.unpack_from(content, rows)[0],
        _field(content, batch, _COMPRESSION) is not None,
        tuple((body + place, length) for place, length in found),
    )
    block.check(stream)
    return block


def _blocks(file: bytes, footer: int, field: int) -> list[tuple[int, int, int]]:
    begin, count = _vector(file, footer, field)
    if begin + count * _BLOCK.size > len(file):
        raise ValueError("its footer is damaged")
    content = file[begin : begin + count * _BLOCK.size]
    return [(place, length, place + length) for place, length, _ in _BLOCK.iter_unpack(content)]


def _number(file: bytes, at: int) -> int:
    return int.from_bytes(file[at : at + 4], "little")


def _root(file: bytes, at: int) -> int:
    return at + _number(file, at)


def _field(file: bytes, table: int, number: int) -> int | None:
    """Return where a field of a table is; None where the table has none."""
    fields = table - int.from_bytes(file[table : table + 4], "little", signed=True)
    at = 4 + 2 * number
    if at >= int.from_bytes(file[fields : fields + 2], "little"):
        return None
    offset = int.from_bytes(file[fields + at : fields + at + 2], "little")
    return table + offset if offset else None


def _vector(file: bytes, table: int, number: int) -> tuple[int, int]:
    """Return where the elements of a vector begin, and their number."""
    field = _field(file, table, number)
    if field is None:
        return 0, 0
    at = field + _number(file, field)
    return at + 4, _number(file, at)
