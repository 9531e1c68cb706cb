"""The clock of a sampled table: its nominal period, and whether it keeps to it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import chain

import numpy as np
import pyarrow as pa

from scarid_cli.arrays import Array, Numbers
from scarid_cli.errors import BadData, bad_data, bad_row
from scarid_cli.io.remedies import Remedy, read_on
from scarid_cli.io.table import SEGMENT, Instant, Table, concatenated, segments_of, steps_of
from scarid_cli.runs import SORT, remedy_back

# An interval may differ from the period by this fraction, and the mean interval by that one: a
# derivative would be wrong by as much.
JITTER = 0.01
DRIFT = 0.001
EPOCH = 1e8  # s: three years, as of a clock that counts from 1970
SHORTEST = 1e-12  # s; squares of the rate of such a clock leave the range of doubles


def clocked(table: Table, *, regular: bool, remedy: Remedy) -> Table:
    """The table, its clock checked to be at the rate of its first two samples.

    The period [s] is put into the metadata. The clock need not be `regular`; if it has to be, the
    `remedy` is told with what is refused.
    """
    batches = _from_two_samples(table.batches)
    first = next(batches, None)
    at = _first_step(first) if first else None
    if first is None or at is None:
        raise bad_data(
            table.name,
            "1 row" if first else "no rows",
            expected="at least 2 samples",
            remedy="give a longer log",
        )
    table = replace(table, batches=chain([first], batches))
    if not regular:
        return table
    period = _first_period(first, at, table)
    meta = replace(table.meta, period=period)
    return replace(table, meta=meta, batches=_regular(table, period, remedy))


def _first_period(first: pa.RecordBatch, at: int, table: Table) -> float:
    """The nominal period [s] of the interval after row `at`, counted from 0."""
    start, end = first.column("t")[at].as_py(), first.column("t")[at + 1].as_py()
    row = table.row(at + 2)
    if not end > start:
        raise _not_increasing(table.name, end, start, row)
    if end - start < SHORTEST:
        found = f"an interval of {end - start:g} s"
        raise bad_row(table.name, found, "a clock in seconds", row, "t")
    return nominal_period(end - start)


def nominal_period(interval: float) -> float:
    """The period [s] of a clock with this first interval; of a whole rate in Hz if it is close."""
    if not interval > 1e-300:  # the rate would be infinite
        return interval
    rate = round(1.0 / interval)
    if rate and abs(1.0 / interval / rate - 1.0) < 1e-4:
        return 1.0 / rate
    return float(f"{interval:.9g}")


def _from_two_samples(batches: Iterator[pa.RecordBatch]) -> Iterator[pa.RecordBatch]:
    """Hold the first batches back until two samples follow each other; drop empty batches."""
    held: list[pa.RecordBatch] = []
    for batch in batches:
        if not batch.num_rows:
            continue
        held = [concatenated([*held, batch])]
        if _first_step(held[0]) is not None:
            break
    yield from held
    yield from (batch for batch in batches if batch.num_rows)


def _first_step(batch: pa.RecordBatch) -> int | None:
    """The number of the first sample that no gap separates from the next."""
    together = np.flatnonzero(np.diff(segments_of(batch)) == 0)
    return int(together[0]) if len(together) else None


def _regular(table: Table, period: float, remedy: Remedy) -> Iterator[pa.RecordBatch]:
    """Pass batches on; time that does not advance, or not at the nominal rate, is an error.

    At a gap (see segments_of) time may advance by any interval.
    """
    row = gaps = 0
    start = missing = float("nan")
    last: Instant | None = None
    most: pa.RecordBatch | None = None
    for batch in table.batches:
        t = batch.column("t").to_numpy()
        first = last is None
        if first:
            start, missing = float(t[0]), 0.0
        steps, jumps, last = steps_of(batch, last)
        _check_segments(jumps, table, row + 1)
        after_gap = (jumps > 0) & (steps > 0.0)
        inner = np.where(after_gap, period, steps)[first:]
        if (at := _unlike(inner, period)) is not None:
            ahead = read_on(batch, table.batches)
            _check_order(ahead, table, row + 1)
            what = remedy(ahead)
            place = row + 1 + first + at
            raise _wrong_step(float(inner[at]), float(t[first + at]), table, period, place, what)
        missing += float(steps[after_gap].sum())
        gaps += int(after_gap.sum())
        row += batch.num_rows
        most = max(most or batch, batch, key=len)
        yield batch
    mean = (last[0] - start - missing) / (row - 1 - gaps) if last else period
    if most is not None and abs(mean - period) > DRIFT * period:
        raise BadData(
            f"{table.name}, column t: found a mean interval of {mean:.9g} s over {row} rows, "
            f"expected {period:.9g} s like the first; {remedy(most)}"
        )


def _check_order(rows: pa.RecordBatch, table: Table, row: int) -> None:
    """Rows that are out of order also make intervals that are too long, which come first."""
    t = rows.column("t").to_numpy()
    back = np.flatnonzero(np.diff(t) < 0.0)
    if len(back):
        at = int(back[0])
        times = float(t[at + 1]), float(t[at])
        raise _not_increasing(table.name, *times, table.row(row + at + 1), remedy_back(t))


def _check_segments(jumps: Numbers, table: Table, row: int) -> None:
    if np.any(jumps < 0):
        raise bad_data(
            table.name,
            "a smaller number than in the row before",
            expected="segments to be numbered in order",
            remedy="sort the log",
            row=table.row(row + int(np.argmax(jumps < 0))),
            column=SEGMENT,
        )


def _unlike(steps: Array, period: float) -> int | None:
    """The first interval [s] that is not the period, if there is one."""
    with np.errstate(invalid="ignore"):
        bad = ~(np.abs(steps - period) <= JITTER * period)
    return int(np.argmax(bad)) if bad.any() else None


def _wrong_step(
    step: float, t: float, table: Table, period: float, row: int, remedy: str
) -> BadData:
    """The error for an interval of `step` [s] before time t [s]; `row` is that of the table."""
    if step <= 0.0:
        return _not_increasing(table.name, t, t - step, table.row(row))
    return bad_data(
        table.name,
        f"an interval of {step:.6g} s",
        expected=f"{period:.6g} s within {JITTER:.0%}",
        remedy=remedy,
        row=table.row(row),
        column="t",
    )


def _not_increasing(name: str, time: float, before: float, row: int, remedy: str = SORT) -> BadData:
    if time == before:
        digits = "write it with at least 14 digits; " if time > EPOCH else ""
        remedy = (
            f"{digits}`scarid check` says whether rows are repeated, or the clock is too coarse"
        )
    return bad_data(
        name,
        f"{time} after {before:.12g}",
        expected="time to increase from row to row",
        remedy=remedy,
        row=row,
        column="t",
    )
