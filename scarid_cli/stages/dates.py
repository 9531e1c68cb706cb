"""A clock that shows dates, as seconds since the first row."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from itertools import chain

import pyarrow as pa

from scarid_cli.arrays import Numbers
from scarid_cli.errors import bad_row
from scarid_cli.io.table import Table, doubles, number

DATE = re.compile(r"\d{4}-\d\d-\d\d[T ].*?(?P<zone>Z|[+-]\d\d(:?\d\d)?)?\Z")
NANOSECOND = 1e-9  # s


def since_start(table: Table, clock: str) -> Table:
    """The table whose column `clock`, if it has dates, is the time [s] since its first row.

    Dates are those of Arrow, or texts as ISO 8601 writes them; all have a zone, or none has.
    """
    if clock not in table.columns or not _may_have_dates(table.schema.field(clock).type):
        return table
    at, batches = table.columns.index(clock), table.batches
    first = next(batches, None)
    table = replace(table, batches=chain([first] if first else [], batches))
    kind = _kind(first.column(at)) if first and first.num_rows else None
    if kind is None:
        return table
    schema = table.schema.set(at, number(clock, "s"))
    return replace(table, schema=schema, batches=_rows(table, schema, at, kind))


def _may_have_dates(kind: pa.DataType) -> bool:
    return bool(pa.types.is_timestamp(kind) or pa.types.is_string(kind))


def _kind(column: pa.Array) -> pa.DataType | None:
    """The dates in nanoseconds, with a zone if the first one has one; None if it is no date."""
    if pa.types.is_timestamp(column.type):
        return pa.timestamp("ns", column.type.tz)
    found = DATE.match(str(column[0]))
    return pa.timestamp("ns", "UTC" if found["zone"] else None) if found else None


def _rows(table: Table, schema: pa.Schema, at: int, kind: pa.DataType) -> Iterator[pa.RecordBatch]:
    start, row = None, 0
    for batch in table.batches:
        dates = batch.column(at)
        times = _whole(dates, kind)
        if times is None:
            wrong = next(k for k in range(len(dates)) if _whole(dates[k : k + 1], kind) is None)
            found = f"'{dates[wrong]}'" if dates[wrong].is_valid else "no value"
            expected = f"a date such as {dates[0]}"
            at_row = table.row(row + wrong + 1)
            raise bad_row(table.name, found, expected, at_row, schema[at].name)
        if start is None and len(times):
            start = times[0]
        columns = [*batch.columns]
        columns[at] = doubles((times - (start or 0)) * NANOSECOND)
        row += batch.num_rows
        yield pa.RecordBatch.from_arrays(columns, schema=schema)


def _whole(dates: pa.Array, kind: pa.DataType) -> Numbers | None:
    """The dates in whole nanoseconds, whose differences are exact; None if one is no date."""
    try:
        times: Numbers = dates.cast(kind).cast(pa.int64()).to_numpy()
    except pa.ArrowInvalid:
        return None
    return times
