"""Estimate velocities and accelerations from positions: the soft sensor."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.recursion import Lowpass, Matched, Method
from scarid_cli.arrays import Array
from scarid_cli.errors import bad_data
from scarid_cli.io.table import Table, matrix, number, with_columns
from scarid_cli.stages.filter import causal


def differentiate(table: Table, methods: list[Method]) -> Table:
    """A motion: the table with dq and ddq columns, one method per joint, in their order.

    A row keeps its time: a method that looks ahead delays all other columns with its own.
    """
    for method in methods:
        method.init(0.0, table.meta.period or 0.0)  # refuses settings before anything is written
    joints = range(1, len(methods) + 1)
    new = [f"dq{i}" for i in joints] + [f"ddq{i}" for i in joints]
    schema = _schema(table, new)
    meta = replace(table.meta, kind="motion")
    return replace(table, schema=schema, meta=meta, batches=_rows(table, methods, schema, new))


def matched(table: Table, methods: list[Matched]) -> Table:
    """A motion whose positions and torques passed through the dynamics of the derivatives."""
    filters: dict[str, Lowpass] = {}
    for i, method in enumerate(methods, start=1):
        if method.companion:
            pair = {f"q{i}": method.companion, f"tau{i}": method.companion}
            filters |= {name: f for name, f in pair.items() if name in table.columns}
    motion = differentiate(table, list(methods))
    return causal(motion, filters) if filters else motion


def _schema(table: Table, new: list[str]) -> pa.Schema:
    kept = [field for field in table.schema if field.name not in new]
    added = []
    for name in new:
        unit = table.unit(f"q{name.lstrip('dq')}")
        per_time = "/s2" if name.startswith("ddq") else "/s"
        added.append(number(name, unit + per_time if unit else None))
    return pa.schema(kept + added)


def _rows(
    table: Table, methods: list[Method], schema: pa.Schema, new: list[str]
) -> Iterator[pa.RecordBatch]:
    columns = [f"q{i}" for i in range(1, len(methods) + 1)]
    states: list[Any] = []
    waiting: deque[pa.RecordBatch] = deque()
    row = 0
    for batch in table.batches:
        positions = matrix(batch, columns)
        if not states:
            period = table.meta.period or 0.0
            states = [m.init(float(q[0]), period) for m, q in zip(methods, positions, strict=True)]
        results = [m.step(s, q) for m, s, q in zip(methods, states, positions, strict=True)]
        states = [state for state, _ in results]
        waiting.append(batch)
        settled = [pair for _, pair in results]
        yield from _joined(waiting, settled, table, schema, new, row)
        row += len(settled[0][0])
    settled = [m.finish(s) for m, s in zip(methods, states, strict=True)]
    yield from _joined(waiting, settled, table, schema, new, row)


def _joined(
    waiting: deque[pa.RecordBatch],
    settled: list[tuple[Array, Array]],
    table: Table,
    schema: pa.Schema,
    new: list[str],
    row: int,
) -> Iterator[pa.RecordBatch]:
    """The rows whose derivatives are settled, taken from those that wait."""
    values = [v for v, _ in settled] + [a for _, a in settled]
    for column, value in zip(new, values, strict=True):
        if not np.isfinite(value).all():
            bad = int(np.argmin(np.isfinite(value)))
            raise bad_data(
                table.name,
                f"{value[bad]} as the derivative",
                expected="a finite number",
                remedy="the method diverged at this sampling period: lower its gains",
                row=row + bad + 1,
                column=column,
            )
    done = 0
    while done < len(values[0]):
        batch = waiting.popleft()
        take = min(batch.num_rows, len(values[0]) - done)
        if take < batch.num_rows:
            waiting.appendleft(batch.slice(take))
        part = {name: x[done : done + take] for name, x in zip(new, values, strict=True)}
        yield with_columns(batch.slice(0, take), schema, part)
        done += take
