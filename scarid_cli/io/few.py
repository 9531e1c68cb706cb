"""A few rows of numbers as CSV, as they come beside a robot, without the set-up of pyarrow's CSV.

Both directions give what pyarrow gives, or None for what is left to it. Below 4 kB, or 96 numbers,
this is faster: a row of ten numbers is read 5 times as fast, and written twice.
"""

from __future__ import annotations

from math import inf

import numpy as np
import pyarrow as pa

from scarid_cli.io.table import doubles, integers

MOST_BYTES = 4096
MOST_NUMBERS = 96
PLAIN = b"0123456789-.e,\n"
# Between these, repr writes a double as pyarrow does, but for a last ".0".
POSITIONAL = (1e-4, 1e10)
SMALL = 1e-6  # down to here, pyarrow writes no exponent


class Few:
    """Reads and writes a few rows at a time, of a table of two and more columns of numbers."""

    def __init__(self, schema: pa.Schema) -> None:
        self._schema = schema
        self._integers = [k for k, kind in enumerate(schema.types) if kind == pa.int64()]
        floats = schema.types.count(pa.float64())
        self._able = len(schema) == len(self._integers) + floats > 1

    def parsed(self, block: bytes) -> pa.RecordBatch | None:
        """The rows of a block of CSV without quotes, empty cells, or plus signs."""
        if not self._able or len(block) > MOST_BYTES:
            return None
        block = block.replace(b"\r\n", b"\n")
        if block.translate(None, PLAIN):
            return None
        rows = [line.split(b",") for line in block.split(b"\n") if line]
        try:
            values = np.array([[*map(float, row)] for row in rows])
            whole = {k: [int(row[k]) for row in rows] for k in self._integers}
            columns = [
                integers(whole[k]) if k in whole else doubles(column)
                for k, column in enumerate(np.ascontiguousarray(values.T))
            ]
        except (ValueError, OverflowError, IndexError):
            return None
        if len(columns) != len(self._schema) or np.abs(values).max() == inf:
            return None
        return pa.RecordBatch.from_arrays(columns, schema=self._schema)

    def text(self, batch: pa.RecordBatch) -> bytes | None:
        """The rows of a batch as CSV."""
        if not self._able or batch.num_rows * len(self._schema) > MOST_NUMBERS:
            return None
        columns = []
        for k, column in enumerate(batch.columns):
            if column.null_count:
                return None
            values = column.to_numpy().tolist()
            texts = [*map(str if k in self._integers else _text, values)]
            if None in texts:
                return None
            columns.append(texts)
        return "".join(f"{','.join(row)}\n" for row in zip(*columns, strict=True)).encode()


def _text(x: float) -> str | None:
    """A double in the fewest digits that are read as it; None if it is too large."""
    size, found = abs(x), repr(x)
    if POSITIONAL[0] <= size < POSITIONAL[1] or size == 0.0:
        return found.removesuffix(".0")
    if not size < POSITIONAL[0]:
        return None
    digits, _, exponent = found.partition("e")
    if size < SMALL:
        return f"{digits}e{int(exponent)}"
    sign = "-" if x < 0.0 else ""
    return f"{sign}0.{'0' * (-int(exponent) - 1)}{digits.lstrip('-').replace('.', '')}"
