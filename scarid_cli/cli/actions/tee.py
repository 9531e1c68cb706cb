"""Run `scarid tee`."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import pyarrow as pa

from scarid_cli.cli.running.job import Job
from scarid_cli.io.table import Table
from scarid_cli.io.writer import Output


def run(job: Job, *, place: str) -> None:
    """Write the table to the file and to the command's output."""
    side = job.output(place)
    table = job.read("-", None)
    job.write(replace(table, batches=_written(table, side)))


def _written(table: Table, side: Output) -> Iterator[pa.RecordBatch]:
    side.start(table.arrow_schema())
    for batch in table.batches:
        side.write(batch)
        yield batch
