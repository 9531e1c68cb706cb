"""A measurement in memory, each number once: it can be read again, and its columns are views."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import pyarrow as pa

from scarid_cli.arrays import Array
from scarid_cli.io.schemas import of_joints
from scarid_cli.io.table import SEGMENT, Table, doubles, matrix, segments_of

ROWS = 8192  # of a batch that is read again


@dataclass(frozen=True)
class Compact:
    """Time, positions and torques as `values` (1 + 2 joints, rows), `others` columns as they came.

    The batches of the `source` have been read.
    """

    source: Table
    names: list[str]
    values: Array
    others: pa.Table

    @classmethod
    def of(cls, table: Table, joints: int) -> Compact:
        """All rows of a measurement of so many joints."""
        names = ["t", *of_joints(joints, "q{i}", "tau{i}")]
        rest = [name for name in table.columns if name not in names]
        parts, others = [], []
        for batch in table.batches:
            parts.append(matrix(batch, names))
            others.append(batch.select(rest))
        fields = (f.with_type(pa.float64()) if f.name in names else f for f in table.schema)
        source = replace(table, schema=pa.schema(fields), batches=iter(()))
        schema = pa.schema([table.schema.field(name) for name in rest])
        values = _joined(parts, len(names))
        return cls(source, names, values, pa.Table.from_batches(others, schema))

    @property
    def joints(self) -> int:
        return len(self.names) // 2

    @property
    def rows(self) -> int:
        return int(self.values.shape[1])

    @property
    def table(self) -> Table:
        """The measurement; its batches can be read once each time that it is asked for."""
        return replace(self.source, batches=self._batches())

    @property
    def segments(self) -> list[Array]:
        """Positions and torques (2 joints, rows) of each segment between gaps."""
        if SEGMENT not in self.others.column_names:
            return [self.values[1:]] if self.rows else []
        numbers = np.concatenate([segments_of(batch) for batch in self.others.to_batches()])
        return np.split(self.values[1:], np.flatnonzero(np.diff(numbers)) + 1, axis=1)

    def other(self, names: list[str]) -> Array:
        """Further columns (names, rows), with nan for what is missing."""
        parts = [matrix(batch, names) for batch in self.others.to_batches()]
        return _joined(parts, len(names))

    def _batches(self) -> Iterator[pa.RecordBatch]:
        places = {name: k for k, name in enumerate(self.names)}
        for start in range(0, self.rows, ROWS):
            values = self.values[:, start : start + ROWS]
            others = self.others.slice(start, ROWS).combine_chunks()
            columns = (
                doubles(values[places[name]]) if name in places else others.column(name).chunk(0)
                for name in self.source.columns
            )
            yield pa.RecordBatch.from_arrays(list(columns), schema=self.source.schema)


def _joined(parts: list[Array], columns: int) -> Array:
    """The parts (columns, rows) side by side; each is freed once it is copied."""
    end = sum(part.shape[1] for part in parts)
    whole = np.empty((columns, end))
    while parts:
        part = parts.pop()
        whole[:, end - part.shape[1] : end] = part
        end -= part.shape[1]
    return whole
