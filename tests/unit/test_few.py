"""A few rows at a time: of CSV, against pyarrow, and of an Arrow stream that waits in a pipe."""

from __future__ import annotations

import os

import pyarrow as pa
import pyarrow.csv as pacsv
from hypothesis import example, given, settings
from hypothesis import strategies as st

from scarid_cli.io.bytesource import ByteSource
from scarid_cli.io.csvio import _parsed
from scarid_cli.io.few import Few
from scarid_cli.io.reader import open_table
from scarid_cli.io.table import doubles, integers

SCHEMA = pa.schema([("t", pa.float64()), ("segment", pa.int64()), ("q1", pa.float64())])
FEW = Few(SCHEMA)
CELL = st.one_of(
    st.floats().map(repr),
    st.floats(-1e3, 1e3).map(repr),
    st.integers(-(1 << 65), 1 << 65).map(str),
    st.text("0123456789-.eE+_ x", max_size=12),
)
ROW = st.tuples(CELL, CELL, CELL).map(",".join)
BLOCK = st.tuples(st.lists(ROW, min_size=1, max_size=4), st.sampled_from(["\n", "\r\n", "\n\n"]))


@settings(max_examples=1000)
@given(BLOCK)
@example((["1.,7,.5"], "\n"))
@example((["-.5,-0,1e400"], "\n"))
@example((["1e-400,007,00.5"], "\n"))
@example((["1e5,9223372036854775808,2"], "\n"))
def test_what_is_read_is_what_pyarrow_reads(block: tuple[list[str], str]) -> None:
    rows, end = block
    data = "".join(f"{row}{end}" for row in rows).encode()
    if (found := FEW.parsed(data)) is not None:
        assert pa.Table.from_batches([found]).equals(_parsed(data, SCHEMA))


def test_rows_of_numbers_are_read_here() -> None:
    for row in ("0.005,0,-1.25e-05", "12,3,0", "-0.1,0,5e+3"):
        assert (FEW.parsed(f"{row}\n".encode()) is None) == ("+" in row)


VALUES = st.one_of(st.floats(), st.floats(-10, 10), st.floats(-1e-3, 1e-3), st.integers(-99, 99))


@settings(max_examples=1000)
@given(st.lists(st.tuples(VALUES, st.integers(-(1 << 63), (1 << 63) - 1), VALUES), min_size=1))
@example([(1e10, 0, 9999999999.0), (1e-6, 0, 9.999999e-7), (-0.0, 0, 0.0), (1e-4, 1, 99999e-9)])
def test_what_is_written_is_what_pyarrow_writes(rows: list[tuple[float, int, float]]) -> None:
    t, segment, q = zip(*rows, strict=True)
    columns = [doubles(t), integers(segment), doubles(q)]
    for part in (slice(None), slice(0, 1)):
        batch = pa.RecordBatch.from_arrays([x[part] for x in columns], schema=SCHEMA)
        buffer = pa.BufferOutputStream()
        options = pacsv.WriteOptions(include_header=False, quoting_style="none")
        pacsv.write_csv(batch, buffer, options)
        assert FEW.text(batch) in (None, buffer.getvalue().to_pybytes())


def test_what_robots_log_is_written_here() -> None:
    row = [doubles([x]) for x in (1732800000.005, -0.25, 3e-5, 1e-12, 0.0, 120.0)]
    batch = pa.RecordBatch.from_arrays(row, names=list("abcdef"))
    assert Few(batch.schema).text(batch) == b"1732800000.005,-0.25,0.00003,1e-12,0,120\n"


@settings(max_examples=50)
@given(st.lists(st.integers(0, 3), min_size=1, max_size=6))
def test_batches_that_wait_are_read_together(sizes: list[int]) -> None:
    """Whether they have rows or not; from a pipe that is closed."""
    batches = [
        pa.RecordBatch.from_arrays([doubles([float(k)] * size)], names=["t"])
        for k, size in enumerate(sizes)
    ]
    reader, writer = os.pipe()
    with os.fdopen(writer, "wb") as pipe, pa.ipc.new_stream(pipe, batches[0].schema) as stream:
        for batch in batches:
            stream.write_batch(batch)
    source = ByteSource(reader, "pipe")
    found = list(open_table(source).batches)
    source.close()
    assert pa.Table.from_batches(found).equals(pa.Table.from_batches(batches))
    assert len(found) <= 2  # the first alone, where nothing tells yet that this is a pipe
