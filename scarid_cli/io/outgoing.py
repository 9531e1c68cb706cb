"""Arrow IPC streams and files, and Parquet, as they are written."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pyarrow as pa
import pyarrow.ipc as ipc

from scarid_cli.io.bytesource import PIPE, require_moderate
from scarid_cli.io.checksums import TO_BE_FILLED, filled

COPIES = 4  # of a group of rows that are in memory while it is written
# Rows of a Parquet row group or of a block of an Arrow file. They are fixed so that the bytes of a
# file do not depend on how its rows arrived.
GROUP_ROWS = 1 << 16
GROUP = 1 << 26  # bytes of the numbers of a group at most; wide tables have fewer rows in each


class PyarrowFile:
    """The file-like object that pyarrow writes to. Once cut, it drops everything.

    pyarrow's writers write their end mark even when an exception closes them, and a table with an
    end mark would look complete.
    """

    closed = False

    def __init__(self, write: Callable[[bytes], None]) -> None:
        self._write = write
        self._cut = False
        self._position = 0

    def write(self, data: Any) -> int:
        size = len(data)
        if not self._cut:
            self._write(data)
        self._position += size
        return size

    def tell(self) -> int:
        return self._position

    def flush(self) -> None:
        """Nothing is held back."""

    def close(self) -> None:
        """The output is closed where it was opened."""

    def cut(self) -> None:
        self._cut = True


class _Writer:
    """What the writers share: a writer of pyarrow, which is cut off if the command fails."""

    FILE = PyarrowFile

    def __init__(self, write: Callable[[bytes], None], schema: pa.Schema) -> None:
        self._schema = schema
        self._file = self.FILE(write)
        self._writer = self._opened()

    def _opened(self) -> Any:
        """The writer of pyarrow for this schema."""
        raise NotImplementedError

    def close(self) -> None:
        self._writer.close()

    def abort(self) -> None:
        self._file.cut()
        self._writer.close()


class HeldFile(PyarrowFile):
    """Holds what pyarrow writes of a batch until its checksum is known."""

    def __init__(self, write: Callable[[Any], None]) -> None:
        self._parts: list[Any] = []
        self._send = write
        self._sum = 0
        super().__init__(self._parts.append)

    def send_batch(self) -> None:
        """Write what is held, a batch and what precedes it, with its checksum."""
        data, self._sum = filled(self._parts, self._sum)
        self._parts.clear()
        if sum(map(len, data)) < PIPE:  # whoever reads a pipe wakes up once
            data = [b"".join(data)]
        for part in data:
            self._send(part)

    def send_rest(self) -> None:
        """Write what is held, the end of the table."""
        self._send(b"".join(self._parts))


class _ArrowWriter(_Writer):
    """The part common to Arrow streams and files: checksums (io/checksums.py)."""

    _file: HeldFile
    FILE = HeldFile

    def __init__(self, write: Callable[[bytes], None], schema: pa.Schema) -> None:
        super().__init__(write, schema)
        columns = schema.empty_table().columns
        self._end = pa.RecordBatch.from_arrays([c.chunk(0) for c in columns], schema=schema)

    def _put_batch(self, batch: pa.RecordBatch) -> None:
        self._writer.write_batch(batch, custom_metadata=TO_BE_FILLED)
        self._file.send_batch()
        self._end = batch.slice(0, 0)  # with its dictionaries, which a file cannot replace

    def close(self) -> None:
        """Mark the end of the table."""
        self._put_batch(self._end)
        super().close()
        self._file.send_rest()


class StreamWriter(_ArrowWriter):
    """An Arrow IPC stream: batches leave as they arrive, the end mark only on success."""

    def _opened(self) -> Any:
        return ipc.new_stream(self._file, self._schema)

    def write(self, batch: pa.RecordBatch) -> None:
        if batch.num_rows:
            self._put_batch(batch.replace_schema_metadata(self._schema.metadata))


class _GroupWriter(_Writer):
    """The part common to files: batches are gathered into groups of a fixed number of rows."""

    def __init__(self, write: Callable[[bytes], None], schema: pa.Schema) -> None:
        super().__init__(write, schema)
        self._held: list[pa.RecordBatch] = []
        self._rows = self._bytes = 0
        self._group = min(GROUP_ROWS, max(1, GROUP // (8 * max(1, len(schema)))))

    def write(self, batch: pa.RecordBatch) -> None:
        self._held.append(batch.replace_schema_metadata(self._schema.metadata))
        self._rows += batch.num_rows
        self._bytes += batch.nbytes
        require_moderate("the output", COPIES * self._bytes)
        while self._rows >= self._group:
            table = pa.Table.from_batches(self._held, self._schema)
            self._put(table.slice(0, self._group))
            self._held = table.slice(self._group).to_batches()
            self._rows -= self._group
            self._bytes = sum(held.nbytes for held in self._held)

    def close(self) -> None:
        if self._rows:
            self._put(pa.Table.from_batches(self._held, self._schema))
        super().close()

    def _put(self, table: pa.Table) -> None:
        """Write one group of rows."""
        raise NotImplementedError


class FileWriter(_GroupWriter, _ArrowWriter):
    """An Arrow IPC file."""

    def _opened(self) -> Any:
        return ipc.new_file(self._file, self._schema)

    def _put(self, table: pa.Table) -> None:
        self._put_batch(table.combine_chunks().to_batches()[0])


class ParquetWriter(_GroupWriter):
    """Parquet with settings for doubles: 5 times faster and 44 % smaller than the defaults."""

    def _opened(self) -> Any:
        import pyarrow.parquet as pq

        floats = [field.name for field in self._schema if pa.types.is_floating(field.type)]
        return pq.ParquetWriter(
            self._file,
            self._schema,
            use_dictionary=False,
            write_page_checksum=True,
            use_byte_stream_split=floats,
            compression="zstd",
            compression_level=1,
        )

    def _put(self, table: pa.Table) -> None:
        self._writer.write_table(table.combine_chunks(), row_group_size=GROUP_ROWS)
