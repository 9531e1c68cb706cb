"""Arrow of our own writing: every value comes back, other programs read it, damage is refused."""

from __future__ import annotations

import contextlib
import re
import zlib
from itertools import pairwise
from typing import Any

import pyarrow as pa
import pytest
from fuzz.support import fuzzed, mutated, understood, written
from hypothesis import given
from hypothesis import strategies as st

from scarid_cli.errors import BadData
from scarid_cli.io.bytesource import ByteSource
from scarid_cli.io.outgoing import FileWriter, StreamWriter
from scarid_cli.io.reader import open_table
from scarid_cli.io.table import Metadata, number

WRITERS = {"arrows": StreamWriter, "arrow": FileWriter}
KINDS: dict[str, tuple[pa.DataType, st.SearchStrategy[Any]]] = {
    "number": (pa.float64(), st.floats(allow_nan=False)),
    "whole": (pa.int64(), st.integers(-(2**63), 2**63 - 1)),
    "text": (pa.string(), st.text(st.characters(exclude_categories=["Cs"]), max_size=9)),
    "flag": (pa.bool_(), st.booleans()),
    "list": (pa.list_(pa.int16()), st.lists(st.integers(-9, 9), max_size=3)),
    "structure": (pa.struct({"a": pa.string()}), st.fixed_dictionaries({"a": st.text("ab")})),
    "folded": (pa.list_(pa.dictionary(pa.int8(), pa.string())), st.lists(st.just("a"), max_size=2)),
    "bytes": (pa.binary(), st.binary(max_size=5)),
}
CONTINUED = b"\xff" * 4  # begins a message; its length follows
DIGITS = re.compile(rb"\x08\0\0\0([0-9a-f]{8})\0")  # a text of eight digits in a header


@st.composite
def batches(draw: st.DrawFn) -> list[pa.RecordBatch]:
    """Slices of batches of one table, with a metadata document and a unit."""
    names = draw(st.lists(st.sampled_from(sorted(KINDS)), max_size=4, unique=True))
    schema = pa.schema([number("t", "s"), *(pa.field(name, KINDS[name][0]) for name in names)])
    schema = schema.with_metadata({b"scarid": Metadata(robot="arm").to_json()})
    found = []
    for _ in range(draw(st.integers(0, 3))):
        rows = draw(st.integers(0, 20))
        columns = [pa.array([float(i) for i in range(rows)])]
        for name in names:
            kind, values = KINDS[name]
            cells = st.lists(st.none() | values, min_size=rows, max_size=rows)
            columns.append(pa.array(draw(cells), kind))
        start = draw(st.integers(0, rows))
        batch = pa.RecordBatch.from_arrays(columns, schema=schema)
        found.append(batch.slice(start, draw(st.integers(0, rows - start))))
    return found or [pa.RecordBatch.from_pylist([], schema)]


def as_written(ending: str, given: list[pa.RecordBatch]) -> bytes:
    """A table of our own writing."""
    parts: list[bytes] = []
    writer = WRITERS[ending](lambda data: parts.append(bytes(data)), given[0].schema)
    for batch in given:
        writer.write(batch)
    writer.close()
    return b"".join(parts)


def content(path: str) -> tuple[Any, ...]:
    """All that a command gets of a table."""
    source = ByteSource.open(path)
    try:
        table = open_table(source)
        rows = pa.Table.from_batches(list(table.batches), table.schema)
    finally:
        source.close()
    fields = [(f.name, str(f.type), f.metadata) for f in table.schema]
    return fields, table.meta, rows.to_pylist()


def read(data: bytes) -> tuple[Any, ...]:
    with written(data) as path:
        return content(path)


def of_pyarrow(data: bytes) -> pa.Table:
    """The table as pyarrow reads it."""
    file = data.startswith(b"ARROW1")
    return (pa.ipc.open_file if file else pa.ipc.open_stream)(data).read_all()


@pytest.mark.parametrize("ending", WRITERS)
@fuzzed()
@given(batches())
def test_what_was_written_is_read_here_and_by_pyarrow(
    ending: str, given: list[pa.RecordBatch]
) -> None:
    data, table = as_written(ending, given), pa.Table.from_batches(given)
    fields, meta, rows = read(data)
    assert of_pyarrow(data).equals(table, check_metadata=True)
    assert rows == table.to_pylist()
    assert (meta.robot, fields[0]) == ("arm", ("t", "double", {b"unit": b"s"}))


@pytest.mark.parametrize("ending", WRITERS)
@fuzzed()
@given(batches(), st.data())
def test_a_flipped_bit_is_refused_or_changes_nothing(
    ending: str, given: list[pa.RecordBatch], data: st.DataObject
) -> None:
    right = as_written(ending, given)
    place = data.draw(st.integers(0, len(right) - 1))
    bad = bytearray(right)
    bad[place] ^= 1 << data.draw(st.integers(0, 7))
    found = understood(lambda: read(bytes(bad)))
    assert found is None or found == read(right)


def is_refused(data: bytes) -> None:
    with written(data) as path, pytest.raises(BadData):
        content(path)


LOG = [pa.record_batch({"t": [k * 0.5, 1.0], "q1": [float(k), 2.0]}) for k in range(4)]


@pytest.mark.parametrize("ending", WRITERS)
def test_each_flipped_bit_of_the_marks_and_lengths_is_refused(ending: str) -> None:
    right = as_written(ending, LOG)
    for mark in re.finditer(CONTINUED, right):
        for bit in range(8 * 2 * len(CONTINUED)):
            bad = bytearray(right)
            bad[mark.start() + bit // 8] ^= 1 << bit % 8
            is_refused(bytes(bad))


def messages(stream: bytes) -> list[bytes]:
    """The messages of a stream, as Arrow's reader divides it; the end mark is the last one."""
    reader, places = pa.BufferReader(stream), [0]
    with contextlib.suppress(EOFError):
        while pa.ipc.read_message(reader):
            places.append(reader.tell())
    return [stream[a:b] for a, b in pairwise([*places, len(stream)])]


def test_lost_repeated_and_exchanged_batches_are_refused() -> None:
    schema, a, b, c, d, last, end = messages(as_written("arrows", LOG))
    assert (
        read(b"".join([schema, a, b, c, d, last, end]))[2] == pa.Table.from_batches(LOG).to_pylist()
    )
    for order in ([b, c, d, last], [a, c, d, last], [a, b, c, last], [a, a, b, c, d, last],
                  [b, a, c, d, last], [a, b, c, d], [a, b], [last], [last, a, b, c, d, last],
                  [end, a, b, c, d, last]):  # fmt: skip
        is_refused(b"".join([schema, *order, end]))


def test_names_units_and_metadata_are_covered_by_the_checksum() -> None:
    given = [batch.replace_schema_metadata({b"scarid": b'{"history":[]}'}) for batch in LOG]
    for ending in WRITERS:
        right = as_written(ending, given)
        is_refused(right.replace(b"q1", b"q2"))
        is_refused(right.replace(b'{"history":[]}', b'{"history":[] '))


def test_the_checksum_is_the_crc_of_all_bytes_up_to_the_end_of_the_batch() -> None:
    stream = as_written("arrows", LOG)
    blank, end = bytearray(stream), 0
    for message in messages(stream):
        start, end = end, end + len(message)
        if b"scarid.crc32" in message:
            digits = DIGITS.search(stream, start)
            assert digits
            blank[slice(*digits.span(1))] = b"0" * 8
            assert int(digits[1], 16) == zlib.crc32(blank[:end])
    assert blank.count(b"0" * 8) == len(LOG) + 1


@pytest.mark.parametrize("ending", WRITERS)
def test_a_copy_by_another_program_has_no_checksums_and_is_read(ending: str) -> None:
    table = of_pyarrow(as_written(ending, LOG)).slice(1, 4)
    sink = pa.BufferOutputStream()
    with (pa.ipc.new_stream if ending == "arrows" else pa.ipc.new_file)(sink, table.schema) as copy:
        copy.write_table(table)
    assert read(sink.getvalue().to_pybytes())[2] == table.to_pylist()


@pytest.mark.parametrize("ending", WRITERS)
@fuzzed()
@given(st.data())
def test_mutated_arrow_is_refused_or_gives_the_same_rows(ending: str, data: st.DataObject) -> None:
    right = as_written(ending, LOG)
    start = len(CONTINUED) if ending == "arrows" else len(b"ARROW1")  # by which it is known
    changed = data.draw(mutated(right[start:], [bytes(64), CONTINUED, b"\0" * 4]))
    found = understood(lambda: read(right[:start] + changed))
    assert found is None or found == read(right)
