"""Held samples: rows with which a logger repeats the values of a slower sensor.

Only the first row of a run has values of its time; the others are old by up to a period of the
sensor, which interpolation between the first rows mends. A robot at rest repeats values as well.
A run is of held samples if the interval that is left without it is no gap, and if at least half of
the values change together in the row that ends it: encoders of a joint that moves off one after
another do not.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pyarrow as pa

from scarid_cli.arrays import Array, Marks, Numbers
from scarid_cli.io.schemas import numbered
from scarid_cli.io.table import Table, matrix, segments_of

TOGETHER = 0.5  # share of the values that change in the row that ends a run of held samples


def measured(table: Table) -> list[str]:
    """The columns that sensors fill; none if there is a single one, which proves nothing."""
    known = numbered(table.columns, "q", "tau")
    own = [name for name in table.columns if name.endswith("_measured")]
    columns = [n for n in (*known, *own) if pa.types.is_floating(table.schema.field(n).type)]
    return columns if len(columns) > 1 else []


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
        together = batch
        if self._waiting is not None:
            parts = pa.Table.from_batches([self._waiting, batch])
            together = parts.combine_chunks().to_batches()[0]
        t, *values = matrix(together, ["t", *self._columns])
        held, waiting = held_rows(t, np.array(values), segments_of(together), self._limit)
        self.count += int(held.sum())
        kept = ~held
        kept[0], kept[waiting + 1 :] = first, False
        if kept.all():
            yield together
        elif kept.any():
            yield together.take(pa.array(np.flatnonzero(kept)))
        self._waiting = together.slice(waiting)


def repeating(t: Array, values: Array, segments: Numbers) -> Marks:
    """Which rows repeat all values of the row before, at a later time (rows)."""
    changed = np.any(np.diff(values, axis=1) != 0.0, axis=0)
    same: Marks = (np.diff(t) > 0.0) & (np.diff(segments) == 0) & ~changed
    return np.concatenate(([False], same))


def held_rows(t: Array, values: Array, segments: Numbers, limit: float) -> tuple[Marks, int]:
    """Which rows are held samples, and the number of the row that the undecided rest repeats.

    Times (rows) [s], values (columns, rows). The rest has no end yet.
    """
    held = np.zeros(len(t), dtype=np.bool_)
    waiting = len(t) - 1
    edges = np.flatnonzero(np.diff(repeating(t, values, segments), append=False))
    for before, last in edges.reshape(-1, 2).tolist():  # the row before a run, and its last row
        if last == len(t) - 1:
            waiting = before if t[last] - t[before] <= limit else last
        elif t[last + 1] - t[before] <= limit and segments[last] == segments[last + 1]:
            changed = np.mean(values[:, last + 1] != values[:, last])
            held[before + 1 : last + 1] = changed >= TOGETHER
    return held, waiting
