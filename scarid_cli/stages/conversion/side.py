"""Columns of lists taken apart, episodes on one clock, and tables side by side."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from dataclasses import replace
from itertools import chain

import numpy as np
import pyarrow as pa

from scarid_cli.errors import BadData, bad_data
from scarid_cli.io.table import SEGMENT, Table, doubles, integers, matrix, number

LIST = re.compile(r"(?:array\('\w', )?[\[({]([^\[\](){}]+)[\])}]\)?")  # numbers in a text
CLOCK = re.compile(r"(?i)t|time.*|.*stamp.*|index|seq|row|.*sec")
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


def texts_flattened(table: Table) -> Table:
    """The table with lists in cells of text, as in "[0.1, 0.2]", taken apart."""
    texts = [field.name for field in table.schema if pa.types.is_string(field.type)]
    if not texts:
        return table
    batches = table.batches
    first = next(batches, None)
    if first is None or not first.num_rows:
        return table
    starts = {name: _numbers_in(first.column(name)[0].as_py()) for name in texts}
    lengths = {name: len(own) for name, own in starts.items() if own}
    rows = chain([first], batches)
    if not lengths:
        return replace(table, batches=rows)
    schema = pa.schema([pa.field(f.name, pa.list_(pa.float64())) if f.name in lengths else f
                        for f in table.schema])  # fmt: skip
    lists = (_with_lists(batch, schema, lengths, table.name) for batch in rows)
    return flattened(replace(table, schema=schema, batches=lists))


def _with_lists(
    batch: pa.RecordBatch, schema: pa.Schema, names: Collection[str], name: str
) -> pa.RecordBatch:
    columns = []
    for field, column in zip(batch.schema, batch.columns, strict=True):
        if field.name not in names:
            columns.append(column)
            continue
        values = [_numbers_in(text) for text in column.to_pylist()]
        if None in values:
            at = values.index(None)
            raise bad_data(
                name,
                f"'{column[at]}'",
                expected="a list of numbers as in the first row",
                remedy="correct or remove the row",
                row=at + 1,
                column=field.name,
            )
        columns.append(pa.array(values, pa.list_(pa.float64())))
    return pa.RecordBatch.from_arrays(columns, schema=schema)


def _numbers_in(text: str | None) -> list[float] | None:
    """The numbers of a text such as `[0.1, 0.2]`, `(1 2)`, `array('d', [1, 2])`; None if none."""
    match = LIST.fullmatch((text or "").strip())
    if not match:
        return None
    try:
        return [float(word) for word in re.split(r"[,;\s]+", match[1].strip())]
    except ValueError:
        return None


def as_role(table: Table, role: str, known: Collection[str]) -> Table:
    """The table with its columns of numbers called role1, role2, ...; what the log has as well
    (`known`) goes, and so do times and counters of rows.
    """
    lengths = [f.name for f in table.schema if pa.types.is_floating(f.type)]
    clocks = {name for name in table.columns if CLOCK.fullmatch(name)}
    values = [name for name in lengths if name not in clocks]
    if not values:
        raise BadData(
            f"{table.name}: no columns of numbers for {role}; it has {', '.join(table.columns)}"
        )
    names = [f"{role}{i}" for i in range(1, len(values) + 1)]
    if both := [name for name in names if name in known]:
        raise BadData(f"{table.name}: the log has {both[0]} already; leave out {role}=")
    schema = pa.schema([number(name) for name in names])
    batches = (
        pa.RecordBatch.from_arrays([doubles(x) for x in matrix(batch, values)], schema=schema)
        for batch in table.batches
    )
    return replace(table, schema=schema, batches=batches)


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
