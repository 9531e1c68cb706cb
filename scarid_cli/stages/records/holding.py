"""Held samples of a log are left out as its rows arrive; see algorithms/processes/holding.py."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.processes.filling import SEARCH
from scarid_cli.algorithms.processes.holding import FIRST, held_rows, repeating
from scarid_cli.arrays import Array
from scarid_cli.io.schemas import numbered
from scarid_cli.io.table import concatenated, matrix, segments_of


def measured(schema: pa.Schema) -> list[str]:
    """The columns that sensors fill; none if there is a single one, which proves nothing."""
    known = numbered(schema.names, "q", "tau")
    own = [name for name in schema.names if name.endswith("_measured")]
    columns = [n for n in (*known, *own) if pa.types.is_floating(schema.field(n).type)]
    return columns if len(columns) > 1 else []


class FirstIntervals:
    """The first positive intervals [s]: `every` one, and those between rows with `new` values.

    They are known when there are enough of both, or after so many rows of a robot at rest that the
    rest of its log is not waited for.
    """

    def __init__(self, columns: list[str]) -> None:
        self.every, self.new = np.empty(0), np.empty(0)
        self._columns = columns
        self._rows = 0
        self._last: pa.RecordBatch | None = None  # row
        self._changed = np.empty(0)  # the time of the last row with new values [s]

    @property
    def known(self) -> bool:
        return len(self.new) >= FIRST or self._rows >= SEARCH

    def add(self, batch: pa.RecordBatch) -> None:
        """More rows, of which those beyond the limit do not count, however they are divided."""
        batch = batch.slice(0, SEARCH - self._rows)
        if not batch.num_rows:
            return
        rows = concatenated([batch] if self._last is None else [self._last, batch])
        t, *values = matrix(rows, ["t", *self._columns])
        fresh = t
        if self._columns:
            fresh = t[~repeating(t, np.array(values), segments_of(rows))]
        if self._last is not None:
            fresh = np.concatenate((self._changed, fresh[1:]))
        self.every = _extended(self.every, t)
        self.new = _extended(self.new, fresh)
        self._rows += batch.num_rows
        self._last, self._changed = rows.slice(rows.num_rows - 1), fresh[-1:]


def _extended(intervals: Array, t: Array) -> Array:
    """The first positive intervals [s], with those between times t [s] behind them."""
    steps = np.diff(t)
    return np.concatenate((intervals, steps[steps > 0.0]))[:FIRST]


class Holding:
    """Leaves out held samples; `count` of them so far. `limit` is the longest interval [s]."""

    def __init__(self, columns: list[str], limit: float) -> None:
        self.count = 0
        self._columns = columns
        self._limit = limit
        self._waiting: pa.RecordBatch | None = None  # the last row that counts, and what repeats it

    def rows(self, batches: Iterator[pa.RecordBatch]) -> Iterator[pa.RecordBatch]:
        """The batches without held samples; a run that has not ended waits for its end."""
        if not self._columns:
            yield from batches
            return
        for batch in batches:
            if batch.num_rows:
                yield from self._passed(batch)
        rest = self._waiting.slice(1) if self._waiting is not None else None
        if rest and self.count:  # of a log with held samples
            self.count += rest.num_rows
        elif rest:
            yield rest

    def _passed(self, batch: pa.RecordBatch) -> Iterator[pa.RecordBatch]:
        first = self._waiting is None
        rows = concatenated([batch] if self._waiting is None else [self._waiting, batch])
        t, *values = matrix(rows, ["t", *self._columns])
        held, waiting = held_rows(t, np.array(values), segments_of(rows), self._limit)
        self.count += int(held.sum())
        kept = ~held
        kept[0], kept[waiting + 1 :] = first, False
        if kept.all():
            yield rows
        elif kept.any():
            yield rows.take(pa.array(np.flatnonzero(kept)))
        self._waiting = rows.slice(waiting)
