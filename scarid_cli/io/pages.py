"""Parquet files, opened so that no page of them unfolds to more than memory should hold."""

from __future__ import annotations

from base64 import b64decode
from collections.abc import Iterator
from typing import Any, BinaryIO

import pyarrow as pa
import pyarrow.ipc as ipc
import pyarrow.parquet as pq

from scarid_cli.io.bytesource import CHUNK, require_moderate
from scarid_cli.io.parts import PART, READ_ROWS

WIDTHS = {"BOOLEAN": 1, "INT32": 4, "INT64": 8, "INT96": 12, "FLOAT": 4, "DOUBLE": 8}  # bytes
TEXT = "BYTE_ARRAY"


def opened(file: BinaryIO, name: str) -> pq.ParquetFile:
    """The Parquet file of this name. Columns of texts stay folded, as dictionaries, if they are."""
    try:
        return _opened(file, name)
    except UnicodeDecodeError:
        raise pa.ArrowInvalid("a name in its footer is damaged") from None


def _opened(file: BinaryIO, name: str) -> pq.ParquetFile:
    footer = pq.read_metadata(file)
    _require_own_schema(footer)
    columns = list(_columns(footer))
    require_moderate(name, max((c.total_uncompressed_size for c in columns), default=0))
    schema = [footer.schema.column(i) for i in range(footer.num_columns)]
    nested = {c.path: c for c in schema if c.name != c.path or c.max_repetition_level}
    require_moderate(name, max((_listed(c, nested) for c in columns), default=0))
    # Buffered, or a row group of another writer (a million rows) would be read whole.
    return pq.ParquetFile(
        file,
        metadata=footer,
        read_dictionary=sorted({c.path_in_schema for c in columns if _folded(c)} - nested.keys()),
        pre_buffer=False,
        buffer_size=CHUNK,
        page_checksum_verification=True,
    )


def _require_own_schema(footer: Any) -> None:
    """Refuse a schema that differs from the one that Arrow has stored beside it: it is damaged.

    If a column that may be empty has become one that may not, pyarrow ends the process when it
    reads the statistics of this column.
    """
    written = (footer.metadata or {}).get(b"ARROW:schema")
    if not written:
        return
    stored = ipc.read_schema(pa.py_buffer(b64decode(written)))
    if stored.names != footer.schema.to_arrow_schema().names:
        raise pa.ArrowInvalid("the names of its columns are damaged")
    for i in range(footer.num_columns):
        column = footer.schema.column(i)
        place = stored.get_field_index(column.path)
        if place >= 0 and stored.field(place).nullable and not column.max_definition_level:
            raise pa.ArrowInvalid(f"column {column.path}: its schema is damaged")


def rows_at_once(file: pq.ParquetFile) -> int:
    """How many rows to read at once, given how wide they are."""
    schema = file.metadata.schema
    columns = [schema.column(i) for i in range(file.metadata.num_columns)]
    return max(1, min(READ_ROWS, PART // max(1, sum(map(_width, columns)))))


def _columns(footer: Any) -> Iterator[Any]:
    """The column chunks of all row groups."""
    for i in range(footer.num_row_groups):
        group = footer.row_group(i)
        yield from (group.column(j) for j in range(group.num_columns))


def _folded(chunk: Any) -> bool:
    """Whether this is a chunk of texts, each of which is there once."""
    return chunk.physical_type == TEXT and any("DICTIONARY" in x for x in chunk.encodings)


def _width(column: Any) -> int:
    """The bytes of a value in the schema; 0 for texts."""
    return WIDTHS.get(column.physical_type, max(column.length or 0, 0))


def _listed(chunk: Any, nested: dict[str, Any]) -> int:
    """The bytes that a chunk of lists or structures unfolds to at most; 0 for other columns.

    A single row of them may hold all the values.
    """
    column = nested.get(chunk.path_in_schema)
    if column is None:
        return 0
    width = _width(column) or (chunk.total_uncompressed_size if _folded(chunk) else 1)
    return int(chunk.num_values) * int(width)
