"""Stages: each takes a table and gives one, batch by batch, and knows no files and no click."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    import pyarrow as pa


class Sink(Protocol):
    """Where a stage sends a second table: its schema first, then the batches."""

    def start(self, schema: pa.Schema) -> None: ...
    def write(self, batch: pa.RecordBatch) -> None: ...
