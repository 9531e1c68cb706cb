"""Stages: functions from table to table, batch by batch, that know no files and no options."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    import pyarrow as pa


class Sink(Protocol):
    """Where a stage sends a second table: first its schema, then its batches."""

    def start(self, schema: pa.Schema) -> None: ...
    def write(self, batch: pa.RecordBatch) -> None: ...
