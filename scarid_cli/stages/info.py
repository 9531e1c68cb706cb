"""Describe a table: in lines of text, or as a JSON document."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from math import inf
from typing import Any

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.processes.holding import FIRST, MAX_GAP
from scarid_cli.algorithms.processes.rates import ROWS, mean_rate, round_rate
from scarid_cli.arrays import Array, Numbers, median
from scarid_cli.io import schemas
from scarid_cli.io.clock import DRIFT, nominal_period
from scarid_cli.io.table import SEGMENT, Instant, Table, matrix, steps_of
from scarid_cli.printable import printable
from scarid_cli.stages.conversion.wording import renamable

FEW = 8  # values of a list, or entries of a dictionary, that are shown


@dataclass
class Extent:
    """The least and greatest finite value of a column of numbers, and its cells without one."""

    least: float = inf
    greatest: float = -inf
    missing: int = 0

    def add(self, values: Array) -> None:
        known = values[np.isfinite(values)]
        self.missing += len(values) - len(known)
        self.least = min(self.least, float(known.min(initial=inf)))
        self.greatest = max(self.greatest, float(known.max(initial=-inf)))

    @property
    def text(self) -> str:
        parts = [f"{self.least:.3g} to {self.greatest:.3g}"] if self.least <= self.greatest else []
        parts += [f"{self.missing:,} missing"] if self.missing else []
        return ", ".join(parts)


@dataclass(frozen=True)
class Column:
    """A column of a table; `extent` is None if it does not hold numbers."""

    name: str
    type: str
    unit: str | None
    about: str
    extent: Extent | None

    @property
    def document(self) -> dict[str, Any]:
        """The column as JSON holds it; without finite values, the extremes are None."""
        found: dict[str, Any] = {key: getattr(self, key) for key in ("name", "type", "unit")}
        if self.extent:
            known = self.extent.least <= self.extent.greatest
            found["minimum"] = self.extent.least if known else None
            found["maximum"] = self.extent.greatest if known else None
            found["missing"] = self.extent.missing
        return found


@dataclass(frozen=True)
class Description:
    """What a table holds; `kind` is that of its metadata, or one that its columns fit."""

    table: Table
    schema: schemas.TableSchema | None
    rows: int
    sampling: Sampling | None
    columns: tuple[Column, ...]

    @property
    def lines(self) -> Iterator[str]:
        """Kind, robot, rows, sampling, metadata, columns and history, for a person."""
        meta, schema = self.table.meta, self.schema
        stated = schema and schema.kind == meta.kind
        origin = f"version {meta.version}" if stated else "inferred from its columns"
        kind = f"{schema.kind} ({origin})" if schema else "unknown"
        if not stated and renamable(self.table.columns):
            kind = "log with other names of columns (`scarid convert` gives it ours)"
        elif schema and schema.kind == "trace" and not stated:  # which may have any names
            kind = "trace (or a log whose columns have other names: `scarid convert --map`)"
        yield f"table     {self.table.name}"
        yield f"kind      {kind}"
        yield f"robot     {meta.robot or 'not stated'}"
        yield f"rows      {self.rows:,}"
        if self.sampling:
            yield f"time      {self.sampling.description(self.rows)}"
        for key, value in sorted(meta.extra.items()):
            yield from _metadata(key, value)
        yield "columns"
        yield from _columns(self.columns)
        yield "history" if meta.history else "history   none"
        for entry in meta.history:
            yield f"  {entry['command']}  (scarid {entry['version']})"
            for name, digest in entry["inputs"].items():
                yield f"    {name}: {f'sha256 {digest}' if digest else 'a pipe'}"

    @property
    def document(self) -> dict[str, Any]:
        """The same as JSON holds it."""
        meta = self.table.meta
        return {
            "table": self.table.name,
            "kind": self.schema.kind if self.schema else None,
            "version": meta.version if meta.kind else None,
            "robot": meta.robot,
            "rows": self.rows,
            "time": self.sampling.document(self.rows) if self.sampling else None,
            "metadata": meta.extra,
            "columns": [column.document for column in self.columns],
            "history": list(meta.history),
        }


def described(table: Table) -> Description:
    """The description of a table, all of whose rows are read."""
    kind = table.meta.kind
    known = kind in schemas.KINDS  # a file of another name is not to be opened
    schema = schemas.load(kind) if kind and known else schemas.detect(table.columns)
    extents = {f.name: Extent() for f in table.schema if _numeric(f.type)}
    rows, sampling = _read(table, extents)
    columns = tuple(_column(table, schema, field, extents) for field in table.schema)
    return Description(table, schema, rows, sampling, columns)


def _numeric(kind: pa.DataType) -> bool:
    return bool(pa.types.is_floating(kind) or pa.types.is_integer(kind))


def _column(
    table: Table, schema: schemas.TableSchema | None, field: pa.Field, extents: dict[str, Extent]
) -> Column:
    known = schema.field_of(field.name) if schema else None
    about = known.about(field.name) if known else ""
    unit = table.unit(field.name)
    return Column(field.name, str(field.type), unit, about, extents.get(field.name))


def _columns(columns: tuple[Column, ...]) -> Iterator[str]:
    """A line for each column: name, type, unit, extremes, and what it is."""
    ranges = [column.extent.text if column.extent else "" for column in columns]
    names = [printable(column.name) for column in columns]
    width = max(map(len, names), default=0)
    wide = max(map(len, ranges), default=0)
    for column, name, text in zip(columns, names, ranges, strict=True):
        start = f"  {name:<{width}}  {column.type:<7} {column.unit or '-':<10}"
        yield f"{start} {text:<{wide}}  {column.about}".rstrip()


def _metadata(key: str, value: Any) -> Iterator[str]:
    """A value on one line, a collection with one line for each item, a matrix by its size only."""
    if isinstance(value, list) and value and all(isinstance(row, list) for row in value):
        yield f"{key:<9} {len(value)} by {len(value[0])} numbers"
    elif key == "evidence" and value:
        yield f"{key:<9} of {len(value['score'])} columns in {value['blocks']} blocks"
    elif isinstance(value, list):
        yield key
        yield from (f"  {_text(item)}" for item in value)
    elif isinstance(value, dict) and len(value) > FEW:
        yield f"{key:<9} {len(value)} entries (--json shows them)"
    elif isinstance(value, dict) and any(isinstance(item, dict | list) for item in value.values()):
        yield key
        yield from (f"  {name}: {_text(item)}" for name, item in value.items())
    else:
        yield f"{key:<9} {_text(value)}"


def _text(value: Any) -> str:
    if isinstance(value, dict):
        return ", ".join(f"{name} {_text(item)}" for name, item in value.items())
    if isinstance(value, list):
        return " ".join(map(_text, value)) if len(value) <= FEW else f"{len(value)} values"
    return f"{value:.6g}" if isinstance(value, float) else str(value)


@dataclass
class Sampling:
    """The sampling of a table: the first and last time, the first interval, and the gaps [s].

    A gap is where a segment begins, or where time advances by more than MAX_GAP periods. `gaps` is
    their number, and `missing` the time that they take in all. The first intervals wait until their
    median, the period, is known; more of them, the `first`, tell the rate of a clock that jitters.
    """

    start: float
    end: float
    interval: float | None = None
    gaps: int = 0
    missing: float = 0.0
    period: float = 0.0
    waiting: list[float] = field(default_factory=list)
    first: list[float] = field(default_factory=list)

    def add(self, steps: Array, jumps: Numbers, end: float) -> None:
        """Count on by the intervals [s] to the next rows, at which segments may begin."""
        self.end = end
        self.gaps += int(np.count_nonzero(jumps))
        self.missing += float(steps[jumps != 0].sum())
        within = steps[jumps == 0].tolist()
        if self.interval is None and within:
            self.interval = within[0]
        self.waiting += within
        self.first += within[: ROWS - len(self.first)]
        if self.period or sum(step > 0.0 for step in self.waiting) >= FIRST:
            self.settle()

    def settle(self) -> None:
        """Count the gaps among the intervals that wait."""
        forward = [step for step in self.waiting if step > 0.0]
        self.period = self.period or median(np.array(forward[:FIRST] or [0.0]))
        long = [step for step in forward if step > MAX_GAP * self.period]
        self.gaps += len(long)
        self.missing += sum(long)
        self.waiting.clear()

    @property
    def nominal(self) -> float:
        """The period [s] of the first interval; of the mean rate, rounded, if that is another."""
        period = nominal_period(self.interval or 0.0)
        rate = mean_rate(np.array(self.first))
        if not rate or abs(rate * period - 1.0) <= DRIFT:
            return period
        return 1.0 / round_rate(rate)

    def document(self, rows: int) -> dict[str, Any]:
        """The sampling as JSON holds it; the period [s] is None if time does not increase."""
        between = rows - 1 - self.gaps
        mean = (self.end - self.start - self.missing) / between if between > 0 else 0.0
        period = self.nominal
        return {
            "start": self.start,
            "end": self.end,
            "period": period if period > 0.0 else None,
            "mean_period": mean if mean > 0.0 else None,
            "gaps": self.gaps,
            "missing_time": self.missing,
        }

    def description(self, rows: int) -> str:
        text = f"{self.start:.9g} s to {self.end:.9g} s"
        between = rows - 1 - self.gaps
        if self.interval is None or between < 1:
            return text
        period = self.nominal
        mean = (self.end - self.start - self.missing) / between
        if period <= 0.0 or mean <= 0.0:
            return f"{text}, time does not increase"
        plural = "s" if self.gaps > 1 else ""
        gaps = f", {self.gaps} gap{plural} of {self.missing:.3g} s in all" if self.gaps else ""
        return f"{text}, nominal {1.0 / period:.6g} Hz, mean {1.0 / mean:.6g} Hz{gaps}"


def _read(table: Table, extents: dict[str, Extent]) -> tuple[int, Sampling | None]:
    """The number of rows, and their sampling if the table has a time column.

    The columns of numbers are added to their `extents`.
    """
    types = {field.name: field.type for field in table.schema}
    timed = pa.types.is_floating(types.get("t", pa.null()))
    # In a table of another kind the column may be something else.
    marked = pa.types.is_integer(types.get(SEGMENT, pa.null()))
    rows = 0
    clock: Sampling | None = None
    last: Instant | None = None
    for batch in table.batches:
        rows += batch.num_rows
        for name, extent in extents.items():
            extent.add(matrix(batch, [name])[0])
        if not timed:
            continue
        first = last is None
        batch = batch.select(["t", SEGMENT] if marked else ["t"])
        known = np.isfinite(matrix(batch, ["t"])[0])
        if not known.any():
            continue
        batch = batch if known.all() else batch.filter(pa.array(known))
        steps, jumps, last = steps_of(batch, last)
        clock = clock or Sampling(batch.column("t")[0].as_py(), 0.0)
        clock.add(steps[first:], jumps[first:], last[0])
    if clock:
        clock.settle()
    return rows, clock
