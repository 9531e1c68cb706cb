"""Resample a log with a jittered clock at a constant rate, and split it at its gaps."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import chain, pairwise
from typing import Any

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.processes.coarse import Ticks
from scarid_cli.algorithms.processes.holding import MAX_GAP, sensor_period
from scarid_cli.algorithms.processes.resampling import (
    Clock,
    Decimator,
    DecimatorState,
    Resampler,
    ResamplerState,
)
from scarid_cli.arrays import Array, Numbers
from scarid_cli.errors import UsageFault, bad_data
from scarid_cli.io.facts import ORDER
from scarid_cli.io.table import (
    SEGMENT,
    Instant,
    Table,
    concatenated,
    integers,
    matrix,
    segments_of,
    steps_of,
    with_columns,
)
from scarid_cli.runs import remedy_back
from scarid_cli.stages.records.holding import FirstIntervals, Holding, measured
from scarid_cli.stages.records.slower import Filling, slower_groups
from scarid_cli.stages.records.splitting import Splitting

MOST = 1 << 18  # new rows that are made at once, and that lie between two of the log
SLOWEST_RATE = 100_000  # times slower than the log at most
SLOWER = 0.05  # fraction of the log's period by which the new period must be longer to low-pass


def resample(
    table: Table,
    rate: float,
    max_gap: float | None = None,
    report: Callable[[Clock], None] = lambda _: None,
) -> Table:
    """The table at a constant rate [Hz]; `report` is called with the old clock after the last row.

    Numbers are interpolated linearly, and low-passed if the new period is longer than that of the
    log; other columns keep the value of the previous row. An interval longer than `max_gap` [s]
    (by default MAX_GAP periods) is a gap, after which the column `segment` is one higher. Held
    samples of a slower sensor are left out first (algorithms/processes/holding.py), and those of
    one group of signals only are interpolated (algorithms/processes/filling.py).
    """
    fields = [field for field in table.schema if field.name != SEGMENT]
    schema = pa.schema([*fields, pa.field(SEGMENT, pa.int64())])
    meta = replace(table.meta.without(ORDER), period=1.0 / rate)
    table = replace(table, batches=_ordered(table))
    batches = _rows(table, schema, 1.0 / rate, max_gap, report)
    return replace(table, schema=schema, meta=meta, batches=batches)


def _with_period(table: Table) -> tuple[float, Iterator[pa.RecordBatch]]:
    """The median of the first intervals between new values [s], and all batches."""
    held: list[pa.RecordBatch] = []
    first = FirstIntervals(measured(table.schema))
    for batch in table.batches:
        held.append(batch)
        first.add(batch)
        if first.known:
            break
    if not len(first.every):
        raise bad_data(
            table.name,
            "a time that never increases",
            expected="an increasing time",
            remedy="give a log with a clock",
            column="t",
        )
    return sensor_period(first.every, first.new), chain(held, table.batches)


def _ordered(table: Table) -> Iterator[pa.RecordBatch]:
    """The batches; time that goes back, or that many rows share, is an error."""
    row = 0
    last: Instant | None = None
    ticks, names = Ticks(), measured(table.schema)
    for batch in table.batches:
        if batch.num_rows:
            steps, _, last = steps_of(batch, last)
            _check(steps, batch, table, row)
            ticks.after(matrix(batch, ["t"])[0], matrix(batch, names))
        row += batch.num_rows
        yield batch
    if ticks.coarse:
        raise bad_data(
            table.name,
            f"{ticks.unlike:,} of {ticks.rows:,} rows with the time of the row before, and other "
            "values",
            expected="a clock finer than the rows",
            remedy=f"count the rows instead, with their real rate: {ticks.counting}",
            column="t",
        )


def _check(steps: Array, batch: pa.RecordBatch, table: Table, row: int) -> None:
    if np.any(steps < 0.0):
        at = int(np.argmax(steps < 0.0))
        raise bad_data(
            table.name,
            f"time that goes back by {-steps[at]:.6g} s",
            expected="time to increase from row to row",
            remedy=remedy_back(matrix(batch, ["t"])[0]),
            row=table.row(row + at + 1),
            column="t",
        )


def _rows(
    table: Table,
    schema: pa.Schema,
    period: float,
    max_gap: float | None,
    report: Callable[[Clock], None],
) -> Iterator[pa.RecordBatch]:
    slower, table = slower_groups(table)
    own, batches = _with_period(table)
    limit = max_gap or max(MAX_GAP * own, period)
    splitting, holding = Splitting(limit), Holding(measured(table.schema), limit)
    fillings = [Filling(group, max(limit, MAX_GAP * group.interval)) for group in slower]
    factor = _slower_by(period, own)
    numbers = [f.name for f in schema if pa.types.is_floating(f.type) and f.name != "t"]
    interpolation = Interpolation(Resampler(period / factor), schema, numbers)
    decimation = Decimation(Decimator(factor), schema, numbers, period) if factor > 1 else None
    rows = holding.rows(batches)
    for filling in fillings:
        rows = filling.rows(rows)
    for batch in rows:
        for begins, piece in splitting.pieces(batch):
            if begins and decimation:
                yield from decimation.finish()
            for part in _moderate(piece, period / factor, table.name):
                found = interpolation.rows(part, splitting.segment, begins=begins)
                begins = False
                if found and decimation:
                    found = decimation.rows(found, interpolation.first, interpolation.start)
                if found:
                    yield found
    if decimation:
        yield from decimation.finish()
    filled = tuple((f.slower.name, f.slower.interval, f.count) for f in fillings if f.count)
    report(replace(splitting.clock, held=holding.count, filled=filled))


def _slower_by(period: float, own: float) -> int:
    """How many rows are interpolated for each new one, given the new and the log's period [s]."""
    factor = max(1, int(np.ceil(period / own - SLOWER)))
    if factor > SLOWEST_RATE:
        raise UsageFault(
            f"--rate {1.0 / period:g}: {factor:,} times slower than the log of {1.0 / own:.6g} Hz; "
            f"give at most {SLOWEST_RATE:,} times"
        )
    return factor


def _moderate(piece: pa.RecordBatch, period: float, name: str) -> Iterator[pa.RecordBatch]:
    """The piece in parts, each of which gives at most MOST new rows every `period` [s] or so."""
    t = matrix(piece, ["t"])[0]
    if np.max(np.diff(t), initial=0.0) > MOST * period:
        raise bad_data(
            name,
            f"an interval of {np.max(np.diff(t)):.6g} s",
            expected=f"at most {MOST:,} new rows within one",
            remedy="give a lower --rate, or a shorter --max-gap; is the time in seconds?",
            column="t",
        )
    numbers = np.floor((t - t[0]) / (MOST * period))
    for start, end in pairwise([0, *(np.flatnonzero(np.diff(numbers)) + 1).tolist(), len(t)]):
        yield piece.slice(start, end - start)


@dataclass
class Interpolation:
    """Interpolates the new rows of a segment.

    `held` are the last samples of the segment with all columns; `first` is the number of the first
    row of those that were returned last.
    """

    resampler: Resampler
    schema: pa.Schema
    numbers: list[str]
    state: ResamplerState | None = None
    held: pa.RecordBatch | None = None
    first: int = 0

    @property
    def start(self) -> float:
        """The time of row 0 [s]."""
        return self.state.start if self.state else 0.0

    def rows(self, piece: pa.RecordBatch, segment: int, *, begins: bool) -> pa.RecordBatch | None:
        """The new rows up to the last sample of this piece, if there are any."""
        t, *values = matrix(piece, ["t", *self.numbers])
        x = np.array(values).reshape(len(self.numbers), len(t))
        if begins:
            self.state = self.resampler.init(float(t[0]), x[:, 0], self.state)
            self.held = piece.slice(0, 1)
            piece, t, x = piece.slice(1), t[1:], x[:, 1:]
        assert self.state
        rows = concatenated([self.held, piece])
        times = np.concatenate((self.state.t, t))
        self.state, at, found = self.resampler.step(self.state, t, x)
        self.held = rows.slice(len(times) - len(self.state.t))
        if not len(at):
            return None
        self.first = self.state.row - len(at)
        left = np.maximum(np.searchsorted(times, at + 1e-12, side="right") - 1, 0)
        mark = integers(np.full(len(at), segment))
        new = {"t": at, SEGMENT: mark, **dict(zip(self.numbers, found, strict=True))}
        return _batch(rows, self.schema, new, left)


@dataclass
class Decimation:
    """Low-passes rows and keeps every `factor`-th; `held` are the waiting rows with all columns."""

    decimator: Decimator
    schema: pa.Schema
    numbers: list[str]
    period: float
    state: DecimatorState | None = None
    held: pa.RecordBatch | None = None
    at: int = 0  # number of the first row held
    start: float = 0.0  # time of row 0

    def rows(self, batch: pa.RecordBatch, first: int, start: float) -> pa.RecordBatch | None:
        """The rows that this batch completes, if any.

        `first` is the number of the batch's first row, `start` the time of row 0 [s].
        """
        x = matrix(batch, self.numbers)
        if self.state is None:
            self.state = self.decimator.init(first, len(self.numbers))
            self.held, self.at = batch.slice(0, 0), first
            self.start = start
        self.held = concatenated([self.held, batch])
        self.state, numbers, found = self.decimator.step(self.state, x)
        return self._joined(numbers, found)

    def finish(self) -> Iterator[pa.RecordBatch]:
        """The remaining rows at the end of a segment."""
        if self.state:
            numbers, found = self.decimator.finish(self.state)
            joined = self._joined(numbers, found)
            if joined:
                yield joined
        self.state = None

    def _joined(self, numbers: Numbers, found: Array) -> pa.RecordBatch | None:
        if not len(numbers):
            return None
        assert self.held
        places = numbers * self.decimator.factor - self.at
        t = self.start + numbers * self.period
        mark = integers(segments_of(self.held)[places])
        new = {"t": t, SEGMENT: mark, **dict(zip(self.numbers, found, strict=True))}
        made = _batch(self.held, self.schema, new, places)
        done = int(places[-1]) + 1
        self.held, self.at = self.held.slice(done), self.at + done
        return made


def _batch(
    source: pa.RecordBatch, schema: pa.Schema, new: dict[str, Any], places: Numbers
) -> pa.RecordBatch:
    """A batch of the new columns, with the other columns taken from these rows of the source."""
    others = {
        name: source.column(name).take(pa.array(places)) for name in schema.names if name not in new
    }
    return with_columns(source, schema, {**others, **new})
