"""Parts of a batch that are small enough to work with, whatever its values unfold to."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pyarrow as pa

from scarid_cli.io.bytesource import require_moderate, require_moderate_row

READ_ROWS = 1 << 13
PART = 1 << 24  # bytes
WIDEST = 32  # bytes of a value that is no text and no list
VIEW = 16  # bytes of a text view, the first four of which are its length


def parts(batch: pa.RecordBatch, name: str) -> Iterator[pa.RecordBatch]:
    """The batch, of the table of this name, in parts of at most READ_ROWS rows and PART bytes.

    A row that takes more bytes is a part by itself; one that takes far too many is BadData.
    """
    small = WIDEST * batch.num_rows * batch.num_columns <= PART and batch.num_rows <= READ_ROWS
    if small and all(pa.types.is_primitive(field.type) for field in batch.schema):
        yield batch
        return
    require_moderate(name, batch.num_rows)  # rows of nothing take no memory before they are written
    for start in range(0, batch.num_rows, READ_ROWS):
        part = batch.slice(start, READ_ROWS)
        require_moderate(name, size := _size(part))
        yield from _halved(part, size, name)


def _halved(batch: pa.RecordBatch, size: int, name: str) -> Iterator[pa.RecordBatch]:
    if size <= PART:
        yield batch
    elif batch.num_rows == 1:
        require_moderate_row(name, size)
        yield batch
    else:
        middle = batch.num_rows // 2
        for half in (batch.slice(0, middle), batch.slice(middle)):
            yield from _halved(half, _size(half), name)


def _size(batch: pa.RecordBatch) -> int:
    """The bytes of a batch in which each row has values of its own."""
    return sum(map(_unfolded, batch.columns))


def _unfolded(column: pa.Array) -> int:
    if pa.types.is_dictionary(column.type):
        return _repeated(column)
    if pa.types.is_string_view(column.type) or pa.types.is_binary_view(column.type):
        views = np.frombuffer(column.buffers()[1], np.int32)[:: VIEW // 4]
        return int(views[column.offset : column.offset + len(column)].sum(dtype=np.int64))
    return int(column.nbytes)


def _repeated(column: pa.Array) -> int:
    """The bytes of a column that names values of a dictionary, without it."""
    values = column.dictionary
    if pa.types.is_primitive(values.type):
        return 8 * len(column)
    import pyarrow.compute as pc  # 40 ms

    try:
        lengths = pc.binary_length(values)
    except pa.ArrowNotImplementedError:
        return len(column) * int(values.nbytes)
    return int(pc.sum(lengths.take(column.indices)).as_py() or 0)
