"""Find the value of a CSV that pyarrow refuses, to name its row and column.

pyarrow itself is the judge: it refuses values that Python's `float` takes, such as 1_000. It names
no column, and counts rows within the block that it was given.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import pyarrow as pa

from scarid_cli.errors import BadData, bad_data, bad_row
from scarid_cli.io.cells import NUMERIC

Parse = Callable[[bytes, pa.Schema], object]
UNITS = (
    "write numbers without units; `scarid convert` reads units in a line of their own below the "
    "header"
)
LONGEST = 60  # characters of a value that a message shows


@dataclass(frozen=True)
class Refused:
    """A block of rows that `parse` refuses with pa.ArrowInvalid, after `row` other rows."""

    block: bytes
    schema: pa.Schema
    name: str
    row: int
    parse: Parse

    def fault(self) -> BadData:
        """The error that names the first row at fault, and its column where it has one."""
        rows = _rows(self.block)
        place = self._first_bad(rows)
        number = self.row + place + 1
        raw = rows[place]
        try:
            values = next(csv.reader(io.StringIO(raw.decode(errors="replace")), strict=True), [])
        except csv.Error:
            return BadData(f"{self.name}, row {number}: not CSV; is a quote left open?")
        if len(values) != len(self.schema):
            expected = f"{len(self.schema)}, one per column of the header"
            return bad_row(self.name, f"{len(values)} values", expected, number)
        for index, value in enumerate(values):
            if not self._parses([raw], index):
                field = self.schema.field(index)
                column = field.name or str(index + 1)
                found, wanted = _shown(value), _wanted(field.type)
                if number == 1 and not any(NUMERIC.match(x) for x in values):
                    return bad_data(self.name, found, expected=wanted, remedy=UNITS, row=number,
                                    column=column)  # fmt: skip
                return bad_row(self.name, found, wanted, number, column)
        return BadData(f"{self.name}, row {number}: not CSV; correct or remove the row")

    def _first_bad(self, rows: Sequence[bytes]) -> int:
        """The place of the first row at fault, by halving: each byte is parsed about twice."""
        low, high = 0, len(rows)
        while high - low > 1:
            middle = (low + high) // 2
            if self._parses(rows[low:middle]):
                low = middle
            else:
                high = middle
        return low

    def _parses(self, rows: Sequence[bytes], column: int | None = None) -> bool:
        """Whether pyarrow takes these rows, or their values in one column only."""
        types = [f.type if column in (None, i) else pa.binary() for i, f in enumerate(self.schema)]
        schema = pa.schema(list(zip(self.schema.names, types, strict=True)))
        try:
            self.parse(b"\n".join(rows) + b"\n", schema)
        except pa.ArrowInvalid:
            return False
        return True


def _rows(block: bytes) -> list[bytes]:
    """The rows of a block, without empty lines; a line break inside quotes ends none."""
    rows: list[bytes] = []
    held: list[bytes] = []
    quotes = 0
    for line in block.splitlines():
        quotes += line.count(b'"')
        held.append(line)
        if quotes % 2 == 0:
            rows += [b"\n".join(held)] if any(held) else []
            held, quotes = [], 0
    return [*rows, b"\n".join(held)] if held else rows


def _shown(value: str) -> str:
    return repr(value) if len(value) <= LONGEST else f"{value[:LONGEST]!r}..."


def _wanted(kind: pa.DataType) -> str:
    if pa.types.is_string(kind):
        return "text in UTF-8"
    if pa.types.is_null(kind):
        return "nothing, as the header has no name for it"
    return "an integer" if pa.types.is_integer(kind) else "a number"
