"""Logs in JSON: an object a line, a list of objects, or an object with a list for each column.

pandas writes columns and rows in forms of its own, which are read as well. Objects inside objects
become columns a.b, lists columns a[0], a[1], ... The first row decides which columns there are; a
row may lack values, but has no others.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence
from itertools import chain, islice
from typing import Any

import pyarrow as pa

from scarid_cli.errors import BadData, bad_data
from scarid_cli.io.bytesource import ByteSource, require_moderate, require_moderate_row
from scarid_cli.io.table import Metadata, Table

ROWS = 4096  # at a time
EXACT = 1 << 53  # from which a double cannot hold every whole number
NESTED = 20  # objects within one another
WIDEST = 10_000  # values in a row
MEMORY = 10  # bytes of memory for a byte of a document


def is_json(source: ByteSource) -> bool:
    """Whether a file begins as JSON does, and not as CSV whose first cell has a bracket."""
    start = source.peek(64).lstrip(b"\xef\xbb\xbf \t\r\n")
    return start[:1] == b"{" or (start[:1] == b"[" and start[1:].lstrip()[:1] in (b"{", b"["))


def read_json(source: ByteSource) -> Table:
    """A table from JSON."""
    return table_of_rows(_rows(source), source.name)


def table_of_rows(objects: Iterable[Any], name: str) -> Table:
    """A table with a row for each object, and the columns of the first one."""
    rows = enumerate(objects, start=1)
    first = next(rows, None)
    if first is None:
        raise BadData(f"{name}: no rows; is the file empty?")
    columns = dict(islice(_flat(first[1]), WIDEST + 1))
    if len(columns) > WIDEST:
        raise BadData(
            f"{name}: more than {WIDEST:,} values in the first row; write an object for each "
            "sample, or a list for each column"
        )
    schema = pa.schema([(column, _type(value)) for column, value in columns.items()])
    return Table(name, schema, Metadata(), _batches(chain([first], rows), schema, name))


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
    lines = lines_of(source)
    first = next(lines, b"")
    try:
        row = json.loads(first)
    except ValueError:
        row = None
    whole = not isinstance(row, dict)
    if isinstance(row, dict) and (_columns(row) or len(_objects(row)) > NESTED):
        second = next(lines, None)  # a message of a robot with many motors is followed by others
        whole, lines = second is None, chain([] if second is None else [second], lines)
    if whole:
        yield from _of_document(_whole(first, lines, source.name), source.name)
        return
    yield row
    for number, line in enumerate(lines, start=2):
        yield _parsed(line, source.name, number)


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
    rows = document if isinstance(document, list) else _objects(document)
    if not rows and isinstance(document, dict) and (columns := _columns(document)):
        yield from (
            dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)
        )
        return
    if not rows or not all(isinstance(row, dict) for row in rows):
        keys = ", ".join(map(str, list(document)[:5])) if isinstance(document, dict) else "a list"
        raise BadData(
            f"{name}: JSON with {keys}, but no rows; write an object for each sample, "
            "or a list for each column"
        )
    yield from rows


def _objects(document: Any) -> list[Any]:
    """The only list of objects in a document, or those that it has under numbers; else none."""
    if not isinstance(document, dict):
        return []
    if document and all(key.isdecimal() and isinstance(x, dict) for key, x in document.items()):
        return [*document.values()]
    lists = [x for x in document.values() if isinstance(x, list) and x and isinstance(x[0], dict)]
    return lists[0] if len(lists) == 1 and not _of_parts(lists[0]) else []


def _columns(document: dict[str, Any]) -> dict[str, Sequence[Any]]:
    """The columns of an object that has one list for each, maybe in objects; empty if it has none.

    The lists have one length, more rows than a vector has joints. Single values beside them are
    the same in each row. pandas writes an object of rows for each column, or the rows under `data`
    and their names under `columns`.
    """
    if {*document} - {"index"} == {"columns", "data"}:
        names, rows = document["columns"], document["data"]
        lists = isinstance(names, list) and isinstance(rows, list)
        if lists and all(isinstance(x, list) and len(x) == len(names) for x in rows):
            return dict(zip(map(str, names), zip(*rows, strict=True), strict=True))
    found = dict(_lists(document))
    rows = {len(x) for x in found.values() if isinstance(x, list)}
    if len(rows) != 1 or min(rows) <= NESTED:
        return {}
    return {key: x if isinstance(x, list) else [x] * min(rows) for key, x in found.items()}


def _lists(value: dict[str, Any], name: str = "", depth: int = 0) -> Iterator[tuple[str, Any]]:
    """The values inside of it by name, of which lists, and objects of numbered rows, are whole.

    A few long lists in one, as of a matrix with a row for each joint, are columns of their own, and
    so are those of a few objects, as of one for each joint, which may have a name.
    """
    for key, own in value.items():
        path = f"{name}.{key}" if name else str(key)
        if depth < NESTED and _of_parts(own):
            for k, part in enumerate(own):
                called = part.get("name")
                inside = f"{path}.{called}" if isinstance(called, str) else f"{path}[{k}]"
                yield from _lists({x: y for x, y in part.items() if x != "name"}, inside, depth + 1)
        elif _few_long(own):
            yield from ((f"{path}[{k}]", column) for k, column in enumerate(own))
        elif not isinstance(own, dict):
            yield path, own
        elif len(own) > NESTED and all(row.isdecimal() for row in own):
            yield path, [*own.values()]
        elif depth < NESTED:
            yield from _lists(own, path, depth + 1)


def _of_parts(value: Any) -> bool:
    """Whether a list has a few objects with long lists, as of one for each joint."""
    few = isinstance(value, list) and 0 < len(value) <= NESTED
    return few and all(
        isinstance(part, dict)
        and any(isinstance(x, list) and len(x) > NESTED for x in part.values())
        for part in value
    )


def _few_long(value: Any) -> bool:
    """Whether a list has more values in each of its lists than lists."""
    inner = isinstance(value, list) and len(value) <= NESTED and bool(value)
    return inner and all(isinstance(x, list) and len(x) > NESTED for x in value)


def lines_of(source: ByteSource) -> Iterator[bytes]:
    """The lines that are not empty."""
    held = b""
    while data := source.read_some():
        *lines, held = (held + data).split(b"\n")
        require_moderate_row(source.name, len(held))
        yield from (line.removeprefix(b"\xef\xbb\xbf") for line in lines if line.strip())
    if held.strip():
        yield held
