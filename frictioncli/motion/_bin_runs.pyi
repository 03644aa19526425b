from _typeshed import ReadableBuffer, WriteableBuffer

def runs(
    position: ReadableBuffer,
    torque: ReadableBuffer,
    load: ReadableBuffer,
    time: ReadableBuffer,
    start: ReadableBuffer,
    stop: ReadableBuffer,
    width: float,
    sums: WriteableBuffer,
    count: WriteableBuffer,
    end: WriteableBuffer,
    /,
) -> None: ...
