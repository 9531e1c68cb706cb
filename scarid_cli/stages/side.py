"""Columns of lists taken apart, episodes on one clock, and tables side by side."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import chain

import numpy as np
import pyarrow as pa

from scarid_cli.errors import BadData, bad_data
from scarid_cli.io.table import SEGMENT, Table, doubles, integers, matrix, number

PAUSE = 1.0  # seconds between two episodes, whose clocks each start at 0


def flattened(table: Table) -> Table:
    """The table with a column name[0], name[1], ... for each element of a list of numbers."""
    lists = [field.name for field in table.schema if _is_list(field.type)]
    if not lists:
        return table
    batches = table.batches
    first = next(batches, None)
    if first is None or not first.num_rows:
        return table
    lengths = {name: len(first.column(name)[0]) for name in lists}
    fields: list[pa.Field] = []
    for field in table.schema:
        own = [number(f"{field.name}[{k}]") for k in range(lengths.get(field.name, 0))]
        fields += own if field.name in lists else [field]
    schema = pa.schema(fields)
    rows = (_flat(batch, schema, lengths, table.name) for batch in chain([first], batches))
    return replace(table, schema=schema, batches=rows)


def _is_list(kind: pa.DataType) -> bool:
    nested = pa.types.is_list(kind) or pa.types.is_fixed_size_list(kind)
    return bool(nested and pa.types.is_floating(kind.value_type))


def _flat(
    batch: pa.RecordBatch, schema: pa.Schema, lengths: dict[str, int], name: str
) -> pa.RecordBatch:
    columns: list[pa.Array] = []
    for field, column in zip(batch.schema, batch.columns, strict=True):
        if field.name not in lengths:
            columns.append(column)
            continue
        values = column.flatten().to_numpy(zero_copy_only=False).astype(np.float64)
        if len(values) != batch.num_rows * lengths[field.name]:
            raise bad_data(
                name,
                "lists of different lengths",
                expected=f"{lengths[field.name]} numbers in each row",
                remedy="export it again",
                column=field.name,
            )
        columns += [doubles(x) for x in values.reshape(batch.num_rows, -1).T]
    return pa.RecordBatch.from_arrays(columns, schema=schema)


def episodes_joined(table: Table, episode: str) -> Table:
    """The table with a `segment` for each episode, and a time `t` [s] that goes on between them."""
    if not {"t", episode} <= {*table.columns} or SEGMENT in table.columns:
        return table
    schema = table.schema.append(pa.field(SEGMENT, pa.int64()))

    def rows() -> Iterator[pa.RecordBatch]:
        last, segment, end, offset = None, -1, -PAUSE, 0.0
        for batch in table.batches:
            t, numbers = matrix(batch, ["t", episode])
            segments = np.empty(len(t), dtype=np.int64)
            for start in np.flatnonzero(np.diff(numbers, prepend=np.nan) != 0.0):
                if numbers[start] != last:
                    last, segment = numbers[start], segment + 1
                    offset = end + PAUSE - t[start] if segment else 0.0
                own = (np.arange(len(t)) >= start) & (numbers == numbers[start])
                t[own] += offset
                segments[own] = segment
                end = float(t[own][-1])
            columns = [doubles(t) if n == "t" else batch.column(n) for n in table.columns]
            yield pa.RecordBatch.from_arrays([*columns, integers(segments)], schema=schema)

    return replace(table, schema=schema, batches=rows())


def side_by_side(table: Table, other: Table) -> Table:
    """The columns of two tables with the same rows; those that both have must agree."""
    both = [name for name in other.columns if name in table.columns]
    new = [name for name in other.columns if name not in both]
    schema = pa.schema([*table.schema, *(other.schema.field(name) for name in new)])

    def rows() -> Iterator[pa.RecordBatch]:
        queue = _Queue(other)
        row = 0
        for batch in table.batches:
            beside = queue.take(batch.num_rows, table.name)
            _check_equal(batch, beside, both, (table.name, other.name), row)
            row += batch.num_rows
            columns = [*batch.columns, *(beside.column(name) for name in new)]
            yield pa.RecordBatch.from_arrays(columns, schema=schema)
        if queue.left():
            raise _unequal(other.name, f"more than the {row} rows of {table.name}")

    return replace(table, schema=schema, batches=rows())


class _Queue:
    """Takes as many rows at a time as are asked for."""

    def __init__(self, table: Table) -> None:
        self._table = table
        self._held = pa.Table.from_batches([], table.schema)
        self._taken = 0

    def take(self, count: int, other: str) -> pa.RecordBatch:
        while self._held.num_rows < count:
            more = next(self._table.batches, None)
            if more is None:
                rows = self._taken + self._held.num_rows
                raise _unequal(
                    self._table.name, f"{rows} row{'' if rows == 1 else 's'}, fewer than in {other}"
                )
            self._held = pa.concat_tables([self._held, pa.Table.from_batches([more])])
        taken = self._held.slice(0, count).combine_chunks().to_batches()
        self._held = self._held.slice(count)
        self._taken += count
        empty = pa.RecordBatch.from_arrays(
            [pa.array([], f.type) for f in self._table.schema], schema=self._table.schema
        )
        return taken[0] if taken else empty

    def left(self) -> bool:
        return bool(self._held.num_rows) or any(b.num_rows for b in self._table.batches)


def _unequal(name: str, found: str) -> BadData:
    return bad_data(
        name,
        found,
        expected="as many rows in both files",
        remedy="record them together, or cut one",
    )


def _check_equal(
    batch: pa.RecordBatch,
    beside: pa.RecordBatch,
    both: list[str],
    names: tuple[str, str],
    row: int,
) -> None:
    for column in both:
        one, two = batch.column(column), beside.column(column)
        if one.equals(two):
            continue
        pairs = zip(one.to_pylist(), two.to_pylist(), strict=True)
        at, (left, right) = next((k, pair) for k, pair in enumerate(pairs) if pair[0] != pair[1])
        raise bad_data(
            names[1],
            str(right),
            expected=f"{left} as in {names[0]}",
            remedy="the files must have the same rows; rename or drop one of the columns",
            row=row + at + 1,
            column=column,
        )
