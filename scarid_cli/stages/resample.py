"""Put a log with a jittered clock on a regular one."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import chain

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.resampling import Clock, Resampler, State
from scarid_cli.arrays import Array, Numbers
from scarid_cli.errors import bad_data
from scarid_cli.io.table import Table, doubles, matrix

SLOWER = 1.05  # times the log's own period: the rate is lowered
FIRST = 33  # rows, whose intervals tell the rate of the log


def resample(
    table: Table, rate: float, max_gap: float, told: Callable[[Clock], None] | None = None
) -> Table:
    """The table at a constant rate [Hz]; `told` hears of the clock once all rows have gone by.

    Numbers are interpolated, or averaged over a new period if that is longer than the log's own;
    other columns have the value of the row before.
    """
    meta = replace(table.meta, period=1.0 / rate)
    batches = _rows(table, 1.0 / rate, max_gap, told or (lambda _: None))
    return replace(table, meta=meta, batches=batches)


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
    table: Table, period: float, max_gap: float, told: Callable[[Clock], None]
) -> Iterator[pa.RecordBatch]:
    own, batches = _begun(table.batches)
    resampler = Resampler(period, smooth=period > SLOWER * own)
    numbers = [f.name for f in table.schema if pa.types.is_floating(f.type) and f.name != "t"]
    state: State | None = None
    held: pa.RecordBatch | None = None  # the samples of the state, with all their columns
    row = 0
    for whole in batches:
        before = state.t[-1] if state else None
        steps, kept = _checked(whole, before, table.name, row, max_gap)
        row += whole.num_rows
        batch = whole if len(kept) == whole.num_rows else whole.take(pa.array(kept))
        t, *values = matrix(batch, ["t", *numbers])
        x = np.array(values).reshape(len(numbers), len(t))
        if state is None:
            state = resampler.init(float(t[0]), x[:, 0])
            held = batch.slice(0, 1)
            batch, t, x = batch.slice(1), t[1:], x[:, 1:]
        state = replace(state, clock=state.clock.after(steps, whole.num_rows - len(kept)))
        if not len(t):
            continue
        together = pa.Table.from_batches([held, batch]).combine_chunks().to_batches()[0]
        times = np.concatenate((state.t, t))
        state, at, found = resampler.step(state, t, x)
        held = together.slice(len(times) - len(state.t))
        if len(at):
            left = np.maximum(np.searchsorted(times, at + 1e-12, side="right") - 1, 0)
            yield _joined(together, table.schema, at, dict(zip(numbers, found, strict=True)), left)
    if state:
        told(state.clock)


def _checked(
    batch: pa.RecordBatch, before: float | None, name: str, row: int, max_gap: float
) -> tuple[Array, Numbers]:
    """The intervals of the clock, and the rows that do not repeat the time before them."""
    t = matrix(batch, ["t"])[0]
    steps = np.diff(t) if before is None else np.diff(t, prepend=before)
    first = row + (2 if before is None else 1)
    if np.any(steps < 0.0):
        at = int(np.argmax(steps < 0.0))
        raise bad_data(
            name,
            f"time that goes back by {-steps[at]:.6g} s",
            expected="time to increase from row to row",
            remedy="sort the log",
            row=first + at,
            column="t",
        )
    if np.any(steps > max_gap):
        at = int(np.argmax(steps > max_gap))
        raise bad_data(
            name,
            f"a gap of {steps[at]:.6g} s",
            expected=f"at most {max_gap:g} s",
            remedy="cut the log there, or allow it with --max-gap",
            row=first + at,
            column="t",
        )
    moved = steps > 0.0
    kept = np.flatnonzero(moved if before is not None else np.append(True, moved))
    return steps[moved], kept


def _joined(
    source: pa.RecordBatch, schema: pa.Schema, at: Array, numbers: dict[str, Array], left: Numbers
) -> pa.RecordBatch:
    columns = []
    for field in schema:
        if field.name == "t":
            columns.append(doubles(at))
        elif field.name in numbers:
            columns.append(doubles(numbers[field.name]))
        else:
            columns.append(source.column(field.name).take(pa.array(left)))
    return pa.RecordBatch.from_arrays(columns, schema=schema)
