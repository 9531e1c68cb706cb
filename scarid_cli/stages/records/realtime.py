"""Rows at the pace of their time stamps, as a robot would make them."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, replace

import pyarrow as pa

from scarid_cli.io.stop import STOP
from scarid_cli.io.table import Table

# What is computed at once [s]: the first row of a part waits for the computation of all of it.
PART = 0.01


@dataclass
class Lateness:
    """How long after their time rows were handed on [s]: the worst one, and the last one."""

    worst: float = 0.0
    last: float = 0.0

    def note(self, late: float) -> None:
        """A row was handed on so late."""
        self.worst, self.last = max(self.worst, late), late


def in_parts(table: Table) -> Table:
    """The table in batches of at most PART, of one row at least."""
    rows = max(int(PART / table.period), 1) if table.period else 1
    parts = (
        batch.slice(start, rows)
        for batch in table.batches
        for start in range(0, batch.num_rows, rows)
    )
    return replace(table, batches=parts)


def paced(table: Table, lateness: Lateness) -> Table:
    """The table, each row of which comes at its time `t` [s] after the first row.

    A row whose time lies before that of an earlier row comes with it. A signal ends the table, as
    it ends any live input.
    """
    return replace(table, batches=_paced(table.batches, lateness))


def _paced(batches: Iterator[pa.RecordBatch], lateness: Lateness) -> Iterator[pa.RecordBatch]:
    begun, due = None, 0.0
    for batch in batches:
        for index, t in enumerate(batch.column("t").to_pylist()):
            if begun is None:
                begun, due = time.monotonic() - t, t
                STOP.live = True
            due = max(due, t)
            while (left := begun + due - time.monotonic()) > 0.0 and not STOP.number:
                STOP.wait(left)
            if STOP.number:
                return
            lateness.note(-left)
            yield batch.slice(index, 1)
