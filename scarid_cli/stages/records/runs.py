"""Runs whose clock begins anew, put one after the other as a log is read."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

import numpy as np
import pyarrow as pa

from scarid_cli.arrays import Array
from scarid_cli.io.table import SEGMENT, Table, concatenated, doubles, matrix
from scarid_cli.runs import RUN, period_of, run_starts

# Those of a time of the day, and of counters of 16 and 32 bits of s, ms, us and ns [s].
WRAPS = (86400.0, *(2.0**bits * unit for bits in (16, 32) for unit in (1.0, 1e-3, 1e-6, 1e-9)))


def runs_joined(table: Table, tell: Callable[[str], None]) -> Table:
    """The table, in which a run that begins anew at an earlier time `t` follows the one before it.

    A gap of RUN periods is between them, where `resample` begins a new segment. `tell` hears of
    each run when it is read.
    """
    if "t" not in table.columns or SEGMENT in table.columns:  # its segments may overlap
        return table
    return replace(table, batches=_Joining(tell).batches(table))


def _wrap(back: float, period: float) -> float:
    """The time [s] after which a clock begins again that goes back by this time; 0 if none does.

    The first row behind it comes as late as any other, within two periods.
    """
    return next((wrap for wrap in WRAPS if 0.0 < wrap - back < 2.0 * period), 0.0)


@dataclass
class _Joining:
    """How far the clock was ahead [s] of that of the present run, and where it is."""

    tell: Callable[[str], None]
    offset: float = 0.0
    tail: Array = field(
        default_factory=lambda: np.empty(0)
    )  # the last times of the log's own clock
    period: float = 0.0
    rows: int = 0

    def batches(self, table: Table) -> Iterator[pa.RecordBatch]:
        place = table.columns.index("t")
        waiting = iter(table.batches)
        for first in waiting:
            batch = first
            t = matrix(batch, ["t"])[0]
            # Whether a row is late or begins a run is seen in the rows behind it.
            while self._undecided(t, first) and (more := next(waiting, None)) is not None:
                batch = concatenated([batch, more])
                t = matrix(batch, ["t"])[0]
            starts = self._starts(t)
            if starts or self.offset:
                times = doubles(self._times(t, starts))
                batch = batch.set_column(place, table.schema.field("t"), times)
            self.tail = self._known(t)[-RUN:]
            self.rows += len(t)
            yield batch

    def _known(self, t: Array) -> Array:
        """The times behind the last ones before them."""
        return np.concatenate((self.tail, t))

    def _undecided(self, t: Array, first: pa.RecordBatch) -> bool:
        back = np.flatnonzero(np.diff(self._known(t)) < 0.0) - len(self.tail)
        late = bool(len(back)) and int(back[-1]) + 1 + RUN > len(t)
        return late and len(t) < first.num_rows + RUN

    def _starts(self, t: Array) -> list[int]:
        known = self._known(t)
        self.period = self.period or period_of(known)
        before = len(self.tail)
        return [start - before for start in run_starts(known, self.period) if start >= before]

    def _times(self, t: Array, starts: list[int]) -> Array:
        times = t + self.offset
        for start in starts:
            before = t[start - 1] if start else self.tail[-1]
            back = f"the time goes back from {before:.6g} to {t[start]:.6g} s in row "
            back += f"{self.rows + start + 1}"
            if wrap := _wrap(before - t[start], self.period):
                self.tell(f"{back}: a clock that begins again after {wrap:.10g} s, which goes on")
                self.offset += wrap
            else:
                self.tell(
                    f"warning: {back}: a new run, put behind the one before it with a gap, where "
                    "`scarid resample` begins a segment"
                )
                self.offset += before + RUN * self.period - t[start]
            times[start:] = t[start:] + self.offset
        return times
