"""The table that flows between stages: columns, metadata, and batches of rows as they arrive."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, fields, replace
from itertools import groupby, pairwise
from math import isfinite
from typing import Any

import numpy as np
import pyarrow as pa

from scarid_cli.arrays import Array, Numbers
from scarid_cli.errors import bad_data
from scarid_cli.io import facts
from scarid_cli.printable import utf8

METADATA_KEY = b"scarid"
UNIT_KEY = b"unit"
SEGMENT = "segment"  # the column that numbers the parts of a record between its gaps


@dataclass(frozen=True)
class Metadata:
    """What a table states about itself, one JSON document in the metadata of its Arrow schema.

    `period` is the nominal sampling period [s]; `history` has one entry for each command that the
    data passed; `extra` holds what only one kind of table has (a condition number, a lag).
    """

    kind: str | None = None
    version: int = 1
    robot: str | None = None
    period: float | None = None
    history: tuple[dict[str, Any], ...] = ()
    extra: dict[str, Any] = field(default_factory=dict)

    def without(self, *keys: str) -> Metadata:
        """The metadata without these keys of `extra`."""
        return replace(self, extra={k: x for k, x in self.extra.items() if k not in keys})

    def to_json(self) -> bytes:
        document = {name.name: getattr(self, name.name) for name in fields(self)}  # no copies
        return json.dumps(document, sort_keys=True, separators=(",", ":")).encode()

    @classmethod
    def from_json(cls, document: bytes) -> Metadata:
        known = json.loads(document)
        meta = cls(**{**known, "history": tuple(known["history"])})
        texts = all(isinstance(x, str | None) for x in (meta.kind, meta.robot))
        entries = all(map(_is_entry, meta.history))
        values = isinstance(meta.extra, dict) and facts.sound(meta.extra)
        values = values and facts.period(meta.period) and isinstance(meta.version, int)
        if not (texts and values and entries and (meta.kind or "a").isalpha()):
            raise ValueError("a part of the metadata has another type than it should")
        return meta


def _as_counted(row: int) -> int:
    return row


def _is_entry(entry: Any) -> bool:
    """Whether this is an entry of a history: a command, a version, and digests of its inputs."""
    if not isinstance(entry, dict) or not isinstance(entry.get("inputs"), dict):
        return False
    digested = all(isinstance(x, str | None) for x in entry["inputs"].values())
    return digested and all(isinstance(entry.get(key), str) for key in ("command", "version"))


@dataclass(frozen=True)
class Table:
    """A stream of record batches with their schema; `name` says where it came from.

    The batches can be iterated once. The unit of a column is in the metadata of its field. `row`
    gives the number in the log of a row of the table, both counted from 1: they differ where rows
    were left out (io/selection.py). `length` is the number of rows, if the input states it.
    """

    name: str
    schema: pa.Schema
    meta: Metadata
    batches: Iterator[pa.RecordBatch]
    row: Callable[[int], int] = _as_counted
    length: int | None = None

    @property
    def columns(self) -> list[str]:
        return list(self.schema.names)

    @property
    def period(self) -> float:
        """The nominal sampling period [s]; 0 for a table that states none."""
        return self.meta.period or 0.0

    def arrow_schema(self) -> pa.Schema:
        """The schema with the metadata attached, as it is written."""
        return self.schema.with_metadata({METADATA_KEY: self.meta.to_json()})

    def unit(self, column: str) -> str | None:
        """The unit of a column, where the table states one."""
        unit = (self.schema.field(column).metadata or {}).get(UNIT_KEY)
        return unit.decode(errors="replace") if unit else None


def number(name: str, unit: str | None = None) -> pa.Field:
    """A column of floating-point numbers."""
    return pa.field(name, pa.float64(), metadata={UNIT_KEY: unit.encode()} if unit else None)


def numbers(name: str, units: list[str]) -> list[pa.Field]:
    """The columns of all joints with this name, in which {i} is the number of the joint."""
    return [number(name.replace("{i}", str(i)), unit) for i, unit in enumerate(units, start=1)]


def motion_fields(units: list[str], suffix: str) -> list[pa.Field]:
    """The columns of position, velocity and acceleration, given the unit of each position."""
    derivatives = (("q", ""), ("dq", "/s"), ("ddq", "/s2"))
    columns = (numbers(f"{q}{{i}}{suffix}", [u + per for u in units]) for q, per in derivatives)
    return [field for fields in columns for field in fields]


def matrix(batch: pa.RecordBatch, columns: list[str]) -> Array:
    """Columns of a batch as one array, a contiguous row per column (len(columns), rows)."""
    out = np.empty((len(columns), batch.num_rows))
    for row, column in zip(out, columns, strict=True):
        row[:] = batch.column(column).to_numpy(zero_copy_only=False)
    return out


def doubles(values: Array) -> pa.Array:
    """A column of numbers without empty cells, made without a copy.

    pyarrow's own conversion would import numpy.ma.
    """
    data = np.ascontiguousarray(values, dtype=np.float64)
    return pa.Array.from_buffers(pa.float64(), len(data), [None, pa.py_buffer(data)])


def integers(values: Any) -> pa.Array:
    """A column of whole numbers, made likewise."""
    data = np.ascontiguousarray(values, dtype=np.int64)
    return pa.Array.from_buffers(pa.int64(), len(data), [None, pa.py_buffer(data)])


def table_of(
    name: str, schema: pa.Schema, rows: Iterable[tuple[Any, ...]], meta: Metadata
) -> Table:
    """A small table of these rows; numbers that are not finite become empty cells.

    Names of files that are not UTF-8 are written with escapes such as \\xff.
    """
    columns = (
        pa.array([_cell(x) for x in values], f.type)
        for f, values in zip(schema, zip(*rows, strict=True), strict=True)
    )
    return Table(name, schema, meta, iter([pa.RecordBatch.from_arrays([*columns], schema=schema)]))


def _cell(value: Any) -> Any:
    if isinstance(value, str):
        return utf8(value)
    return None if isinstance(value, float) and not isfinite(value) else value


def cast(batch: pa.RecordBatch, schema: pa.Schema, name: str) -> pa.RecordBatch:
    """The batch, of the table of this name, with the types of a schema that has the same columns.

    A value that the new type cannot hold exactly is BadData: a whole number beyond 2^53 in a column
    of doubles, or one beyond 2^63.
    """
    columns = [
        column if column.type == field.type else _cast(column, field, name)
        for column, field in zip(batch.columns, schema, strict=True)
    ]
    return pa.RecordBatch.from_arrays(columns, schema=schema)


def remedy_of(column: str) -> str:
    """What to do with a column of another type."""
    if column == "t":
        return "let `scarid convert` make it seconds since the start"
    return "convert the column where the table is made"


def _cast(column: pa.Array, field: pa.Field, name: str) -> pa.Array:
    try:
        return column.cast(field.type)
    except (pa.ArrowInvalid, pa.ArrowNotImplementedError) as error:
        raise bad_data(
            name,
            f"a value of type {column.type} that does not fit ({str(error).partition(chr(10))[0]})",
            expected=str(field.type),
            remedy=remedy_of(field.name),
            column=field.name,
        ) from None


def without(table: Table, column: str) -> Table:
    """The table without a column."""
    return only(table, [name for name in table.columns if name != column])


def only(table: Table, kept: list[str]) -> Table:
    """The table with these of its columns."""
    schema = pa.schema([table.schema.field(name) for name in kept])
    return replace(table, schema=schema, batches=(batch.select(kept) for batch in table.batches))


def with_columns(batch: pa.RecordBatch, schema: pa.Schema, new: dict[str, Any]) -> pa.RecordBatch:
    """The batch with some columns replaced or added, in the order of the schema."""

    def column(name: str) -> pa.Array:
        values = new.get(name)
        if values is None:
            return batch.column(name)
        return values if isinstance(values, pa.Array) else doubles(values)

    return pa.RecordBatch.from_arrays([column(name) for name in schema.names], schema=schema)


def concatenated(batches: Sequence[pa.RecordBatch]) -> pa.RecordBatch:
    """Batches of one schema as a single one; at least one of them has rows."""
    if len(batches) == 1:
        return batches[0]
    return pa.Table.from_batches(batches).combine_chunks().to_batches()[0]


def segments_of(batch: pa.RecordBatch) -> Numbers:
    """The number of the segment that each row belongs to; 0 if the table has no segments."""
    if SEGMENT not in batch.schema.names:
        return np.zeros(batch.num_rows, dtype=np.int64)
    numbers: Numbers = batch.column(SEGMENT).to_numpy(zero_copy_only=False)
    return numbers


Instant = tuple[float, int]  # time [s] and segment of a row


def steps_of(batch: pa.RecordBatch, last: Instant | None) -> tuple[Array, Numbers, Instant]:
    """By how much time [s] and segment advance to each row, and the instant of the last row.

    `last` is the row before the batch; to the very first row both advance by 0.
    """
    t, segment = matrix(batch, ["t"])[0], segments_of(batch)
    time, number = last or (t[0], segment[0])
    steps, jumps = _advances(t, time), _advances(segment, number)
    return steps, jumps, (float(t[-1]), int(segment[-1]))


def _advances(x: Any, before: float) -> Any:
    """By how much each value is beyond the one before it; 5 times as fast as diff for one row."""
    found = x.copy()
    found[0] -= before
    found[1:] -= x[:-1]
    return found


def segment_field(table: Table) -> list[pa.Field]:
    """The field of the column `segment`, if the table has it."""
    return [table.schema.field(SEGMENT)] if SEGMENT in table.columns else []


def segments(table: Table) -> Iterator[Table]:
    """Each segment as a table of its own; iterate over its batches before taking the next."""
    pieces = (piece for batch in table.batches for piece in _pieces(batch))
    for number, group in groupby(pieces, lambda piece: piece[0]):
        batches = (batch for _, batch in group)
        yield replace(table, name=f"{table.name}, segment {number}", batches=batches)


def _pieces(batch: pa.RecordBatch) -> Iterator[tuple[int, pa.RecordBatch]]:
    if SEGMENT not in batch.schema.names and batch.num_rows:
        yield 0, batch
        return
    numbers = segments_of(batch)
    edges = [0, *(np.flatnonzero(np.diff(numbers)) + 1).tolist(), batch.num_rows]
    for start, end in pairwise(edges):
        if end > start:
            yield int(numbers[start]), batch.slice(start, end - start)


def settled(batches: Iterator[pa.RecordBatch]) -> Iterator[pa.RecordBatch]:
    """Only the rows that a soft sensor has marked as settled; all rows of an unmarked table."""
    return (batch for _, batch in settled_runs(batches))


def settled_runs(batches: Iterator[pa.RecordBatch]) -> Iterator[tuple[int, pa.RecordBatch]]:
    """The settled rows in parts, each with the number of its first row in the table.

    No part extends across a gap.
    """
    first = 0
    for batch in batches:
        for _, piece in _pieces(batch):
            for start, end in _settled(piece):
                yield first + start, piece.slice(start, end - start)
            first += piece.num_rows


def _settled(batch: pa.RecordBatch) -> Iterator[tuple[int, int]]:
    """The runs of settled rows: the first row, and the one after the last."""
    if "settled" not in batch.schema.names:
        yield 0, batch.num_rows
        return
    marks = batch.column("settled").to_numpy(zero_copy_only=False) != 0
    if marks.all() and len(marks):  # most batches; this is the fast way for a single row
        yield 0, len(marks)
        return
    ends = np.flatnonzero(np.diff(marks, prepend=False, append=False))
    yield from map(tuple, ends.reshape(-1, 2).tolist())
