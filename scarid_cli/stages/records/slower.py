"""Sensors that are slower than the logger, whose readings are interpolated row by row."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.processes.filling import READINGS, SEARCH, Readings, reading_interval
from scarid_cli.algorithms.processes.holding import repeating
from scarid_cli.arrays import Array, Marks, Numbers
from scarid_cli.io.schemas import numbered
from scarid_cli.io.table import Table, concatenated, matrix, segments_of, with_columns


@dataclass(frozen=True)
class Slower:
    """A group of columns whose readings are `interval` [s] apart, more than the rows are."""

    name: str
    columns: list[str]
    interval: float


def groups(table: Table) -> dict[str, list[str]]:
    """The columns of positions and of torques."""
    return {"positions": numbered(table.columns, "q"), "torques": numbered(table.columns, "tau")}


def slower_groups(table: Table) -> tuple[list[Slower], Table]:
    """The groups with slower sensors, judged by the first rows, and the table as it was."""
    candidates = [Candidate(name, x) for name, x in groups(table).items() if len(x) > 1]
    read: list[pa.RecordBatch] = []
    for batch in table.batches if candidates else ():
        read.append(batch)
        for candidate in candidates:
            candidate.add(batch)
        if all(candidate.decided for candidate in candidates):
            break
    found = [slower for candidate in candidates if (slower := candidate.found())]
    return found, replace(table, batches=chain(read, table.batches))


class Candidate:
    """A group of signals, and its first rows."""

    def __init__(self, name: str, columns: list[str]) -> None:
        self._name, self._columns = name, columns
        self._parts: list[Array] = []  # (time and values, rows)
        self._last = np.empty((len(columns), 0))
        self._rows, self._readings = 0, 0

    @property
    def decided(self) -> bool:
        return self._rows >= SEARCH or self._readings > READINGS

    def add(self, batch: pa.RecordBatch) -> None:
        """More rows, until there are enough readings."""
        if self.decided or not batch.num_rows:
            return
        new = np.array(matrix(batch, ["t", *self._columns]))
        together = np.concatenate((self._last, new[1:]), axis=1)
        self._readings += int(np.count_nonzero(np.any(np.diff(together, axis=1) != 0.0, axis=0)))
        self._rows += new.shape[1]
        self._last = new[1:, -1:]
        self._parts.append(new)

    def found(self) -> Slower | None:
        """The group, if its sensor is slower than the rows."""
        if not self._parts:
            return None
        t, *values = np.concatenate(self._parts, axis=1)
        interval = reading_interval(t, np.array(values))
        return Slower(self._name, self._columns, interval) if interval else None


class Filling:
    """Interpolates a slower group at the rows that repeat its last reading; `count` of them so far.

    Where the next reading is more than `limit` [s] away, or beyond a gap, values stay as they are.
    """

    def __init__(self, slower: Slower, limit: float) -> None:
        self.count = 0
        self.slower = slower
        self._limit = limit
        self._waiting: pa.RecordBatch | None = None
        self._fresh: Marks = np.empty(0, dtype=np.bool_)  # which waiting rows are readings
        self._passed = 0  # waiting rows that were passed on

    def rows(self, batches: Iterator[pa.RecordBatch]) -> Iterator[pa.RecordBatch]:
        """The batches; rows wait for the two readings that follow them."""
        for batch in batches:
            if batch.num_rows:
                yield from self._ready(batch, ended=False)
        if self._waiting is not None:
            yield from self._ready(self._waiting.slice(0, 0), ended=True)

    def _ready(self, batch: pa.RecordBatch, *, ended: bool) -> Iterator[pa.RecordBatch]:
        rows = concatenated([batch] if self._waiting is None else [self._waiting, batch])
        t, *columns = matrix(rows, ["t", *self.slower.columns])
        values, segments = np.array(columns), segments_of(rows)
        later = np.diff(t, prepend=-np.inf) > 0.0
        fresh = fresh_rows(values, t, segments, later)
        fresh[: len(self._fresh)] = self._fresh
        readings = Readings.of(t, fresh, segments, self._limit)
        readings = replace(readings, ended=readings.ended or ended)
        filled, changed = readings.filled(values)
        done, kept = readings.decided(), min(readings.needed(), int(np.flatnonzero(later)[-1]))
        self.count += int(np.count_nonzero(changed[self._passed :]))
        if done > self._passed:
            new = dict(zip(self.slower.columns, filled, strict=True))
            yield with_columns(rows, rows.schema, new).slice(self._passed, done - self._passed)
        self._waiting, self._fresh = rows.slice(kept), fresh[kept:]
        self._passed = done - kept


def fresh_rows(values: Array, t: Array, segments: Numbers, later: Marks) -> Marks:
    """The rows of values (signals, rows) that are readings, at times t (rows) [s].

    Only rows `later` than the row before count: no polynomial goes through two values at one time.
    """
    fresh = np.zeros(len(t), dtype=np.bool_)
    fresh[later] = ~repeating(t[later], values[:, later], segments[later])
    return fresh
