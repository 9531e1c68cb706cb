"""Which rows of a log a command reads: a window, and what becomes of rows with missing values."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Protocol

import numpy as np
import pyarrow as pa

from scarid_cli.arrays import Array, Marks
from scarid_cli.errors import BadData, UsageFault
from scarid_cli.io.table import SEGMENT, Table, integers, matrix, segments_of, with_columns

REFUSE, DROP, SPLIT, FILL = "refuse", "drop", "split", "fill"


@dataclass(frozen=True)
class Selection:
    """A window of a log: the times from `start` to before `end` [s], the rows `first` to `last`.

    The rows are counted from 1, and the last one belongs to the window. The window begins at the
    first row that is in it and ends before the first one that is past it. `missing` says what
    becomes of rows without a value: they are refused, dropped, begin a new segment, or are filled.
    """

    start: float | None = None
    end: float | None = None
    first: int = 1
    last: int | None = None
    missing: str = REFUSE

    @property
    def timed(self) -> bool:
        """Whether the time bounds the window."""
        return self.start is not None or self.end is not None

    @property
    def bounded(self) -> bool:
        """Whether this is less than the whole log."""
        return self.timed or self.first > 1 or self.last is not None


class Numbering:
    """The numbers that the rows of a table have in the log, of which other rows are left out.

    `before` gives the numbers in the log of the table that the rows are left out of.
    """

    def __init__(self, before: Callable[[int], int]) -> None:
        self._before = before
        self._kept = [0]  # how many rows are kept before each place where some are left out
        self._left = [0]  # and how many are left out up to there

    def leave_out(self, kept: int, rows: int) -> None:
        """Note that so many rows are left out after the first `kept` ones."""
        self._kept.append(kept)
        self._left.append(self._left[-1] + rows)

    def __call__(self, row: int) -> int:
        """The number in the log of a row, both counted from 1."""
        return self._before(row + self._left[bisect_right(self._kept, row - 1) - 1])


def within(table: Table, selection: Selection) -> Table:
    """The rows of a table that lie in the window; those after it are not read."""
    if not selection.bounded:
        return table
    if selection.timed and "t" not in table.columns:
        raise UsageFault(
            f"{table.name}: there is no time t for --from-time and --to-time; give --rows instead"
        )
    numbering = Numbering(table.row)
    return replace(table, batches=_within(table, selection, numbering), row=numbering)


def _within(table: Table, selection: Selection, numbering: Numbering) -> Iterator[pa.RecordBatch]:
    read = kept = 0
    times: list[float] = []
    for batch in table.batches:
        t = matrix(batch, ["t"])[0] if selection.timed else np.zeros(batch.num_rows)
        times = [*times[:1], *t[[0, -1]].tolist()] if batch.num_rows else times
        start, end = _bounds(t, selection, read, begun=kept > 0)
        if end > start:
            if not kept:
                numbering.leave_out(0, read + start)
            kept += end - start
            yield batch.slice(start, end - start)
        read += batch.num_rows
        if end < batch.num_rows:
            break
    if not kept:
        span = f" with times from {times[0]:g} to {times[-1]:g} s" if selection.timed else ""
        raise BadData(
            f"{table.name}: none of the {read:,} rows read{span} is in the window; give other "
            "--from-time, --to-time or --rows"
        )


def _bounds(t: Array, selection: Selection, read: int, *, begun: bool) -> tuple[int, int]:
    """The first row of a batch in the window, and the row after the last one; `read` before it."""
    rows = len(t)
    numbers = np.arange(read + 1, read + rows + 1)
    inside, past = numbers >= selection.first, np.zeros(rows, dtype=np.bool_)
    if selection.start is not None:
        inside &= t >= selection.start
    if selection.end is not None:
        past |= t >= selection.end
    if selection.last is not None:
        past |= numbers > selection.last
    end = int(np.argmax(past)) if past.any() else rows
    if begun:
        return 0, end
    return (int(np.argmax(inside)) if inside.any() else rows), end


class Whole(Protocol):
    """Makes a table whose rows lack nothing in some columns; `count` rows are left out."""

    count: int

    @property
    def text(self) -> str:
        """What was done, in words."""

    def removed(self, table: Table) -> Table:
        """The table without the rows that are left out."""


@dataclass
class Lacking:
    """Leaves out the rows that lack a value in some `columns`; `count` of them so far.

    With `split`, the rows after them begin a new segment.
    """

    columns: list[str]
    split: bool
    count: int = 0

    @property
    def text(self) -> str:
        """What was done, in words."""
        what = f"{self.count:,} row{'s' if self.count > 1 else ''}"
        return f"left out {what} with missing values"

    def removed(self, table: Table) -> Table:
        """The table without these rows."""
        schema = table.schema
        if self.split and SEGMENT not in table.columns:
            schema = schema.append(pa.field(SEGMENT, pa.int64()))
        numbering = Numbering(table.row)
        batches = self._rows(table, schema, numbering)
        return replace(table, schema=schema, batches=batches, row=numbering)

    def _rows(
        self, table: Table, schema: pa.Schema, numbering: Numbering
    ) -> Iterator[pa.RecordBatch]:
        kept = splits = 0
        after_gap = False
        for batch in table.batches:
            lacking = _lacking(batch, self.columns)
            edges = [0, *(np.flatnonzero(np.diff(lacking)) + 1).tolist(), batch.num_rows]
            for start, end in pairwise(edges):
                if end > start and lacking[start]:
                    numbering.leave_out(kept, end - start)
                    self.count += end - start
                    after_gap = True
                elif end > start:
                    splits += after_gap and kept > 0
                    after_gap, kept = False, kept + end - start
                    yield self._piece(batch.slice(start, end - start), schema, splits)
        if not kept:
            raise BadData(
                f"{table.name}: each of its {self.count:,} rows lacks a value in one of the "
                f"columns {', '.join(self.columns)}; `scarid info` tells in which"
            )

    def _piece(self, batch: pa.RecordBatch, schema: pa.Schema, splits: int) -> pa.RecordBatch:
        if not self.split:
            return batch
        return with_columns(batch, schema, {SEGMENT: integers(segments_of(batch) + splits)})


def _lacking(batch: pa.RecordBatch, columns: list[str]) -> Marks:
    """Which rows lack a value in one of these columns, or have one that is not finite (rows)."""
    lacking = np.zeros(batch.num_rows, dtype=np.bool_)
    for name in columns:
        column = batch.column(name)
        if pa.types.is_floating(column.type):
            lacking |= ~np.isfinite(column.to_numpy(zero_copy_only=False))
        elif column.null_count:
            lacking |= column.is_null().to_numpy(zero_copy_only=False)
    return lacking
