"""CSV (RFC 4180), read and written as rows arrive; numbers are exact in both directions."""

from __future__ import annotations

import csv
import io
import re
import shlex
from collections import Counter
from collections.abc import Callable, Iterator
from itertools import chain

import pyarrow as pa
import pyarrow.csv as pacsv

from scarid_cli.errors import BadData, ForeignLog, bad_data, cut_short
from scarid_cli.io.bytesource import ByteSource, require_moderate_row
from scarid_cli.io.carried import Carried, facts_of
from scarid_cli.io.cells import MISSING, NUMERIC, csv_text, decoded
from scarid_cli.io.few import Few
from scarid_cli.io.schemas import column_type
from scarid_cli.io.stop import STOP
from scarid_cli.io.table import Metadata, Table

pa.enable_signal_handlers(False)  # noqa: FBT003 (its own would cancel the reading of a block)

# CSV has no end mark: a command that fails after its first rows ends its table with this line, so
# that the next command does not mistake a short table for a complete one.
CUT = b"# scarid: the table ends here because the stage that wrote it failed\n"

BOM = "\N{ZERO WIDTH NO-BREAK SPACE}"  # at the start of a text of Windows

KEY = re.compile(rb"[A-Za-z_]\w*:")  # alone in a line
JSON = (b'{"', b"[{", b"[[")  # how a file of JSON begins

# A date, or a time with its unit, where a number of seconds is expected.
DATED = re.compile(r"\s*((\d+ days?,? +)?\d+[-/.:]\d+[-/.:]\d|[\d.]+ *[a-z]+\s*$)")
INDEX = "index"  # a first column without a name, which pandas writes


PICKLE = "a pickle, which can run any program: save the arrays with numpy.savez, or as CSV"
# How files of other formats begin, and what to do with them.
OTHERS = {
    b"\x89HDF": "an HDF5 file: call it NAME.h5 and read it with `scarid convert`",
    b"\x93NUMPY": "an array of NumPy: call it NAME.npy and read it with `scarid convert`",
    b"PK\3\4": "a workbook or another archive: save the sheet as CSV, or unpack it",
    b"\xd0\xcf\x11\xe0": "a workbook of Excel: save the sheet as CSV",
    **{bytes((0x80, version)): PICKLE for version in range(2, 6)},
    b"BZh": "compressed by bzip2: unpack it with `bunzip2`",
    b"\xfd7zXZ": "compressed by xz: unpack it with `unxz`",
    b"\x28\xb5\x2f\xfd": "compressed by zstd: unpack it with `unzstd`",
    b"TDSm": "a TDMS file of LabVIEW: export it as CSV",
    b"ULog": "a log of PX4: export its topics as CSV",
}
MARKUP = re.compile(rb"\s*<[!?a-zA-Z]")


def read_csv(source: ByteSource) -> Table:
    """A table from CSV. Columns that a schema knows have the type of that schema.

    Any other column holds numbers if its first value is a number, and text otherwise. The first
    row alone decides, so that the type does not depend on how the rows arrive.
    """
    try:
        return _table(source)
    except csv.Error:
        raise _not_a_table(source.name, b"") from None


def _not_a_table(name: str, start: bytes) -> BadData:
    from scarid_cli.io.bags import BEGINNINGS  # neither is needed otherwise
    from scarid_cli.io.foreign import ARCHIVES

    if name.lower().endswith((*ARCHIVES, *BEGINNINGS.values())):
        return ForeignLog(name)
    known = (text for mark, text in OTHERS.items() if start.startswith(mark))
    return BadData(f"{name}: {next(known, 'neither CSV nor Parquet nor Arrow; is it a table?')}")


def _refuse_documents(header: bytes, name: str) -> None:
    """Refuse JSON, and the YAML of printed messages, whose first line is a key."""
    json = header.startswith(JSON) or header.strip() in (b"{", b"[")
    if json or KEY.fullmatch(header.strip()):
        raise ForeignLog(name, "JSON" if json else "YAML")


def _table(source: ByteSource) -> Table:
    lines = _complete_lines(source)
    first = next(lines, b"")
    if first.startswith(tuple(OTHERS)):
        raise _not_a_table(source.name, first)
    if MARKUP.match(first):
        raise BadData(f"{source.name}: HTML or XML, and no table; was an error page downloaded?")
    while not (header_end := _header_end(first)) and (more := next(lines, None)):
        first = more
    if not header_end:
        raise bad_data(
            source.name,
            "no rows",
            expected="a CSV header",
            remedy="is the file empty, or did the previous command fail?",
        )
    _refuse_documents(first[:header_end], source.name)
    names, repeated = _numbered(_header(first, header_end, source.name))
    header = first[:header_end].rstrip(b"\r\n").rpartition(b"\n")[2].removeprefix(BOM.encode())
    lines = _without_headers(chain([first[header_end:]], lines), header)
    body = next(lines)
    while not body.strip() and (more := next(lines, None)):
        body = more
    row = _first_row(names, body)
    schema = pa.schema(list(zip(names, _types(row), strict=True)))
    batches = _batches(body, lines, schema, source.name)
    batches = _without_repeated(batches, repeated, source.name) if repeated else batches
    extra, carried = facts_of(row)
    kept = [name for name in names if name and name not in carried and name not in repeated]
    if len(kept) < len(names):
        schema = pa.schema([schema.field(name) for name in kept])
        batches = (batch.select(kept) for batch in batches)
    return Table(source.name, schema, Metadata(extra=extra), batches)


def _complete_lines(source: ByteSource) -> Iterator[bytes]:
    """What has arrived, in blocks that end at the end of a row.

    Each byte is looked at once, however long a row is: `held` has no end of a row, and `inside`
    tells whether it ends within quotes.
    """
    held: list[bytes] = []
    inside, size = False, 0
    while data := source.read_some():
        end = _last_row_end(data, inside=inside)
        if end:
            yield b"".join([*held, data[:end]])
            held, inside, data = [], False, data[end:]
        held.append(data)
        size = len(data) if end else size + len(data)
        require_moderate_row(source.name, size)
        inside ^= bool(data.count(b'"') % 2)
    # A signal that ends the input may have ended its writer in the middle of a row as well.
    if (rest := b"".join(held)) and not STOP.number:
        yield rest + b"\n"


def _without_headers(blocks: Iterator[bytes], header: bytes) -> Iterator[bytes]:
    """The blocks without lines that repeat the header, as between logs joined by `cat`."""
    for block in blocks:
        if header not in block:
            yield block
        else:
            lines = block.splitlines(keepends=True)
            yield b"".join(line for line in lines if line.rstrip(b"\r\n") != header)


def _last_row_end(data: bytes, *, inside: bool) -> int:
    """Where the last row ends; a line break inside quotes ends none."""
    end = data.rfind(b"\n") + 1
    odd = inside ^ bool(data.count(b'"', 0, end) % 2)
    while end and odd:
        before = data.rfind(b"\n", 0, end - 1) + 1
        odd ^= bool(data.count(b'"', before, end) % 2)
        end = before
    return end


def _header_end(block: bytes) -> int:
    """Where the rows begin, after the header; 0 if that has not arrived.

    Comments and empty lines may precede it.
    """
    start = 0
    while end := block.find(b"\n", start) + 1:
        line = block[start:end].removeprefix(BOM.encode())
        if line.strip() and not line.startswith(b"#"):
            return end
        start = end
    return 0


def _header(block: bytes, end: int, name: str) -> list[str]:
    if b"\0" in block[:end]:
        raise _not_a_table(name, block)
    text = decoded(block[:end])
    line = text.rstrip("\r\n").rpartition("\n")[2]
    names = [column.strip() for column in next(csv.reader([line]), [])]
    body = block[end:]
    if len(names) == 1 and (re.search(r"[;\t]", names[0]) or _spaced(names[0], body)):
        raise bad_data(
            name,
            f"the single column {names[0]!r}",
            expected="columns separated by commas",
            remedy="convert it first: `scarid convert` finds the separator",
        )
    if len(names) == 1 and body.count(b",") > 2 * body.count(b"\n"):
        raise bad_data(
            name,
            f"{names[0]!r} in the first line",
            expected="a header with the names of the columns",
            remedy="convert it first: `scarid convert` finds where the table begins",
        )
    if names and all(NUMERIC.match(column) for column in names):
        raise bad_data(
            name,
            f"{len(names)} numbers in the first line",
            expected="a header with the names of the columns",
            remedy="name them with `scarid convert --header t,q1,...`",
        )
    if len(names) > 2 and not names[0] and INDEX not in names:
        names[0] = INDEX
    # A line that ends in a comma has a last column without a name, which must be empty.
    inner = names[:-1] if len(names) > 1 and not names[-1] else names
    if not all(inner):
        raise _ambiguous("no name", name, str(inner.index("") + 1))
    return names


def _numbered(names: list[str]) -> tuple[list[str], dict[str, str]]:
    """The names with a mark behind those that were there before; by each marked name, the name."""
    counts: Counter[str] = Counter()
    found, repeated = [], {}
    for name in names:
        counts[name] += 1
        if counts[name] > 1:
            repeated[f"{name}\0{counts[name]}"] = name
        found.append(f"{name}\0{counts[name]}" if counts[name] > 1 else name)
    return found, repeated


def _without_repeated(
    batches: Iterator[pa.RecordBatch], repeated: dict[str, str], name: str
) -> Iterator[pa.RecordBatch]:
    """The rows, where columns of one name are equal, as clocks that stand beside each signal."""
    row = 0
    for batch in batches:
        for other, own in repeated.items():
            if not batch.column(other).equals(batch.column(own)):
                pairs = zip(batch.column(other), batch.column(own), strict=True)
                at = next((k for k, (a, b) in enumerate(pairs) if a != b), 0)
                count = 1 + sum(column == own for column in repeated.values())
                found = f"{count} columns of this name, with other values"
                raise _ambiguous(found, name, own, row + at + 1)
        row += batch.num_rows
        yield batch


def _spaced(header: str, body: bytes) -> bool:
    """Whether white space separates the values: as many words as numbers in the first row."""
    row = body.partition(b"\n")[0].decode(errors="replace").split()
    return 1 < len(header.split()) == len(row) and all(NUMERIC.match(value) for value in row)


def _ambiguous(found: str, name: str, column: str, row: int | None = None) -> BadData:
    """What to say of columns of one name, and without a name."""
    return bad_data(
        name,
        found,
        expected="one name per column",
        remedy="give each column a name of its own in the first line, or replace it: "
        f"`tail -n +2 {shlex.quote(name)} | scarid convert --header NAMES`",
        row=row,
        column=column,
    )


def _first_row(names: list[str], body: bytes) -> dict[str, str]:
    """The values of the first row, empty where it has none."""
    first = next(csv.reader(io.StringIO(body[: _first_row_end(body)].decode(errors="replace"))), [])
    return dict(zip(names, first + [""] * (len(names) - len(first)), strict=False))


def _types(row: dict[str, str]) -> list[pa.DataType]:
    return [_type(name, value) if name else pa.null() for name, value in row.items()]


def _type(name: str, value: str) -> pa.DataType:
    """That of a column that we know, unless it should be a number of a joint and is a name."""
    known, numeric = column_type(name), bool(NUMERIC.match(value))
    text = name == "joint" or (name == "t" and bool(DATED.match(value)))
    if known is not None and (numeric or not value or not text):
        return known
    return pa.float64() if numeric else pa.string()


def _first_row_end(body: bytes) -> int:
    start, end = 0, body.find(b"\n") + 1
    odd = bool(body.count(b'"', 0, end) % 2)
    blank = not body[:end].strip()
    while end and end < len(body) and (odd or blank):
        start, end = end, body.find(b"\n", end) + 1 or len(body)
        odd ^= bool(body.count(b'"', start, end) % 2)
        blank = blank and not body[start:end].strip()
    return end


def _batches(
    body: bytes, lines: Iterator[bytes], schema: pa.Schema, name: str
) -> Iterator[pa.RecordBatch]:
    row, few = 0, Few(schema)
    for block in chain([body], lines):
        if CUT in block:
            raise cut_short(name)
        found = few.parsed(block)
        for batch in _parse(block, schema, name, row) if found is None else [found]:
            yield batch
            row += batch.num_rows


def _parse(block: bytes, schema: pa.Schema, name: str, row: int) -> list[pa.RecordBatch]:
    if not block.strip():
        return []
    try:
        table = _parsed(block, schema)
    except pa.ArrowInvalid:
        from scarid_cli.io.csvfault import Refused  # not needed otherwise

        raise Refused(block, schema, name, row, _parsed).fault() from None
    batches: list[pa.RecordBatch] = table.combine_chunks().to_batches()
    return batches


def _parsed(block: bytes, schema: pa.Schema) -> pa.Table:
    return pacsv.read_csv(
        pa.py_buffer(block),
        read_options=pacsv.ReadOptions(
            column_names=schema.names, use_threads=False, block_size=len(block) + 1
        ),
        parse_options=pacsv.ParseOptions(newlines_in_values=b'"' in block),
        convert_options=pacsv.ConvertOptions(
            column_types=schema,
            null_values=["", *([] if _has_text(schema) else MISSING)],
            strings_can_be_null=True,
            quoted_strings_can_be_null=_one_of_numbers(schema),
        ),
    )


class CsvWriter:
    """Writes the header at once, and each batch as it arrives."""

    def __init__(self, write: Callable[[bytes], None], schema: pa.Schema) -> None:
        _require_writable(schema)
        self._write = write
        self._carried, self._first = Carried.of(schema), True
        schema = self._carried.schema(schema)
        self._numeric, self._few = not _has_text(schema), Few(schema)
        self._write(csv_text([schema.names]))

    def write(self, batch: pa.RecordBatch) -> None:
        batch = self._carried.beside(batch, first=self._first)
        self._first = self._first and not batch.num_rows
        if (few := self._few.text(batch)) is not None:
            self._write(few)
        else:
            self._write(_numbers(batch) if self._numeric else self._texts(batch))

    def close(self) -> None:
        """CSV has no end mark."""

    def abort(self) -> None:
        self._write(CUT)

    def _texts(self, batch: pa.RecordBatch) -> bytes:
        # pyarrow quotes every text or none; a person wants quotes only where they are needed.
        texts = [field.name for field in batch.schema if pa.types.is_string(field.type)]
        numbers = [name for name in batch.schema.names if name not in texts]
        lines = _numbers(batch.select(numbers)).decode().split("\n")[:-1] if numbers else []
        columns = dict(
            zip(numbers, zip(*(line.split(",") for line in lines), strict=True), strict=False)
        )
        columns |= {name: batch.column(name).to_pylist() for name in texts}
        ordered = [columns[name] for name in batch.schema.names]
        return csv_text(list(zip(*ordered, strict=True)))


def _require_writable(schema: pa.Schema) -> None:
    """Refuse columns whose name or values would not be read back."""
    twice = {name for name, count in Counter(schema.names).items() if count > 1}
    for index, field in enumerate(schema):
        if not _writable(field.type):
            raise bad_data(
                "the table",
                f"type {field.type}",
                expected="numbers, text or dates, which CSV can hold",
                remedy="write Parquet or Arrow, or leave the column out",
                column=field.name,
            )
        if not _readable_name(field.name, index) or field.name in twice:
            raise bad_data(
                "the table",
                f"the name {field.name!r}",
                expected="one that a CSV header can hold: a single line, used once, not empty, "
                "without spaces around it or # before it",
                remedy="write Parquet or Arrow, or rename it with `scarid convert --map`",
                column=str(index + 1),
            )


def _readable_name(name: str, index: int) -> bool:
    marked = index == 0 and name.startswith(("#", BOM))
    return bool(name) and name == name.strip() and not marked and not set(name) & set("\r\n\0")


def _writable(kind: pa.DataType) -> bool:
    return bool(
        (pa.types.is_primitive(kind) and not pa.types.is_interval(kind))
        or pa.types.is_string(kind)
        or pa.types.is_null(kind)
    )


def _numbers(batch: pa.RecordBatch) -> bytes:
    buffer = pa.BufferOutputStream()
    options = pacsv.WriteOptions(include_header=False, quoting_style="none")
    pacsv.write_csv(batch, buffer, options)
    text = bytes(memoryview(buffer.getvalue()))
    if _one_of_numbers(batch.schema) and batch.column(0).null_count:
        return b"".join(
            line if line.strip() else b'""\n' for line in text.splitlines(keepends=True)
        )
    return text


def _has_text(schema: pa.Schema) -> bool:
    return any(pa.types.is_string(field.type) for field in schema)


def _one_of_numbers(schema: pa.Schema) -> bool:
    """Whether there is a single column, of numbers: an empty cell of it would be an empty line."""
    return len(schema) == 1 and not pa.types.is_string(schema.field(0).type)
