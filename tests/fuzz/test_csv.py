"""Generated and mutated CSV: a table, or an error of ours; never another exception, or a hang."""

from __future__ import annotations

import pyarrow as pa
from fuzz.support import NUMBERS, fuzzed, mutated, understood, written
from hypothesis import example, given
from hypothesis import strategies as st

from scarid_cli.io.bytesource import ByteSource
from scarid_cli.io.csvio import CsvWriter
from scarid_cli.io.foreign import TranslatedCsv
from scarid_cli.io.notation import notation_of
from scarid_cli.io.reader import checked, open_table
from scarid_cli.stages.info import described

LOG = "t,q1,tau1,segment,note\n" + "".join(f"{k / 100},{k},{k * 0.5},0,a{k}\n" for k in range(12))
PIECES = [
    *(number.encode() for number in NUMBERS),
    *(b'"', b'""', b",", b";", b"\t", b"\r", b"\n", b"\r\n", b"#", b"\0", b"\xff", b"\xef\xbb\xbf"),
    *(
        b"t",
        b"q1",
        b"segment",
        b"settled",
        b" ",
        b"%",
        b"joint",
        b"9" * 30,
        b"1,5;2,5\n",
        b"q1 [deg]",
    ),
]
logs = mutated(LOG.encode(), PIECES) | st.binary(max_size=200)
logs |= st.lists(st.sampled_from(PIECES), max_size=40).map(b"".join)


def columns(content: bytes, through: str = "") -> dict[str, list[object]] | None:
    """The columns of a log as `info`, `convert` or `filter` read it; None if it is refused."""

    def read() -> dict[str, list[object]]:
        source = ByteSource.open(name)
        try:
            if through == "convert":
                notation = notation_of(source, None, by_name=False)
                table = open_table(source if notation.plain else TranslatedCsv(source, notation))
            else:
                table = open_table(source)
            if through == "filter":
                table = checked(table, "measurement")
            batches = list(table.batches)
        finally:
            source.close()
        return pa.Table.from_batches(batches, table.schema).to_pydict()

    with written(content) as name:
        return understood(read)


@fuzzed()
@given(logs, st.sampled_from(["", "convert", "filter"]))
@example(b'\n\x00"\n\x00', "")
@example(b"\xef\xbb\xbf\n\x00\n\x00\n", "")
@example(b"\n\x80", "")
def test_a_log_is_a_table_or_bad_data(content: bytes, through: str) -> None:
    columns(content, through)


@fuzzed()
@given(logs)
def test_any_table_is_described(content: bytes) -> None:
    def read() -> None:
        source = ByteSource.open(name)
        try:
            found = described(open_table(source))
            assert list(found.lines)
            assert found.document
        finally:
            source.close()

    with written(content) as name:
        understood(read)


names = st.lists(st.text(max_size=4) | st.sampled_from(["#a", "t", " a"]), min_size=1, max_size=4)
cells = st.floats(allow_nan=False, allow_infinity=False) | st.none()


@fuzzed()
@given(names, st.lists(st.lists(cells, min_size=4, max_size=4), min_size=1, max_size=4))
@example(["a"], [[None], [1.0]])
@example(["a"], [[1.0], [None], [2.0]])
def test_what_is_written_is_read_back_or_refused(
    names: list[str], rows: list[list[float | None]]
) -> None:
    """Numbers to the last bit, under any names, also in a single column with empty cells."""
    held = {name: [row[i] for row in rows] for i, name in enumerate(dict.fromkeys(names))}
    batch = pa.record_batch({name: pa.array(values, pa.float64()) for name, values in held.items()})

    def out() -> list[bytes]:
        parts: list[bytes] = []
        writer = CsvWriter(parts.append, batch.schema)
        writer.write(batch)
        return parts

    parts = understood(out)
    if parts is not None:
        found = columns(b"".join(parts))
        assert found is None or {n: list(map(_number, v)) for n, v in found.items()} == held


def _number(value: object) -> object:
    """A column whose first cell is empty holds text."""
    if isinstance(value, str):
        return float(value) if value else None
    return value
