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
EPOCH = (9e8, 5e9)  # s since 1970: dates from 1998 to 2128


def since_start(table: Table, clock: str) -> Table:
    """The table whose column `clock`, if it has dates, is the time [s] since its first row.

    So is one of milliseconds, microseconds or nanoseconds since 1970.

    Dates are those of Arrow, or texts as ISO 8601 writes them; all have a zone, or none has.
    """
    if clock not in table.columns or not _may_have_dates(table.schema.field(clock).type):
        return table
    at, batches = table.columns.index(clock), table.batches
    if pa.types.is_float64(table.schema[at].type):
        return replace(table, batches=_numbers(table, at))
    first = next(batches, None)
    table = replace(table, batches=chain([first] if first else [], batches))
    kind = _kind(first.column(at)) if first and first.num_rows else None
    if kind is None:
        unit = _epoch_unit(first.column(at)) if first and first.num_rows else None
        return _since_epoch(table, at, unit) if unit else table
    schema = table.schema.set(at, number(clock, "s"))
    return replace(table, schema=schema, batches=_rows(table, schema, at, kind))


def _may_have_dates(kind: pa.DataType) -> bool:
    dates = pa.types.is_timestamp(kind) or pa.types.is_string(kind)
    return bool(dates or pa.types.is_integer(kind) or pa.types.is_floating(kind))


def _epoch_unit(column: pa.Array) -> float | None:
    """The unit [s] of a time since 1970 that is not in seconds, by the size of its first value."""
    try:
        first = float(column[0].as_py())
    except (TypeError, ValueError):
        return None
    found = [unit for unit in (1e-3, 1e-6, NANOSECOND) if EPOCH[0] < unit * first < EPOCH[1]]
    return found[0] if found else None


def _numbers(table: Table, at: int) -> Iterator[pa.RecordBatch]:
    """The rows, as they are or as times since the start, which the first one decides."""
    batches = iter(table.batches)
    first = next((batch for batch in batches if batch.num_rows), None)
    if first is None:
        return
    rows = replace(table, batches=chain([first], batches))
    unit = _epoch_unit(first.column(at))
    yield from _whole_rows(rows, rows.schema, at, unit) if unit else rows.batches


def _since_epoch(table: Table, at: int, unit: float) -> Table:
    """The table whose column `at` of whole numbers in this unit is the time [s] since its start."""
    schema = table.schema.set(at, number(table.schema[at].name, "s"))
    return replace(table, schema=schema, batches=_whole_rows(table, schema, at, unit))


def _whole_rows(table: Table, schema: pa.Schema, at: int, unit: float) -> Iterator[pa.RecordBatch]:
    start, row = None, 0
    for batch in table.batches:
        ticks = batch.column(at)
        times = _integers(ticks)
        if times is None:
            wrong = next(k for k in range(len(ticks)) if _integers(ticks[k : k + 1]) is None)
            found = f"'{ticks[wrong]}'"
            expected = f"a whole number such as {ticks[0]}"
            raise bad_row(table.name, found, expected, table.row(row + wrong + 1), schema[at].name)
        if start is None and len(times):
            start = times[0]
        columns = [*batch.columns]
        columns[at] = doubles((times - (start or 0)) * unit)
        row += batch.num_rows
        yield pa.RecordBatch.from_arrays(columns, schema=schema)


def _integers(column: pa.Array) -> Numbers | None:
    """Times in whole numbers, whose differences are exact; None if one is none."""
    if column.null_count:
        return None
    try:
        times: Numbers = column.cast(
            pa.int64(), safe=not pa.types.is_floating(column.type)
        ).to_numpy()
    except pa.ArrowInvalid:
        return None
    return times


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
