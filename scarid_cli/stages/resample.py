"""Put a log with a jittered clock on a regular one, and split it at its gaps."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import chain, pairwise

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.resampling import Clock, Resampler, State
from scarid_cli.arrays import Array, Numbers
from scarid_cli.errors import bad_data
from scarid_cli.io.table import SEGMENT, Table, doubles, integers, matrix, segments_of

SLOWER = 1.05  # times the log's own period: the rate is lowered
FIRST = 33  # rows, whose intervals tell the rate of the log
BRIDGED = 5.0  # periods of the log: a longer interval is a gap, unless it is within a new period


def resample(
    table: Table,
    rate: float,
    max_gap: float | None = None,
    told: Callable[[Clock], None] = lambda _: None,
) -> Table:
    """The table at a constant rate [Hz]; `told` hears of the clock once all rows have gone by.

    Numbers are interpolated, or averaged over a new period if that is longer than the log's own;
    other columns have the value of the row before. An interval longer than `max_gap` [s] (by
    default BRIDGED) is not bridged: after it the column `segment` is one higher.
    """
    fields = [field for field in table.schema if field.name != SEGMENT]
    schema = pa.schema([*fields, pa.field(SEGMENT, pa.int64())])
    meta = replace(table.meta, period=1.0 / rate)
    batches = _rows(table, schema, 1.0 / rate, max_gap, told)
    return replace(table, schema=schema, meta=meta, batches=batches)


def _begun(batches: Iterator[pa.RecordBatch]) -> tuple[float, Iterator[pa.RecordBatch]]:
    """The median of the first intervals [s], and all batches."""
    held: list[pa.RecordBatch] = []
    for batch in batches:
        held.append(batch)
        if sum(b.num_rows for b in held) >= FIRST:
            break
    t = np.concatenate([matrix(batch, ["t"])[0] for batch in held])[:FIRST]
    return float(np.median(np.diff(t))), chain(held, batches)


def _rows(
    table: Table,
    schema: pa.Schema,
    period: float,
    max_gap: float | None,
    told: Callable[[Clock], None],
) -> Iterator[pa.RecordBatch]:
    own, batches = _begun(table.batches)
    splitting = Splitting(table.name, max_gap or max(BRIDGED * own, period))
    numbers = [f.name for f in schema if pa.types.is_floating(f.type) and f.name != "t"]
    laying = Laying(Resampler(period, smooth=period > SLOWER * own), schema, numbers)
    for batch in batches:
        for begins, piece in splitting.pieces(batch):
            found = laying.rows(piece, splitting.segment, begins=begins)
            if found:
                yield found
    told(splitting.clock)


class Splitting:
    """Batches in pieces: without repeated rows, and cut at gaps longer than `limit` [s]."""

    def __init__(self, name: str, limit: float) -> None:
        self._name = name
        self._limit = limit
        self._row = 0
        self._last: tuple[float, int] | None = None  # time and segment of the row before
        self.segment = -1
        self.clock = Clock()

    def pieces(self, batch: pa.RecordBatch) -> Iterator[tuple[bool, pa.RecordBatch]]:
        """Each with whether it begins a segment."""
        t = matrix(batch, ["t"])[0]
        marks = segments_of(batch)
        time, mark = self._last or (-np.inf, int(marks[0]))
        steps = np.diff(t, prepend=time)
        self._check(steps)
        begins = (steps > self._limit) | (np.diff(marks, prepend=mark) != 0)
        for start, end in pairwise(sorted({0, *np.flatnonzero(begins).tolist(), len(t)})):
            first = bool(begins[start])
            if first:
                self._begin(float(steps[start]))
            self.clock = self.clock.after(steps[start + first : end])
            kept = start + np.flatnonzero((steps > 0.0)[start:end] | begins[start:end])
            if len(kept) == end - start:
                yield first, batch.slice(start, end - start)
            elif len(kept):
                yield first, batch.take(pa.array(kept))  # imports pyarrow.compute, 40 ms
        self._row += len(t)
        self._last = (float(t[-1]), int(marks[-1]))

    def _begin(self, gap: float) -> None:
        self.segment += 1
        if self.segment:
            self.clock = self.clock.after_gap(gap)

    def _check(self, steps: Array) -> None:
        if np.any(steps < 0.0):
            at = int(np.argmax(steps < 0.0))
            raise bad_data(
                self._name,
                f"time that goes back by {-steps[at]:.6g} s",
                expected="time to increase from row to row",
                remedy="sort the log",
                row=self._row + at + 1,
                column="t",
            )


@dataclass
class Laying:
    """The new rows of a segment, and its last samples with all their columns."""

    resampler: Resampler
    schema: pa.Schema
    numbers: list[str]
    state: State | None = None
    held: pa.RecordBatch | None = None

    def rows(self, piece: pa.RecordBatch, segment: int, *, begins: bool) -> pa.RecordBatch | None:
        """What the samples of this piece settle."""
        t, *values = matrix(piece, ["t", *self.numbers])
        x = np.array(values).reshape(len(self.numbers), len(t))
        if begins:
            self.state = self._at(float(t[0]), x[:, 0])
            self.held = piece.slice(0, 1)
            piece, t, x = piece.slice(1), t[1:], x[:, 1:]
        assert self.state
        together = pa.Table.from_batches([self.held, piece]).combine_chunks().to_batches()[0]
        times = np.concatenate((self.state.t, t))
        self.state, at, found = self.resampler.step(self.state, t, x)
        self.held = together.slice(len(times) - len(self.state.t))
        if not len(at):
            return None
        left = np.maximum(np.searchsorted(times, at + 1e-12, side="right") - 1, 0)
        new = {"t": at, **dict(zip(self.numbers, found, strict=True))}
        return self._joined(together, new, left, segment)

    def _at(self, t: float, x: Array) -> State:
        if self.state is None:
            return self.resampler.init(t, x)
        return self.resampler.after_gap(self.state, t, x)

    def _joined(
        self, source: pa.RecordBatch, new: dict[str, Array], left: Numbers, segment: int
    ) -> pa.RecordBatch:
        columns = []
        for name in self.schema.names:
            if name == SEGMENT:
                columns.append(integers(np.full(len(left), segment)))
            elif name in new:
                columns.append(doubles(new[name]))
            else:
                columns.append(source.column(name).take(pa.array(left)))
        return pa.RecordBatch.from_arrays(columns, schema=self.schema)
