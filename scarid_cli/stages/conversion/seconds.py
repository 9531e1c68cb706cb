"""One clock from two columns, of whole seconds and of their fraction: sec and nanosec."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pyarrow as pa

from scarid_cli.arrays import Array
from scarid_cli.io.table import Table, doubles, number

WORD = re.compile(r"[A-Za-z]+|\d+")
SECONDS = {"sec", "secs", "seconds"}
FRACTIONS = {
    "nanosec": 1e-9, "nanosecs": 1e-9, "nanoseconds": 1e-9, "nsec": 1e-9, "nsecs": 1e-9,
    "nanos": 1e-9, "micros": 1e-6, "usec": 1e-6, "usecs": 1e-6, "microsec": 1e-6,
    "microseconds": 1e-6,
}  # fmt: skip


def clock_columns(names: list[str]) -> tuple[str, str, float] | None:
    """The columns of seconds and of their fraction, and its unit [s]; None if there are none.

    Both have the same words beside that of the unit. The header's stamp comes before others.
    """
    whole = {_beside(name, SECONDS): name for name in reversed(names) if _beside(name, SECONDS)}
    found = []
    for name in names:
        for word, unit in FRACTIONS.items():
            rest = _beside(name, {word})
            if rest and rest in whole:
                found.append((whole[rest], name, unit))
    found.sort(key=lambda pair: "header" not in pair[0])
    return found[0] if found else None


def _beside(name: str, unit: set[str]) -> tuple[str, ...]:
    """The words of a name, with * for that of the unit; empty if it has none."""
    words = tuple(word.lower() for word in WORD.findall(name))
    return tuple("*" if word in unit else word for word in words) if unit & {*words} else ()


def with_one_clock(table: Table, columns: tuple[str, str, float]) -> Table:
    """The table with the time t [s] since its first row in place of these two columns."""
    whole, fraction, unit = columns
    kept = [f for f in table.schema if f.name not in (whole, fraction)]
    schema = pa.schema([number("t", "s"), *kept])
    return replace(table, schema=schema, batches=_rows(table, schema, whole, fraction, unit))


def _rows(
    table: Table, schema: pa.Schema, whole: str, fraction: str, unit: float
) -> Iterator[pa.RecordBatch]:
    start = None
    for batch in table.batches:
        seconds, rest = _numbers(batch, whole), _numbers(batch, fraction)
        if start is None and batch.num_rows:
            start = seconds[0], rest[0]
        first = start or (0.0, 0.0)
        t = (seconds - first[0]) + unit * (rest - first[1])
        columns = [doubles(t), *(batch.column(name) for name in schema.names[1:])]
        yield pa.RecordBatch.from_arrays(columns, schema=schema)


def _numbers(batch: pa.RecordBatch, name: str) -> Array:
    found = batch.column(name).cast(pa.float64()).to_numpy(zero_copy_only=False)
    return np.asarray(found, dtype=np.float64)
