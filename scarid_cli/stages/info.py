"""Describe a table in lines of text."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from scarid_cli.io import schemas
from scarid_cli.io.reader import nominal_period
from scarid_cli.io.table import Table


def described(table: Table) -> Iterator[str]:
    """Kind, robot, columns with type and unit, rows, sampling and history, a line each."""
    meta = table.meta
    schema = schemas.load(meta.kind) if meta.kind else schemas.detect(table.columns)
    origin = f"version {meta.version}" if meta.kind else "told by its columns"
    yield f"table     {table.name}"
    yield f"kind      {f'{schema.kind} ({origin})' if schema else 'unknown'}"
    yield f"robot     {meta.robot or 'not stated'}"
    rows, times = _read(table)
    yield f"rows      {rows:,}"
    if times is not None:
        yield f"time      {times[0]:.9g} s to {times[1]:.9g} s, {_rate(*times, rows)}"
    for key, value in sorted(meta.extra.items()):
        yield from _told(key, value)
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


def _told(key: str, value: Any) -> Iterator[str]:
    """A value on its line; what a list holds, on lines of their own."""
    if isinstance(value, list):
        yield key
        yield from (f"  {_shown(item)}" for item in value)
    else:
        yield f"{key:<9} {_shown(value)}"


def _shown(value: Any) -> str:
    if isinstance(value, dict):
        return ", ".join(f"{name} {_shown(item)}" for name, item in value.items())
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _read(table: Table) -> tuple[int, tuple[float, float, float] | None]:
    """The number of rows; the first and last time and the first interval."""
    timed = "t" in table.columns
    rows = 0
    times: list[float] = []
    last = 0.0
    for batch in table.batches:
        rows += batch.num_rows
        if timed and batch.num_rows:
            column = batch.column("t")
            times += column[: 2 - len(times)].to_pylist() if len(times) < 2 else []
            last = column[-1].as_py()
    return rows, (times[0], last, times[1] - times[0]) if len(times) == 2 else None


def _rate(start: float, end: float, interval: float, rows: int) -> str:
    period = nominal_period(interval)
    mean = (end - start) / (rows - 1)
    if period <= 0.0 or mean <= 0.0:
        return "time does not increase"
    return f"nominal {1.0 / period:.6g} Hz, mean {1.0 / mean:.6g} Hz"
