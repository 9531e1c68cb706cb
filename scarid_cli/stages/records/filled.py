"""A log whose rows have the values of one source each, with all of them in some of its rows."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.processes.in_turn import in_turn, interpolated
from scarid_cli.errors import BadData
from scarid_cli.io.schemas import numbered
from scarid_cli.io.selection import Numbering
from scarid_cli.io.table import (
    SEGMENT,
    Table,
    concatenated,
    doubles,
    integers,
    matrix,
    segments_of,
    with_columns,
)


def of_one_source(batch: pa.RecordBatch) -> pa.RecordBatch | None:
    """The rows that have q1, if most rows have the values of one source only; else None."""
    names = numbered(batch.schema.names, "q", "tau")
    if "t" not in batch.schema.names or "q1" not in names:
        return None
    values = matrix(batch, names)
    if not in_turn(values):
        return None
    return batch.filter(pa.array(np.isfinite(values[names.index("q1")])))


@dataclass
class Filled:
    """Interpolates values that are missing in some `columns`, of which the first keeps its rows.

    All of the log is held. `count` rows are left out.
    """

    columns: list[str]
    count: int = 0

    def removed(self, table: Table) -> Table:
        """The table with the rows of the first column, which lack nothing."""
        numbering = Numbering(table.row)
        return replace(table, batches=self._rows(table, numbering), row=numbering)

    @property
    def text(self) -> str:
        """What was done, in words."""
        return (
            f"left out {self.count:,} rows without {self._own[0]}, or outside the readings of the "
            "others, which are interpolated"
        )

    @property
    def _own(self) -> list[str]:
        return [name for name in self.columns if name not in ("t", SEGMENT)]

    def _rows(self, table: Table, numbering: Numbering) -> Iterator[pa.RecordBatch]:
        whole = concatenated(list(table.batches))
        kept, values = self._of_segments(whole)
        if not len(kept):
            raise BadData(
                f"{table.name}: no row of {self._own[0]} lies between readings of "
                f"{', '.join(self._own[1:])}; `scarid info` tells which values there are"
            )
        self.count = whole.num_rows - len(kept)
        before = 0
        for place, row in enumerate(kept.tolist()):
            if row - place > before:
                numbering.leave_out(place, row - place - before)
                before = row - place
        new = {name: doubles(x) for name, x in zip(self._own, values, strict=True)}
        yield with_columns(whole.take(integers(kept)), table.schema, new)

    def _of_segments(self, batch: pa.RecordBatch) -> tuple[np.ndarray, np.ndarray]:
        """The rows that are kept, and their values (columns, kept rows); segments stay apart."""
        t, values, segments = matrix(batch, ["t"])[0], matrix(batch, self._own), segments_of(batch)
        rows, found = [], []
        for segment in np.unique(segments).tolist():
            own = np.flatnonzero(segments == segment)
            kept, filled = interpolated(t[own], values[:, own])
            rows.append(own[kept])
            found.append(filled)
        return np.concatenate(rows), np.concatenate(found, axis=1)
