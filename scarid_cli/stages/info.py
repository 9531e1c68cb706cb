"""Describe a table in lines of text."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyarrow as pa

from scarid_cli.io import schemas
from scarid_cli.io.clock import nominal_period
from scarid_cli.io.table import SEGMENT, Instant, Table, steps_of


def described(table: Table) -> Iterator[str]:
    """The lines that describe a table: kind, robot, rows, sampling, metadata, columns, history."""
    meta = table.meta
    schema = schemas.load(meta.kind) if meta.kind else schemas.detect(table.columns)
    origin = f"version {meta.version}" if meta.kind else "inferred from its columns"
    yield f"table     {table.name}"
    yield f"kind      {f'{schema.kind} ({origin})' if schema else 'unknown'}"
    yield f"robot     {meta.robot or 'not stated'}"
    rows, clock = _read(table)
    yield f"rows      {rows:,}"
    if clock:
        yield f"time      {clock.description(rows)}"
    for key, value in sorted(meta.extra.items()):
        yield from _metadata(key, value)
    yield "columns"
    width = max((len(name) for name in table.columns), default=0)
    for field in table.schema:
        known = schema.field_of(field.name) if schema else None
        unit = table.unit(field.name) or "-"
        about = known.about(field.name) if known else ""
        yield f"  {field.name:<{width}}  {field.type!s:<7} {unit:<10} {about}".rstrip()
    yield "history" if meta.history else "history   none"
    for entry in meta.history:
        yield f"  {entry['command']}  (scarid {entry['version']})"
        for name, digest in entry["inputs"].items():
            yield f"    {name}: {f'sha256 {digest}' if digest else 'a pipe'}"


def _metadata(key: str, value: Any) -> Iterator[str]:
    """A value on one line, a list with one line for each item, a matrix by its size only."""
    if isinstance(value, list) and value and isinstance(value[0], list):
        yield f"{key:<9} {len(value)} by {len(value[0])} numbers"
    elif isinstance(value, dict) and "information" in value:
        yield f"{key:<9} of {len(value['score'])} columns in {value['blocks']} blocks"
    elif isinstance(value, list):
        yield key
        yield from (f"  {_text(item)}" for item in value)
    else:
        yield f"{key:<9} {_text(value)}"


def _text(value: Any) -> str:
    if isinstance(value, dict):
        return ", ".join(f"{name} {_text(item)}" for name, item in value.items())
    return f"{value:.6g}" if isinstance(value, float) else str(value)


@dataclass
class Sampling:
    """The sampling of a table: the first and last time, the first interval, and the gaps [s].

    `gaps` is their number, and `missing` the time that they take in all.
    """

    start: float
    end: float
    interval: float | None = None
    gaps: int = 0
    missing: float = 0.0

    def description(self, rows: int) -> str:
        text = f"{self.start:.9g} s to {self.end:.9g} s"
        between = rows - 1 - self.gaps
        if self.interval is None or between < 1:
            return text
        period = nominal_period(self.interval)
        mean = (self.end - self.start - self.missing) / between
        if period <= 0.0 or mean <= 0.0:
            return f"{text}, time does not increase"
        plural = "s" if self.gaps > 1 else ""
        gaps = f", {self.gaps} gap{plural} of {self.missing:.3g} s in all" if self.gaps else ""
        return f"{text}, nominal {1.0 / period:.6g} Hz, mean {1.0 / mean:.6g} Hz{gaps}"


def _read(table: Table) -> tuple[int, Sampling | None]:
    """The number of rows, and their sampling if the table has a time column."""
    types = {field.name: field.type for field in table.schema}
    timed = pa.types.is_floating(types.get("t", pa.null()))
    # In a table of another kind the column may be something else.
    marked = pa.types.is_integer(types.get(SEGMENT, pa.null()))
    rows = 0
    clock: Sampling | None = None
    last: Instant | None = None
    for batch in table.batches:
        rows += batch.num_rows
        if not timed or not batch.num_rows:
            continue
        first = last is None
        steps, jumps, last = steps_of(batch.select(["t", SEGMENT] if marked else ["t"]), last)
        if clock is None:
            start = batch.column("t")[0].as_py()
            clock = Sampling(start, start)
        within = steps[jumps == 0][first:]
        if clock.interval is None and len(within):
            clock.interval = float(within[0])
        clock.gaps += int(np.count_nonzero(jumps))
        clock.missing += float(steps[jumps != 0].sum())
        clock.end = last[0]
    return rows, clock
