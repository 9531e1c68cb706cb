"""A clock that shows dates or times of the day, as seconds since the first row."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain

import numpy as np
import pyarrow as pa

from scarid_cli.arrays import Numbers
from scarid_cli.errors import bad_row
from scarid_cli.io.table import Table, doubles, number

DATE = re.compile(r"\d{4}-\d\d-\d\d[T ].*?(?P<zone>Z|[+-]\d\d(:?\d\d)?)?\Z")
NANOSECOND = 1e-9  # s
# Other texts, by the names of their parts: times of the day, dates in other orders, durations.
OF_DAY = (
    r"(?P<H>\d\d?):(?P<M>\d\d):(?P<S>\d\d)(?:[.,:](?P<f>\d+))?(?: *(?P<half>[AaPp])\.?[Mm]\.?)?"
)
FORMS = tuple(
    re.compile(form)
    for form in (
        OF_DAY,
        rf"(?P<D>\d{{1,5}}) days?,? +{OF_DAY}",  # a difference of two times, as pandas writes it
        rf"(?P<d>\d\d?)\.(?P<m>\d\d?)\.(?P<Y>\d{{4}}),?[ T]+{OF_DAY}",
        rf"(?P<Y>\d{{4}})/(?P<m>\d\d?)/(?P<d>\d\d?),?[ T]+{OF_DAY}",
        # Whether the day or the month comes first, nobody says: it goes on at midnight anyway.
        rf"\d\d?/\d\d?/\d\d(?:\d\d)?,?[ T]+{OF_DAY}",
        r"(?P<M>\d\d?):(?P<S>\d\d)[.,](?P<f>\d+)",
        r"(?P<value>[+-]?[\d.]+(?:[eE][+-]?\d+)?) *(?P<unit>s|secs?|seconds?|ms|msec|us|ns)",
    )
)
UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}  # s
EPOCH = (9e8, 5e9)  # s since 1970: dates from 1998 to 2128
TICK = 1e-7  # s, of Windows' FILETIME since 1601 and of .NET's ticks since the year 1
BEFORE = (11_644_473_600, 62_135_596_800)  # s from these years to 1970


def since_start(table: Table, clock: str) -> Table:
    """The table whose column `clock`, if it has dates, is the time [s] since its first row.

    So is one of milliseconds, microseconds or nanoseconds since 1970, and one of ticks of 100 ns.

    Dates are those of Arrow, or texts as ISO 8601 writes them; all have a zone, or none has. Texts
    may also be times of the day, dates such as 31.12.2026 23:59:59.5, or durations as `0.01 sec`.
    """
    if clock not in table.columns or not _may_have_dates(table.schema.field(clock).type):
        return table
    at, batches = table.columns.index(clock), table.batches
    if pa.types.is_float64(table.schema[at].type):
        return replace(table, batches=_numbers(table, at))
    first = next(batches, None)
    table = replace(table, batches=chain([first] if first else [], batches))
    read = _reader(first.column(at)) if first and first.num_rows else None
    if read is None:
        unit = _epoch_unit(first.column(at)) if first and first.num_rows else None
        return _since_epoch(table, at, unit) if unit else table
    schema = table.schema.set(at, number(clock, "s"))
    return replace(table, schema=schema, batches=_rows(table, schema, at, read))


def _may_have_dates(kind: pa.DataType) -> bool:
    dates = pa.types.is_timestamp(kind) or pa.types.is_string(kind)
    return bool(dates or pa.types.is_integer(kind) or pa.types.is_floating(kind))


def _epoch_unit(column: pa.Array) -> float | None:
    """The unit [s] of a time that is not in seconds, by the date that its first value would be."""
    try:
        first = float(column[0].as_py())
    except (TypeError, ValueError):
        return None
    found = [unit for unit in (1e-3, 1e-6, NANOSECOND) if EPOCH[0] < unit * first < EPOCH[1]]
    found += [TICK for start in BEFORE if EPOCH[0] < TICK * first - start < EPOCH[1]]
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


Reader = Callable[[pa.Array], Numbers | None]  # whole nanoseconds; None if one is no date


def _reader(column: pa.Array) -> Reader | None:
    """What reads dates like the first one; None if it is no date."""
    if pa.types.is_timestamp(column.type):
        return partial(_cast, kind=pa.timestamp("ns", column.type.tz))
    text = str(column[0]).strip()
    if found := DATE.match(text):
        return partial(_cast, kind=pa.timestamp("ns", "UTC" if found["zone"] else None))
    form = next((form for form in FORMS if form.fullmatch(text)), None)
    return _Texts(form) if form else None


def _rows(table: Table, schema: pa.Schema, at: int, read: Reader) -> Iterator[pa.RecordBatch]:
    start, row = None, 0
    for batch in table.batches:
        dates = batch.column(at)
        times = read(dates)
        if times is None:
            wrong = next(k for k in range(len(dates)) if read(dates[k : k + 1]) is None)
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


def _cast(dates: pa.Array, kind: pa.DataType) -> Numbers | None:
    """The dates in whole nanoseconds, whose differences are exact; None if one is no date."""
    try:
        times: Numbers = dates.cast(kind).cast(pa.int64()).to_numpy()
    except pa.ArrowInvalid:
        return None
    return times


@dataclass(frozen=True)
class _Texts:
    """Reads texts of this form, each in the same way."""

    form: re.Pattern[str]

    def __call__(self, texts: pa.Array) -> Numbers | None:
        found = [self.form.fullmatch((text or "").strip()) for text in texts.to_pylist()]
        parts = [match.groupdict() for match in found if match]
        if len(parts) < len(found):
            return None
        if "unit" in self.form.groupindex:
            return np.array([_duration(own) for own in parts], dtype=np.int64)
        return _cast(pa.array([_iso(own) for own in parts], pa.string()), pa.timestamp("ns"))


def _duration(parts: dict[str, str]) -> int:
    """Nanoseconds of a value with its unit."""
    unit = parts["unit"]
    return round(float(parts["value"]) * UNITS.get(unit.removesuffix("ec"), 1.0) / NANOSECOND)


def _iso(parts: dict[str, str]) -> str:
    """A date as ISO 8601 writes it; a time of the day is that of some day."""
    day = "-".join(parts[x].zfill(2) for x in "Ymd") if "Y" in parts else "2000-01-01"
    if days := parts.get("D"):
        day = str(np.datetime64(day) + int(days))
    fraction, hour = (parts["f"] or "0")[:9], int(parts.get("H") or 0)
    if half := parts.get("half"):
        hour = hour % 12 + 12 * (half in "pP")
    return f"{day}T{hour:02d}:{parts['M'].zfill(2)}:{parts['S']}.{fraction}"
