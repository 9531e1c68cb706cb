"""The common motion of a real log, with which soft sensors are compared for want of the truth."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pyarrow as pa

from scarid_cli.arrays import Array, Numbers
from scarid_cli.errors import BadData, bad_data
from scarid_cli.io.table import Table, doubles, matrix, settled
from scarid_cli.reporting.naming import COMMON, Name

NEAR = 0.25  # of a sampling period: closer rows are of the same instant
APART = 0.5  # of the range of the positions: an estimate further from it is of another motion


@dataclass(frozen=True)
class CommonMotion:
    """Columns of the settled rows of `common.EXPERIMENT.motion`, and the name of its file."""

    file: str
    values: dict[str, Array]

    @classmethod
    def of(cls, file: str, batches: Sequence[pa.RecordBatch]) -> CommonMotion:
        """The columns t, q, dq and ddq, which are kept as a whole."""
        names = [name for name in batches[0].schema.names if _kept(name)]
        parts = [matrix(batch, names) for batch in settled(iter(batches))]
        rows = np.hstack(parts or [np.empty((len(names), 0))])
        return cls(file, dict(zip(names, rows, strict=True)))

    def beside(self, table: Table) -> Table:
        """The settled rows of this motion that the common one has too, with it as their truth."""
        names = [name for name in table.columns if _kept(name) and name != "t"]
        truths = [pa.field(f"{name}_true", pa.float64()) for name in names]
        schema = pa.schema([*table.schema, *truths])
        return replace(table, schema=schema, batches=self._rows(table, names, schema))

    def _rows(
        self, table: Table, names: Sequence[str], schema: pa.Schema
    ) -> Iterator[pa.RecordBatch]:
        found = False
        for batch in settled(table.batches):
            at, own = self._matched(matrix(batch, ["t"])[0])
            kept = batch.take(pa.array(own))
            values = [self._value(table, name)[at] for name in names]
            for name, value in zip(names, values, strict=True):
                if name.startswith("q"):
                    self._require_same(table, matrix(kept, [name])[0], value)
            if len(own):
                found = True
                yield pa.RecordBatch.from_arrays(
                    [*kept.columns, *map(doubles, values)], schema=schema
                )
        if not found:
            raise self._another(table, "no row at the same time")

    def _matched(self, t: Array) -> tuple[Numbers, Numbers]:
        """The rows of the common motion at the same instants as some of these, and these."""
        own = self.values["t"]
        if len(own) < 2:
            return np.empty(0, int), np.empty(0, int)
        after = np.searchsorted(own, t).clip(1, len(own) - 1)
        at = after - (t - own[after - 1] < own[after] - t)
        near = np.abs(own[at] - t) < NEAR * np.median(np.diff(own))
        return at[near], np.flatnonzero(near)

    def _value(self, table: Table, name: str) -> Array:
        if name not in self.values:
            raise self._another(table, f"no column {name}")
        return self.values[name]

    def _require_same(self, table: Table, estimate: Array, common: Array) -> None:
        widest = max(np.ptp(x) for name, x in self.values.items() if name.startswith("q"))
        if np.any(np.abs(estimate - common) > APART * widest):
            raise self._another(table, "other positions at the same time")

    def _another(self, table: Table, found: str) -> BadData:
        return bad_data(
            self.file,
            f"{found} as in {table.name}",
            expected="a motion of the same log",
            remedy=f"leave it out, or name both after their log: {COMMON}.LOG.motion.parquet",
        )


def _kept(name: str) -> bool:
    """Whether this is the time or an estimate of a joint: t, q1, dq1, ddq1, ..."""
    return name == "t" or name.lstrip("d").removeprefix("q").isdigit()


def with_common(tables: Sequence[Table], names: Sequence[Name]) -> list[Table | None]:
    """The tables, where motions without the truth get the common motion of their experiment.

    A common motion that serves others so is itself left out (None).
    """
    motions = [i for i, t in enumerate(tables) if t.meta.kind == "motion" and _without_truth(t)]
    commons = {names[i].experiment: i for i in motions if names[i].label == COMMON}
    found: list[Table | None] = list(tables)
    for experiment, at in commons.items():
        others = [i for i in motions if i != at and names[i].experiment == experiment]
        if not others:
            continue
        common = CommonMotion.of(tables[at].name, list(tables[at].batches))
        found[at] = None
        for i in others:
            found[i] = common.beside(tables[i])
    return found


def _without_truth(table: Table) -> bool:
    return not any(name.startswith(("dq", "ddq")) and name.endswith("_true")
                   for name in table.columns)  # fmt: skip
