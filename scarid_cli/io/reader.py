"""Open a table of any format, and check that it holds what a command needs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from math import isfinite

import numpy as np
import pyarrow as pa

from scarid_cli.errors import bad_data
from scarid_cli.io import schemas
from scarid_cli.io.bytesource import ByteSource, unpacked
from scarid_cli.io.clock import clocked
from scarid_cli.io.remedies import Remedies, Remedy, read_on
from scarid_cli.io.selection import Whole
from scarid_cli.io.table import SEGMENT, Table, cast, remedy_of

# From the columns of a table, those whose values a command reads.
Reads = Callable[[list[str]], Iterable[str]]
Fault = tuple[str, str, str, str]  # the column, what was found, expected, and the remedy
LARGEST = 1e100  # of a value: no robot has such a value, and the product of three does not overflow
FEW = 64  # rows, of which one array of all columns is made faster than one of each
ROW_MARKS = ("t", SEGMENT, "settled")  # columns that every command reads


def open_table(source: ByteSource) -> Table:
    """Read a table, in the format that its first bytes indicate; unpack it first if need be."""
    source = unpacked(source)
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


def checked(
    table: Table,
    kind: str,
    *,
    reads: Reads | None = None,
    regular: bool = True,
    lacking: Callable[[list[str]], Whole] | None = None,
    remedies: Remedies | None = None,
) -> Table:
    """The table, checked to be of a kind: columns, types and units now, values as they arrive.

    The columns that the command `reads` must be numbers, there and finite in every row; by default
    these are the columns that the kind knows. Other columns pass as they are. Rows without a value
    in one of the columns are refused, or left out by `lacking`, made for these columns. The clock
    of a sampled table must be regular, unless `regular` is false; its period [s] is put into the
    metadata. The `remedies` are told with what is refused.
    """
    schema = schemas.load(kind)
    table = conforming(table, kind, reads)
    table = replace(table, meta=replace(table.meta, kind=table.meta.kind or kind))
    columns = _columns_to_check(table, schema, reads)
    if lacking:
        table = lacking(columns).removed(table)
    remedies = remedies or Remedies()
    if not schema.sampled:  # no resampling mends it
        return replace(table, batches=_valued(table, columns, Remedies().value))
    batches = _valued(table, columns, remedies.value)
    return clocked(replace(table, batches=batches), regular=regular, remedy=remedies.clock)


def conforming(table: Table, kind: str, reads: Reads | None = None) -> Table:
    """The table, with the columns, types and units of a kind; whole numbers become doubles."""
    schema = schemas.load(kind)
    _refuse(table, _faults_of_columns(table, schema))
    types = {c: known.type for c in table.columns if (known := schema.field_of(c))}
    types = {**dict.fromkeys(reads(table.columns) if reads else (), pa.float64()), **types}
    _refuse(table, _faults_of_types(table, types))
    typed = pa.schema([f.with_type(types.get(f.name, f.type)) for f in table.schema])
    if typed.equals(table.schema):
        return table
    batches = (cast(batch, typed, table.name) for batch in table.batches)
    return replace(table, schema=typed, batches=batches)


def _columns_to_check(table: Table, schema: schemas.TableSchema, reads: Reads | None) -> list[str]:
    """The columns whose values must be there; in tables without a clock, the required ones."""
    known = {column: field for column in table.columns if (field := schema.field_of(column))}
    if not schema.sampled:
        return [column for column, field in known.items() if field.required]
    if reads is None:
        return list(known)
    wanted = {*reads(table.columns), *(mark for mark in ROW_MARKS if mark in known)}
    return [column for column in table.columns if column in wanted]


def _faults_of_columns(table: Table, schema: schemas.TableSchema) -> Iterator[Fault]:
    for column, count in Counter(table.columns).items():
        if count > 1:
            yield column, f"{count} columns of this name", "one", "rename or drop one of them"
    missing = schema.missing_from(table.columns)
    if missing:
        require(table, [missing], f"{missing}, which {_with_article(schema.title.lower())} has")
    for column in table.columns:
        known, unit = schema.field_of(column), table.unit(column)
        if known and unit and known.units and unit not in known.units:
            yield column, f"unit {unit}", " or ".join(known.units), "convert the column first"


def _faults_of_types(table: Table, types: dict[str, pa.DataType]) -> Iterator[Fault]:
    for field in table.schema:
        if not _same_type(field.type, types.get(field.name, field.type)):
            yield field.name, f"type {field.type}", str(types[field.name]), remedy_of(field.name)


def _refuse(table: Table, faults: Iterator[Fault]) -> None:
    """Refuse a table with any fault; the first one is reported."""
    for column, found, expected, remedy in faults:
        raise bad_data(table.name, found, expected=expected, remedy=remedy, column=column)


def require(table: Table, columns: list[str], expected: str) -> None:
    """Refuse a table that lacks one of these columns."""
    for column in columns:
        if column not in table.columns:
            raise bad_data(
                table.name,
                f"the columns {', '.join(table.columns)}",
                expected=expected,
                remedy=_another_kind(table) or _remedy(column),
                column=column,
            )


def _with_article(title: str) -> str:
    """`a motion`, `an excitation trajectory`, `a table of parameters`."""
    if title.endswith("s"):
        return f"a table of {title}"
    return f"{'an' if title[0] in 'aeiou' else 'a'} {title}"


def _another_kind(table: Table) -> str:
    """What to do with a table that is no log at all."""
    if "estimate" in table.columns:
        return "this is a table of parameters: give the log itself"
    if "q1_ref" in table.columns and not schemas.numbered(table.columns, "q"):
        return "this is a trajectory: follow it with `scarid simulate`, or with the robot"
    return ""


def _remedy(column: str) -> str:
    if column == "parameter":
        return "give the table that `scarid identify` writes"
    if column.startswith(("dq", "ddq")) and not column.endswith("_ref"):
        return "estimate it with `scarid differentiate`"
    if column.endswith("_ref"):
        return "make a trajectory with `scarid trajgen`"
    more = {"t": "; --rate HZ where there is no clock", "tau": "; docs/robots.md for currents"}
    return (
        f"let `scarid convert` find it, or rename yours with `scarid convert --map {column}=NAME` "
        f"(docs/tables.md has all names{more.get(column.rstrip('0123456789'), '')})"
    )


def _same_type(given: pa.DataType, known: pa.DataType) -> bool:
    # Whole numbers stand for themselves in a column of doubles.
    return bool(given == known or (pa.types.is_floating(known) and pa.types.is_integer(given)))


def _valued(table: Table, columns: list[str], remedy: Remedy) -> Iterator[pa.RecordBatch]:
    """Pass batches on; a value of these columns that is missing or not finite is an error."""
    row = 0
    for batch in table.batches:
        for column in () if _sound_at_once(batch, columns) else columns:
            if fault := _fault_of(batch.column(column)):
                at, found, expected = fault
                raise bad_data(
                    table.name,
                    found,
                    expected=expected,
                    remedy=remedy(read_on(batch, table.batches)),
                    row=table.row(row + at + 1),
                    column=column,
                )
        yield batch
        row += batch.num_rows


def _sound_at_once(batch: pa.RecordBatch, columns: list[str]) -> bool:
    """Whether there are few rows, as beside a robot, of which all these columns are sound."""
    found = [batch.column(name) for name in columns] if batch.num_rows <= FEW else []
    if not found or any(x.null_count or not pa.types.is_primitive(x.type) for x in found):
        return False
    values = [x.to_numpy() for x in found if pa.types.is_floating(x.type)]
    return not values or bool(np.abs(np.concatenate(values)).max(initial=0.0) < LARGEST)


def _fault_of(column: pa.Array) -> tuple[int, str, str] | None:
    """The first row without a value, from 0, with what was found and expected; None without one."""
    floating = pa.types.is_floating(column.type)
    expected = "a finite number" if floating else "a value"
    if column.null_count:
        empty = column.is_null().to_numpy(zero_copy_only=False)
        return int(np.argmax(empty)), "no value", expected
    moderate = np.abs(column.to_numpy()) < LARGEST if floating else np.ones(1, dtype=np.bool_)
    if moderate.all():
        return None
    at = int(np.argmin(moderate))
    found = column[at].as_py()
    return at, str(found), f"a number below {LARGEST:g}" if isfinite(found) else expected
