from _typeshed import ReadableBuffer, WriteableBuffer

def columns(
    text: bytes, delimiter: int, decimal: int, wanted: ReadableBuffer, out: WriteableBuffer, /
) -> bool: ...
