"""Estimate velocities and accelerations from positions: the soft sensor."""

from __future__ import annotations

from dataclasses import replace
from math import inf
from typing import Any

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.matching import spread
from scarid_cli.algorithms.process import Matched, Method
from scarid_cli.io.table import Table, matrix, number
from scarid_cli.stages.columns import Edges, Task, lag, processed


def differentiate(table: Table, methods: list[Method]) -> Table:
    """A motion: the table with dq and ddq columns, one method per joint, in their order."""
    table, methods = _fitted(table, methods)
    tasks = [
        Task(f"q{i}", method, (f"dq{i}", f"ddq{i}")) for i, method in enumerate(methods, start=1)
    ]
    return processed(_motion(table, tasks, []), tasks, _schema(table, len(methods), []))


def matched(table: Table, methods: list[Method]) -> Table:
    """A motion whose positions and torques belong to the instant of the derivatives.

    The column `settled` is 0 where the start or the end of the record still shows.
    """
    table, methods = _fitted(table, methods)
    period = table.meta.period or 0.0
    tasks, spreads = [], [(0, 0)]
    for i, form in enumerate((method.matched() for method in methods), start=1):
        tasks.append(Task(f"q{i}", form, (f"q{i}", f"dq{i}", f"ddq{i}")))
        if form.companion is None:
            continue
        spreads.append(_spread(form, period))
        if f"tau{i}" in table.columns:
            tasks.append(Task(f"tau{i}", form.companion, (f"tau{i}",)))
    before, after = (max(sides) for sides in zip(*spreads, strict=True))
    marks = [pa.field("settled", pa.int64())]
    schema = _schema(table, len(methods), marks)
    return processed(_motion(table, tasks, marks), tasks, schema, Edges(after, before))


def _spread(form: Matched, period: float) -> tuple[int, int]:
    form.init(0.0, period)  # refuses settings
    return spread(form.companion, period) if form.companion else (0, 0)


def _fitted(table: Table, methods: list[Method]) -> tuple[Table, list[Method]]:
    """Methods that tune themselves see the whole record first."""
    if not any(hasattr(method, "fitted") for method in methods):
        return table, methods
    batches = list(table.batches)
    columns = [f"q{i}" for i in range(1, len(methods) + 1)]
    positions = np.concatenate([matrix(batch, columns) for batch in batches], axis=1)
    period = table.meta.period or 0.0
    fitted: list[Any] = [
        method.fitted(q, period) if hasattr(method, "fitted") else method
        for method, q in zip(methods, positions, strict=True)
    ]
    return replace(table, batches=iter(batches)), fitted


def _motion(table: Table, tasks: list[Task], marks: list[pa.Field]) -> Table:
    """The table as a motion, with the lag of its rows [s] in the metadata."""
    period = table.meta.period or 0.0
    rows = lag(tasks, period)
    extra = dict(table.meta.extra)
    if rows:
        extra["lag"] = "whole record" if rows == inf else rows * period
    batches = table.batches
    if marks and "settled" in table.columns:
        kept = [name for name in table.columns if name != "settled"]
        batches = (batch.select(kept) for batch in batches)
    return replace(table, meta=replace(table.meta, kind="motion", extra=extra), batches=batches)


def _schema(table: Table, joints: int, marks: list[pa.Field]) -> pa.Schema:
    numbers = range(1, joints + 1)
    new = [f"dq{i}" for i in numbers] + [f"ddq{i}" for i in numbers]
    kept = [f for f in table.schema if f.name not in [*new, *(mark.name for mark in marks)]]
    added = []
    for name in new:
        unit = table.unit(f"q{name.lstrip('dq')}")
        per_time = "/s2" if name.startswith("ddq") else "/s"
        added.append(number(name, unit + per_time if unit else None))
    return pa.schema(kept + added + marks)
