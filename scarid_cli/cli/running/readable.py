"""The output of a small table on a terminal: a table that a person reads, in place of CSV."""

from __future__ import annotations

from typing import Any

import pyarrow as pa

from scarid_cli.io.table import METADATA_KEY, Metadata
from scarid_cli.io.writer import Output
from scarid_cli.printable import utf8


class Readable(Output):
    """A table on a terminal, which is printed when it is complete."""

    def start(self, schema: pa.Schema) -> None:
        self._writer = Printer(self.target.write, schema)

    def whole(self) -> None:
        self.finish()  # so that the verdict comes after the table


class Printer:
    """Holds the rows, and writes them as text at the end."""

    def __init__(self, write: Any, schema: pa.Schema) -> None:
        self._write = write
        self._schema = schema
        self._batches: list[pa.RecordBatch] = []

    def write(self, batch: pa.RecordBatch) -> None:
        self._batches.append(batch)

    def close(self) -> None:
        from scarid_cli.reporting.readable import readable  # rich takes a while to import

        kind = Metadata.from_json(self._schema.metadata[METADATA_KEY]).kind or "table"
        table = pa.Table.from_batches(self._batches, self._schema)
        self._write(utf8(readable(kind.capitalize(), table)).encode())

    def abort(self) -> None:
        """Nothing was written yet."""
