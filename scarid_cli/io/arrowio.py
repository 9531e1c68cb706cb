"""Tables from Arrow IPC streams and files, and Parquet, with their metadata; damage is detected."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import replace
from itertools import chain
from typing import Any

import pyarrow as pa
import pyarrow.ipc as ipc

from scarid_cli.errors import BadData, OutputFailure, ScaridError, cut_short
from scarid_cli.io.bytesource import CHUNK, STDIN, ByteSource, max_batch
from scarid_cli.io.incoming import END_OF_STREAM, Incoming
from scarid_cli.io.messages import MAGIC, PREFIX, RECORDS, Message
from scarid_cli.io.parts import parts
from scarid_cli.io.schemas import column_type
from scarid_cli.io.stop import STOP
from scarid_cli.io.table import METADATA_KEY, UNIT_KEY, Metadata, Table, cast, concatenated
from scarid_cli.io.weight import Blocks

FEW = 64  # rows of a batch that is joined with others, and how many are


def read_stream(source: ByteSource) -> Table:
    """A table from an Arrow IPC stream."""
    if isinstance(source, Handed):
        return source.table
    incoming = Incoming(source)
    try:
        reader = ipc.open_stream(pa.PythonFile(incoming, mode="r"))
    except (pa.ArrowException, OSError) as error:
        raise _unreadable(source.name, error) from None

    def batches() -> Iterator[pa.RecordBatch]:
        try:
            yield from _gathered(reader, source)
        except (pa.ArrowException, OSError):
            if STOP.number:  # in the middle of a batch
                return
            raise cut_short(source.name) from None
        if not STOP.number:
            incoming.require_whole()

    return of_arrow(source.name, reader.schema, batches())


def _gathered(reader: ipc.RecordBatchStreamReader, source: ByteSource) -> Iterator[pa.RecordBatch]:
    """The batches; small ones that wait already are joined, so that who is late catches up."""
    if not all(pa.types.is_primitive(field.type) for field in reader.schema):
        yield from reader
        return
    held: list[pa.RecordBatch] = []
    try:
        for batch in reader:
            held.append(batch)
            if len(batch) < FEW and len(held) < FEW and source.waits():
                continue
            together, held = _together(held), []
            yield together
    except Exception:  # what came before the damage has been read
        if held:
            yield _together(held)
        raise
    if held:
        yield _together(held)


def _together(batches: list[pa.RecordBatch]) -> pa.RecordBatch:
    """Batches of one table as a single one, which has no rows if none has."""
    return concatenated([batch for batch in batches if batch.num_rows] or batches[:1])


class Handed(ByteSource):
    """The table of the stage before `then`, in place of the stream that a pipe would carry.

    Its first bytes say that it is an Arrow stream, and nobody reads any others.
    """

    def __init__(self, table: Table) -> None:
        super().__init__(0, STDIN)
        self._ahead = END_OF_STREAM
        self.table = of_arrow(STDIN, table.arrow_schema(), table.batches)

    @property
    def regular(self) -> bool:
        """It stands for a pipe."""
        return False


def read_file(source: ByteSource) -> Table:
    """A table from an Arrow IPC file.

    It contains a stream, which is read if scarid wrote it, for its checksums. Other files are read
    as their footer says: their batches may be in another order, and a stream need not end.
    """
    if _is_verifiable(source):
        source.read(len(MAGIC))
        table = read_stream(source)
        return replace(table, batches=_footed(table.batches, source))
    file = source.seekable()
    blocks = Blocks.of(source.name, file)
    blocks.require_moderate(blocks.dictionaries)
    try:
        reader = ipc.open_file(pa.PythonFile(file, mode="r"))
    except (pa.ArrowException, OSError) as error:
        raise _unreadable(source.name, error) from None

    def batches() -> Iterator[pa.RecordBatch]:
        for i, block in enumerate(blocks.records):
            blocks.require_moderate([block])
            yield reader.get_batch(i)

    return of_arrow(source.name, reader.schema, batches())


def _is_verifiable(source: ByteSource) -> bool:
    """Whether the first batch of a file has a checksum."""
    start = len(MAGIC) + PREFIX
    while start <= max_batch():
        size = int.from_bytes(source.peek(start)[start - 4 :], "little")
        if size > max_batch():
            break
        try:
            message = Message.of(source.peek(start + size)[start : start + size])
        except (struct.error, ValueError):
            break
        if message.kind == RECORDS:
            return message.checksum > 0
        start += size + message.body + PREFIX
    return False


def _footed(batches: Iterator[pa.RecordBatch], source: ByteSource) -> Iterator[pa.RecordBatch]:
    """The batches of a file, whose footer must be there although nothing is read from it."""
    yield from batches
    size, end = 0, b""
    while data := source.read_some(CHUNK):
        size, end = size + len(data), (end + data)[-len(MAGIC) - 2 :]
    if not end.endswith(b"ARROW1") or int.from_bytes(end[:4], "little") + len(end) != size:
        raise cut_short(source.name)


def read_parquet(source: ByteSource) -> Table:
    """A table from Parquet."""
    from scarid_cli.io import pages

    try:
        file = pages.opened(source.seekable(), source.name)
    except (pa.ArrowException, OSError) as error:
        raise _unreadable(source.name, error) from None
    batches = file.iter_batches(batch_size=pages.rows_at_once(file), use_threads=False)
    found = _counted(batches, source.name, file.metadata)
    return replace(of_arrow(source.name, file.schema_arrow, found), length=file.metadata.num_rows)


def _counted(batches: Iterator[pa.RecordBatch], name: str, footer: Any) -> Iterator[pa.RecordBatch]:
    """The batches. A damaged page header can end a row group early, and pyarrow does not notice."""
    rows = 0
    for batch in batches:
        rows += batch.num_rows
        yield batch
    if rows != footer.num_rows:
        raise BadData(
            f"{name}: found {rows} rows, expected {footer.num_rows} as the end of the file states; "
            "the file is damaged, write it again"
        )


def _unreadable(name: str, error: Exception) -> ScaridError:
    if isinstance(error, OSError) and error.errno:  # the device, and not the content
        return OutputFailure(f"{name}: {error.strerror}")
    reason = str(error).partition("\n")[0]
    return BadData(f"{name}: not a complete Arrow or Parquet table ({reason}); write it again")


def of_arrow(name: str, schema: pa.Schema, batches: Iterator[pa.RecordBatch]) -> Table:
    """The table of Arrow batches, with what the metadata say; damage that is found is BadData."""
    document = (schema.metadata or {}).get(METADATA_KEY)
    try:
        meta = Metadata.from_json(document) if document else Metadata()
    except (ValueError, KeyError, TypeError, RecursionError):
        raise BadData(
            f"{name}: the scarid metadata of the table cannot be read; write it again"
        ) from None
    try:
        plain = pa.schema([_plain(field) for field in schema])
    except UnicodeDecodeError:
        raise BadData(
            f"{name}: the name of a column is not UTF-8; rename it where the table is made"
        ) from None
    sound = _sound(name, batches)
    at = schema.get_field_index("t")  # -1 without it, and where there are two
    if at >= 0 and pa.types.is_int64(schema.field(at).type):
        first = next(sound, None)
        sound = chain([first] if first else [], sound)
        if first and _beyond_doubles(first.column(at)):
            plain = plain.set(at, pa.field("t", pa.int64()))
    return Table(name, plain, meta, (cast(batch, plain, name) for batch in sound))


def _beyond_doubles(times: pa.Array) -> bool:
    """Whether whole numbers are nanoseconds since 1970, of which a double is not exact."""
    try:
        times.cast(pa.float64())
    except pa.ArrowInvalid:
        return True
    return False


def _sound(name: str, batches: Iterator[pa.RecordBatch]) -> Iterator[pa.RecordBatch]:
    """The batches in parts, with buffers that can be read; damage found on the way is BadData."""
    while True:
        try:
            batch = next(batches, None)
            if batch is None:
                return
            # The offsets of texts point into memory; numbers have none, and cost no time here.
            batch.validate(full=not all(pa.types.is_primitive(f.type) for f in batch.schema))
        except (pa.ArrowException, OSError) as error:
            raise _unreadable(name, error) from None
        yield from parts(batch, name)


def _plain(field: pa.Field) -> pa.Field:
    """The field with doubles, 64-bit integers or text, and no metadata but the unit.

    Whole numbers in a column whose role asks for doubles are doubles, as they are from CSV.
    """
    kind = field.type
    if pa.types.is_dictionary(kind):
        kind = kind.value_type
    if pa.types.is_floating(kind) or pa.types.is_decimal(kind):
        kind = pa.float64()
    elif pa.types.is_integer(kind):
        kind = pa.float64() if column_type(field.name) == pa.float64() else pa.int64()
    elif pa.types.is_large_string(kind) or pa.types.is_string_view(kind):
        kind = pa.string()
    unit = (field.metadata or {}).get(UNIT_KEY)
    return pa.field(field.name, kind, metadata={UNIT_KEY: unit} if unit else None)
