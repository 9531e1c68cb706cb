"""Give a recorded log the column names, units and clock that the commands expect."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from fnmatch import fnmatchcase

import numpy as np
import pyarrow as pa

from scarid_cli.errors import UsageFault, bad_row
from scarid_cli.io.cells import MISSING
from scarid_cli.io.schemas import column_type
from scarid_cli.io.table import Table, doubles, matrix, number
from scarid_cli.stages.conversion.dates import since_start
from scarid_cli.stages.conversion.units import UNITS, is_stated, scale_of


def adapted(
    table: Table, names: dict[str, str], units: list[tuple[str, str]], rate: float | None
) -> Table:
    """The table with renamed and converted columns, and with a clock.

    Texts in columns of numbers are read as numbers, or as missing.

    `names` maps each new column name to the old one; `units` pairs patterns of new names with the
    unit of these columns in the log. A `rate` [Hz] adds a time column to a table without one. Dates
    become seconds since the first one.
    """
    if not is_stated("t", units):
        table = since_start(table, names.get("t", "t"))
    fields = _renamed(table, names)
    new = [field.name for field in fields]
    table = _with_numbers(table, new)
    fields = [f.with_type(own.type) for f, own in zip(fields, table.schema, strict=True)]
    scales = _scales(new, units)
    if rate is not None and "t" in new:
        raise UsageFault("--rate: the table has a time column t")
    out = [number(f.name, scales[f.name][1]) if f.name in scales else f for f in fields]
    clock = [number("t", "s")] if rate is not None else []
    schema = pa.schema([*clock, *out])
    return replace(table, schema=schema, batches=_rows(table, schema, new, scales, rate))


def _with_numbers(table: Table, names: list[str]) -> Table:
    """The table with numbers for texts where its columns, by their new names, have numbers.

    A reader takes a column for texts if its first value is missing.
    """
    texts = [
        k
        for k, (name, field) in enumerate(zip(names, table.schema, strict=True))
        if pa.types.is_string(field.type) and column_type(name) == pa.float64()
    ]
    if not texts:
        return table
    schema = table.schema
    for k in texts:
        schema = schema.set(k, schema.field(k).with_type(pa.float64()))
    return replace(table, schema=schema, batches=_numbers(table, schema, texts))


def _numbers(table: Table, schema: pa.Schema, texts: list[int]) -> Iterator[pa.RecordBatch]:
    row = 0
    for batch in table.batches:
        columns = [*batch.columns]
        for k in texts:
            try:
                columns[k] = pa.array(map(_number, columns[k].to_pylist()), pa.float64())
            except ValueError:
                wrong = next(i for i, x in enumerate(columns[k].to_pylist()) if not _is_number(x))
                found, at = f"'{columns[k][wrong]}'", table.row(row + wrong + 1)
                raise bad_row(table.name, found, "a number", at, schema[k].name) from None
        row += batch.num_rows
        yield pa.RecordBatch.from_arrays(columns, schema=schema)


def _number(text: str | None) -> float | None:
    if text is None or text.strip() in ("", "-", *MISSING):
        return None
    return float(text.replace("_", "x"))  # no separator of thousands


def _is_number(text: str | None) -> bool:
    try:
        _number(text)
    except ValueError:
        return False
    return True


def _renamed(table: Table, names: dict[str, str]) -> list[pa.Field]:
    for old in names.values():
        if old not in table.columns:
            raise UsageFault(
                f"{table.name}: no column {old!r} to rename; it has {', '.join(table.columns)}"
            )
    to: dict[str, str] = {}
    for new, old in names.items():
        if old in to:
            raise UsageFault(
                f"--map: column {old!r} cannot become both {to[old]!r} and {new!r}; "
                "give it one new name"
            )
        to[old] = new
    fields = [f.with_name(to.get(f.name, f.name)) for f in table.schema]
    counts = Counter(f.name for f in fields)
    twice = next((name for name, count in counts.items() if count > 1), None)
    if twice:
        raise UsageFault(
            f"--map: two columns would be called {twice!r}; give the other one another name as "
            f"well: --map NAME={twice}"
        )
    return fields


def _scales(names: list[str], units: list[tuple[str, str]]) -> dict[str, tuple[float, str]]:
    scales: dict[str, tuple[float, str]] = {}
    for pattern, text in units:
        scale = scale_of(text)
        if scale is None:
            raise UsageFault(
                f"--unit {pattern}={text}: unknown unit; write one of {', '.join(UNITS)}, rad, "
                "..., or a factor and a unit, such as '0.001 rad'"
            )
        found = [name for name in names if fnmatchcase(name, pattern)]
        if not found:
            raise UsageFault(f"--unit: no column {pattern!r}; the table has {', '.join(names)}")
        scales |= dict.fromkeys(found, scale)
    return scales


def _rows(
    table: Table,
    schema: pa.Schema,
    names: list[str],
    scales: dict[str, tuple[float, str]],
    rate: float | None,
) -> Iterator[pa.RecordBatch]:
    row = 0
    for batch in table.batches:
        columns = []
        for name, old, column in zip(names, table.columns, batch.columns, strict=True):
            if name in scales:
                column = doubles(matrix(batch, [old])[0] * scales[name][0])
            columns.append(column)
        if rate is not None:
            columns.insert(0, doubles(np.arange(row, row + batch.num_rows) / rate))
        row += batch.num_rows
        yield pa.RecordBatch.from_arrays(columns, schema=schema)
