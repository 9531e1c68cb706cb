"""Run processes over columns of a table; rows leave as soon as all their columns have."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from math import inf
from typing import Any

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.process import Process
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault, bad_data
from scarid_cli.io.table import Table, integers, matrix, with_columns


@dataclass(frozen=True)
class Task:
    """A process, the column it reads, and the columns it writes."""

    source: str
    process: Process
    outputs: tuple[str, ...]


@dataclass
class Running:
    """A task with its state, and the parts of its outputs that wait for the other tasks."""

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
        """The first rows of each output."""
        parts = [part for part in self.parts if part]
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
        """The column `settled` of so many rows from the first on, of a record of total rows."""
        at = np.arange(first, first + rows)
        return integers((at >= self.start) & (at < total - self.end))


def processed(
    table: Table, tasks: list[Task], schema: pa.Schema, edges: Edges | None = None
) -> Table:
    """The table with the columns that the tasks write, and with edges the column `settled`.

    A row keeps its time: a process that looks ahead delays all other columns with its own.
    """
    period = table.meta.period or 0.0
    for task in tasks:
        task.process.init(0.0, period)  # refuses settings before anything is written
    batches = _rows(table, tasks, schema, edges or Edges())
    return replace(table, schema=schema, batches=batches)


def lag(tasks: list[Task], period: float) -> float:
    """By how many rows the output of the slowest waits; inf for the whole record."""
    return max((task.process.lag(period) for task in tasks), default=0)


def _rows(
    table: Table, tasks: list[Task], schema: pa.Schema, edges: Edges
) -> Iterator[pa.RecordBatch]:
    period = table.meta.period or 0.0
    running = [Running(task) for task in tasks]
    waiting = Waiting(table.name, schema, edges)
    for batch in table.batches:
        for run, x in zip(running, matrix(batch, [t.source for t in tasks]), strict=True):
            run.step(x, period)
        waiting.append(batch)
        yield from waiting.joined(running, inf)
    rows = waiting.first + waiting.rows
    longest = lag(tasks, period)
    if rows <= longest < inf:
        raise UsageFault(
            f"{table.name}: a lag of {longest:g} samples is longer than the log of {rows} rows; "
            "shorten the window or the delay"
        )
    for run in running:
        run.finish()
    yield from waiting.joined(running, rows)


@dataclass
class Waiting:
    """The rows whose outputs are not all there yet; `first` is the number of the first."""

    name: str
    schema: pa.Schema
    edges: Edges
    first: int = 0
    rows: int = 0
    batches: deque[pa.RecordBatch] = field(default_factory=deque)

    def append(self, batch: pa.RecordBatch) -> None:
        self.batches.append(batch)
        self.rows += batch.num_rows

    def joined(self, running: list[Running], total: float) -> Iterator[pa.RecordBatch]:
        """The rows that every task has settled, with its columns; of a record of total rows."""
        rows = min((run.rows for run in running), default=self.rows)
        values: dict[str, Array] = {}
        for run in running if rows else ():
            values |= run.take(rows)
        _check(values, self.name, self.first)
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


def _check(values: dict[str, Array], name: str, row: int) -> None:
    for column, value in values.items():
        if not np.isfinite(value).all():
            bad = int(np.argmin(np.isfinite(value)))
            raise bad_data(
                name,
                f"{value[bad]} as the result",
                expected="a finite number",
                remedy="the method diverged at this sampling period: lower its gains",
                row=row + bad + 1,
                column=column,
            )
