"""Logs in JSON: an object a line, a list of objects, or an object with a list for each column.

Objects inside objects become columns a.b, lists columns a[0], a[1], ... The first row decides which
columns there are; a row may lack values, but has no others.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from itertools import chain, islice
from typing import Any

import pyarrow as pa

from scarid_cli.errors import BadData, bad_data
from scarid_cli.io.bytesource import ByteSource, require_moderate, require_moderate_row
from scarid_cli.io.table import Metadata, Table

ROWS = 4096  # at a time
EXACT = 1 << 53  # from which a double cannot hold every whole number
NESTED = 20  # objects within one another
MEMORY = 10  # bytes of memory for a byte of a document


def is_json(source: ByteSource) -> bool:
    """Whether a file begins as JSON does, and not as CSV whose first cell has a bracket."""
    start = source.peek(64).lstrip(b"\xef\xbb\xbf \t\r\n")
    return start[:1] == b"{" or (start[:1] == b"[" and start[1:].lstrip()[:1] in (b"{", b"["))


def read_json(source: ByteSource) -> Table:
    """A table from JSON."""
    rows = enumerate(_rows(source), start=1)
    first = next(rows, None)
    if first is None:
        raise BadData(f"{source.name}: no rows; is the file empty?")
    columns = dict(_flat(first[1]))
    schema = pa.schema([(name, _type(value)) for name, value in columns.items()])
    return Table(
        source.name, schema, Metadata(), _batches(chain([first], rows), schema, source.name)
    )


def _batches(
    rows: Iterator[tuple[int, Any]], schema: pa.Schema, name: str
) -> Iterator[pa.RecordBatch]:
    known = {*schema.names}
    while block := list(islice(rows, ROWS)):
        found = []
        for number, row in block:
            values = dict(_flat(row))
            if other := sorted({*values} - known):
                raise bad_data(
                    name,
                    f"the key {other[0]}, which the first row lacks",
                    expected="the same keys in each row, or fewer",
                    remedy="export the topics into files of their own",
                    row=number,
                )
            found.append(values)
        yield pa.RecordBatch.from_arrays(
            [_column(found, field, block[0][0], name) for field in schema], schema=schema
        )


def _column(rows: list[dict[str, Any]], field: pa.Field, first: int, name: str) -> pa.Array:
    values = [row.get(field.name) for row in rows]
    try:
        return pa.array(values, field.type)
    except (pa.ArrowInvalid, pa.ArrowTypeError, OverflowError):
        at = next(k for k, value in enumerate(values) if not _fits(value, field.type))
        raise bad_data(
            name,
            repr(values[at])[:40],
            expected="a number" if pa.types.is_floating(field.type) else f"a value of {field.type}",
            remedy="correct or remove the row",
            row=first + at,
            column=field.name,
        ) from None


def _fits(value: Any, kind: pa.DataType) -> bool:
    try:
        pa.array([value], kind)
    except (pa.ArrowInvalid, pa.ArrowTypeError, OverflowError):
        return False
    return True


def _type(value: Any) -> pa.DataType:
    if isinstance(value, str):
        return pa.string()
    return pa.int64() if isinstance(value, int) and abs(value) > EXACT else pa.float64()


def _flat(value: Any, name: str = "", depth: int = 0) -> Iterator[tuple[str, Any]]:
    """The values inside of it by name; true and false are 1 and 0."""
    if depth > NESTED:
        raise BadData(f"{name[:40]}: objects within objects, {NESTED} times; write them flat")
    if isinstance(value, dict):
        for key, own in value.items():
            yield from _flat(own, f"{name}.{key}" if name else str(key), depth + 1)
    elif isinstance(value, list):
        for k, own in enumerate(value):
            yield from _flat(own, f"{name}[{k}]", depth + 1)
    else:
        yield name, float(value) if isinstance(value, bool) else value


def _rows(source: ByteSource) -> Iterator[Any]:
    lines = _lines(source)
    first = next(lines, b"")
    try:
        row = json.loads(first)
    except ValueError:
        row = None
    if isinstance(row, dict) and not _is_columns(row):
        yield row
        for number, line in enumerate(lines, start=2):
            yield _parsed(line, source.name, number)
        return
    yield from _of_document(_whole(first, lines, source.name), source.name)


def _parsed(line: bytes, name: str, row: int) -> Any:
    try:
        value = json.loads(line)
    except (ValueError, RecursionError):
        value = None
    if not isinstance(value, dict):
        raise bad_data(
            name,
            repr(line[:40].decode(errors="replace")),
            expected="an object of JSON in each line",
            remedy="correct or remove the line",
            row=row,
        )
    return value


def _whole(first: bytes, lines: Iterable[bytes], name: str) -> Any:
    held, size = [first], len(first)
    for line in lines:
        held.append(line)
        size += len(line)
        require_moderate(name, MEMORY * size)
    try:
        return json.loads(b"\n".join(held))
    except (ValueError, RecursionError) as error:
        raise BadData(f"{name}: not JSON ({error}); is the file complete?") from None


def _of_document(document: Any, name: str) -> Iterator[Any]:
    """The rows of a document, which may stand in its only list of objects."""
    if isinstance(document, dict) and _is_columns(document):
        yield from (
            dict(zip(document, row, strict=True)) for row in zip(*document.values(), strict=True)
        )
        return
    lists = [document] if isinstance(document, list) else []
    if isinstance(document, dict):
        lists = [
            x for x in document.values() if isinstance(x, list) and x and isinstance(x[0], dict)
        ]
    if len(lists) != 1 or not all(isinstance(row, dict) for row in lists[0]):
        keys = ", ".join(map(str, list(document)[:5])) if isinstance(document, dict) else "a list"
        raise BadData(
            f"{name}: JSON with {keys}, but no rows; write an object for each sample, "
            "or a list for each column"
        )
    yield from lists[0]


def _is_columns(document: dict[str, Any]) -> bool:
    """Whether each value is a column: lists of one length, more rows than a vector has joints."""
    lengths = {len(x) if isinstance(x, list) else 0 for x in document.values()}
    return len(lengths) == 1 and min(lengths) > NESTED


def _lines(source: ByteSource) -> Iterator[bytes]:
    """The lines that are not empty."""
    held = b""
    while data := source.read_some():
        *lines, held = (held + data).split(b"\n")
        require_moderate_row(source.name, len(held))
        yield from (line.removeprefix(b"\xef\xbb\xbf") for line in lines if line.strip())
    if held.strip():
        yield held
