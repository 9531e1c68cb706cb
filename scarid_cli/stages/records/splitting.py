"""Parts of a log between its gaps, and the statistics of its clock."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.processes.resampling import Clock
from scarid_cli.io.table import Instant, steps_of


class Splitting:
    """Splits batches at gaps longer than `limit` [s], and drops repeated rows."""

    def __init__(self, limit: float) -> None:
        self._limit = limit
        self._last: Instant | None = None
        self.segment = -1
        self.clock = Clock()

    def pieces(self, batch: pa.RecordBatch) -> Iterator[tuple[bool, pa.RecordBatch]]:
        """The pieces of a batch, and for each of them whether it begins a new segment."""
        steps, jumps, last = steps_of(batch, self._last)
        begins = (steps > self._limit) | (jumps != 0)
        begins[0] |= self._last is None
        for start, end in pairwise(sorted({0, *np.flatnonzero(begins).tolist(), len(steps)})):
            first = bool(begins[start])
            if first:
                self._begin(float(steps[start]))
            self.clock = self.clock.after(steps[start + first : end])
            kept = start + np.flatnonzero((steps > 0.0)[start:end] | begins[start:end])
            if len(kept) == end - start:
                yield first, batch.slice(start, end - start)
            elif len(kept):
                yield first, batch.take(pa.array(kept))  # imports pyarrow.compute, 40 ms
        self._last = last

    def _begin(self, gap: float) -> None:
        self.segment += 1
        if self.segment:
            self.clock = self.clock.after_gap(gap)
