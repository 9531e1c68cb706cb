"""Run processes over columns of a table; each row is output as soon as its columns are complete."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from math import inf
from typing import Any

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.processes.process import Process
from scarid_cli.arrays import Array
from scarid_cli.errors import TooShort, bad_data
from scarid_cli.io.table import SEGMENT, Table, integers, matrix, segments, with_columns


@dataclass(frozen=True)
class Task:
    """A process, the column it reads, and the columns it writes."""

    source: str
    process: Process
    outputs: tuple[str, ...]


@dataclass
class Running:
    """A task with its state, and the parts of its outputs that still wait for other tasks."""

    task: Task
    state: Any = None
    parts: list[tuple[Array, ...]] = field(default_factory=list)

    def step(self, x: Array, period: float) -> None:
        if self.state is None:
            self.state = self.task.process.init(float(x[0]), period)
        self.state, outputs = self.task.process.step(self.state, x)
        self.parts.append(outputs)

    def finish(self) -> None:
        self.parts.append(self.task.process.finish(self.state))

    @property
    def rows(self) -> int:
        return sum(len(part[0]) for part in self.parts if part)

    def take(self, rows: int) -> dict[str, Array]:
        """Remove and return the first rows of each output."""
        parts = [part for part in self.parts if part]
        if len(parts) == 1 and len(parts[0][0]) == rows:  # as where nothing waits
            self.parts = []
            return dict(zip(self.task.outputs, parts[0], strict=True))
        columns = [np.concatenate(pieces) for pieces in zip(*parts, strict=True)]
        self.parts = [tuple(column[rows:] for column in columns)]
        heads = (column[:rows] for column in columns)
        return dict(zip(self.task.outputs, heads, strict=True))


@dataclass(frozen=True)
class Edges:
    """How many rows at the start and at the end of a record are marked as not settled."""

    start: int = 0
    end: int = 0

    def marks(self, first: int, rows: int, total: float) -> pa.Array:
        """The column `settled` of these rows, of a record that has `total` rows."""
        at = np.arange(first, first + rows)
        return integers((at >= self.start) & (at < total - self.end))


@dataclass(frozen=True)
class Plan:
    """The tasks for a record, and the settling rows at its ends."""

    tasks: list[Task]
    edges: Edges = field(default_factory=Edges)

    def lag(self, period: float) -> float:
        """The lag of the slowest output in rows; inf if it needs the whole record."""
        return max((task.process.lag(period) for task in self.tasks), default=0)

    def check(self, period: float) -> None:
        """Refuse impossible settings before anything is written."""
        for task in self.tasks:
            task.process.init(0.0, period)


def processed(
    table: Table,
    schema: pa.Schema,
    planned: Callable[[Table], tuple[Table, Plan]],
    left_out: list[TooShort] | None = None,
) -> Table:
    """The table with the columns that the tasks write, and `settled` if the schema has it.

    A row keeps its time: a process that looks ahead delays all other columns as well. Each segment
    between gaps is a record of its own, with its own plan. A segment that is too short for its plan
    is left out, and `left_out` receives the reason.
    """
    batches = _segments(table, schema, planned, [] if left_out is None else left_out)
    return replace(table, schema=schema, batches=batches)


def _segments(
    table: Table,
    schema: pa.Schema,
    planned: Callable[[Table], tuple[Table, Plan]],
    left_out: list[TooShort],
) -> Iterator[pa.RecordBatch]:
    if SEGMENT not in table.columns:
        yield from _rows(*planned(table), schema, 0)
        return
    rows = read = 0

    def counted(batches: Iterator[pa.RecordBatch]) -> Iterator[pa.RecordBatch]:
        nonlocal read
        for batch in batches:
            read += batch.num_rows
            yield batch

    for segment in segments(table):
        first, part = read, replace(segment, batches=counted(segment.batches))
        try:
            for batch in _rows(*planned(part), schema, first):
                rows += batch.num_rows
                yield batch
        except TooShort as reason:
            left_out.append(reason)
    if not rows and left_out:
        raise left_out[0]


def _rows(table: Table, plan: Plan, schema: pa.Schema, first: int) -> Iterator[pa.RecordBatch]:
    """The rows of a record whose first row is row `first` of the table."""
    period = table.period
    running = [Running(task) for task in plan.tasks]
    waiting = Waiting(table, schema, plan.edges, before=first)
    for batch in table.batches:
        for run, x in zip(running, matrix(batch, [t.source for t in plan.tasks]), strict=True):
            run.step(x, period)
        waiting.append(batch)
        yield from waiting.joined(running, inf)
    rows = waiting.first + waiting.rows
    longest = plan.lag(period)
    if rows <= longest < inf:
        raise TooShort(
            f"{table.name}: a lag of {longest:g} samples is longer than the log of {rows} rows; "
            "shorten the window or the delay"
        )
    for run in running:
        run.finish()
    yield from waiting.joined(running, rows)


@dataclass
class Waiting:
    """The rows of a record that wait for some of their columns.

    `first` is the number of the first of these `rows` in the record, and `before` the number of
    rows of the table before this record.
    """

    table: Table
    schema: pa.Schema
    edges: Edges
    before: int = 0
    first: int = 0
    rows: int = 0
    batches: deque[pa.RecordBatch] = field(default_factory=deque)

    def append(self, batch: pa.RecordBatch) -> None:
        self.batches.append(batch)
        self.rows += batch.num_rows

    def joined(self, running: list[Running], total: float) -> Iterator[pa.RecordBatch]:
        """The rows whose columns are complete; the record has `total` rows."""
        rows = min((run.rows for run in running), default=self.rows)
        values: dict[str, Array] = {}
        for run in running if rows else ():
            values |= run.take(rows)
        _check(values, self.table, self.before + self.first)
        done = 0
        while done < rows:
            batch = self.batches.popleft()
            take = min(batch.num_rows, rows - done)
            if take < batch.num_rows:
                self.batches.appendleft(batch.slice(take))
            part: dict[str, Any] = {name: x[done : done + take] for name, x in values.items()}
            if "settled" in self.schema.names and "settled" not in batch.schema.names:
                part["settled"] = self.edges.marks(self.first + done, take, total)
            yield with_columns(batch.slice(0, take), self.schema, part)
            done += take
        self.first += rows
        self.rows -= rows


def _check(values: dict[str, Array], table: Table, row: int) -> None:
    if values and np.isfinite(np.concatenate([*values.values()])).all():
        return
    for column, value in values.items():
        if not np.isfinite(value).all():
            bad = int(np.argmin(np.isfinite(value)))
            raise bad_data(
                table.name,
                f"{value[bad]} as the result",
                expected="a finite number",
                remedy="the method diverged at this sampling period: lower its gains",
                row=table.row(row + bad + 1),
                column=column,
            )
