"""Open a table of any format, and check that it holds what a command needs."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace

import numpy as np
import pyarrow as pa

from scarid_cli.errors import bad_data
from scarid_cli.io import schemas
from scarid_cli.io.bytesource import ByteSource
from scarid_cli.io.clock import clocked
from scarid_cli.io.table import SEGMENT, Table, cast

# From the columns of a table, those whose values a command reads.
Reads = Callable[[list[str]], Iterable[str]]
ROW_MARKS = ("t", SEGMENT, "settled")  # columns that every command reads


def open_table(source: ByteSource) -> Table:
    """Read a table; its first bytes tell the format."""
    start = source.peek(8)
    if not start.startswith((b"PAR1", b"ARROW1", b"\xff\xff\xff\xff")):
        from scarid_cli.io.csvio import read_csv

        return read_csv(source)
    from scarid_cli.io import arrowio

    if start.startswith(b"PAR1"):
        return arrowio.read_parquet(source)
    if start.startswith(b"ARROW1"):
        return arrowio.read_file(source)
    return arrowio.read_stream(source)


def checked(table: Table, kind: str, *, reads: Reads | None = None, regular: bool = True) -> Table:
    """The table, checked to be of a kind: columns, types and units now, values as they arrive.

    The values of the columns that the command `reads` must be there and be finite, by default
    those of every column that the kind knows; other columns pass as they are. The clock of a
    sampled table must be regular, unless `regular` is false; its period [s] is put into the
    metadata.
    """
    schema = schemas.load(kind)
    table = conforming(table, kind)
    meta = replace(table.meta, kind=table.meta.kind or kind)
    batches = _valued(table, _columns_to_check(table, schema, reads))
    if schema.sampled:
        batches, period = clocked(batches, table.name, regular=regular)
        meta = replace(meta, period=period) if regular else meta
    return replace(table, meta=meta, batches=batches)


def conforming(table: Table, kind: str) -> Table:
    """The table, with the columns, types and units of a kind; whole numbers become doubles."""
    schema = schemas.load(kind)
    _check_columns(table, schema)
    _check_units(table, schema)
    known = {column: schema.field_of(column) for column in table.columns}
    typed = pa.schema(
        [f.with_type(field.type) if (field := known[f.name]) else f for f in table.schema]
    )
    if typed.equals(table.schema):
        return table
    return replace(table, schema=typed, batches=(cast(batch, typed) for batch in table.batches))


def _columns_to_check(table: Table, schema: schemas.TableSchema, reads: Reads | None) -> list[str]:
    """The columns whose values must be there; in tables without a clock, the required ones."""
    known = {column: schema.field_of(column) for column in table.columns}
    fields = {column: field for column, field in known.items() if field}
    if not schema.sampled:
        return [column for column, field in fields.items() if field.required]
    wanted = {*ROW_MARKS, *reads(table.columns)} if reads else set(fields)
    return [column for column in table.columns if column in wanted and column in fields]


def _check_columns(table: Table, schema: schemas.TableSchema) -> None:
    for column in table.columns:
        if table.columns.count(column) > 1:
            raise bad_data(
                table.name,
                f"{table.columns.count(column)} columns of this name",
                expected="one",
                remedy="rename or drop one of them",
                column=column,
            )
    missing = schema.missing_from(table.columns)
    if missing:
        require(table, [missing], f"a {schema.title.lower()} with this one")
    for field in table.schema:
        known = schema.field_of(field.name)
        if known and not _same_type(field.type, known.type):
            raise bad_data(
                table.name,
                f"type {field.type}",
                expected=str(known.type),
                remedy="convert the column where the table is made",
                column=field.name,
            )


def require(table: Table, columns: list[str], expected: str) -> None:
    """Refuse a table that lacks one of these columns."""
    for column in columns:
        if column not in table.columns:
            raise bad_data(
                table.name,
                f"the columns {', '.join(table.columns)}",
                expected=expected,
                remedy=_remedy(column),
                column=column,
            )


def _remedy(column: str) -> str:
    if column.startswith(("dq", "ddq")) and not column.endswith("_ref"):
        return "estimate it with `scarid differentiate`"
    if column.endswith("_ref"):
        return "make a trajectory with `scarid trajgen`"
    return "name the columns as the schema does (see docs/tables.md)"


def _same_type(given: pa.DataType, known: pa.DataType) -> bool:
    # Whole numbers stand for themselves in a column of doubles.
    return bool(given == known or (pa.types.is_floating(known) and pa.types.is_integer(given)))


def _check_units(table: Table, schema: schemas.TableSchema) -> None:
    for column in table.columns:
        known = schema.field_of(column)
        unit = table.unit(column)
        if known and unit and known.units and unit not in known.units:
            raise bad_data(
                table.name,
                f"unit {unit}",
                expected=" or ".join(known.units),
                remedy="convert the column first",
                column=column,
            )


def _valued(table: Table, columns: list[str]) -> Iterator[pa.RecordBatch]:
    """Pass batches on; a value of these columns that is missing or not finite is an error."""
    row = 0
    for batch in table.batches:
        for column in columns:
            _check_values(batch.column(column), table.name, column, row)
        yield batch
        row += batch.num_rows


def _check_values(column: pa.Array, name: str, column_name: str, row: int) -> None:
    bad: int | None = None
    found = "an empty cell"
    if column.null_count:
        bad = int(np.argmax(column.is_null().to_numpy(zero_copy_only=False)))
    elif pa.types.is_floating(column.type):
        finite = np.isfinite(column.to_numpy())
        if not finite.all():
            bad = int(np.argmin(finite))
            found = str(column[bad].as_py())
    if bad is not None:
        raise bad_data(
            name,
            found,
            expected="a finite number" if pa.types.is_floating(column.type) else "a value",
            remedy="correct or remove the row",
            row=row + bad + 1,
            column=column_name,
        )
