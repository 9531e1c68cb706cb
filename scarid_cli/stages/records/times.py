"""The times of the samples of a record, which are numbered through its gaps."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from math import ceil, floor

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.uncertainty.bursts import Interval
from scarid_cli.io.table import Table, matrix, segments_of
from scarid_cli.stages.records.rows import Gaps
from scarid_cli.stages.records.several import LOGS
from scarid_cli.words import listed

MUCH = 0.75  # of the log: where less would be kept, the other parts are worth a fit as well
CAUSE = "a contact, or another load?"


class Times:
    """Knows the time of each sample of a table; `seen` is the number of the first one."""

    def __init__(self, table: Table, seen: int) -> None:
        self._period, self._seen = table.period, seen
        self._several = LOGS in table.meta.extra  # whose times are moved on
        self._starts: list[tuple[float, float]] = []  # of segments: as counted, and in the log [s]
        self._end = 0.0

    def watched(self, table: Table) -> Table:
        """The table, whose segments are noted as they pass, if it has times."""
        if "t" not in table.schema.names:
            return table
        return replace(table, batches=self._watched(table.batches))

    def _watched(self, batches: Iterator[pa.RecordBatch]) -> Iterator[pa.RecordBatch]:
        gaps, row, last = Gaps(self._period), self._seen, -1
        for batch in batches:
            numbers = segments_of(batch)
            t = matrix(batch, ["t"])[0]
            for at in np.flatnonzero(np.diff(numbers, prepend=last)).tolist():
                counted = row + at + gaps.before(batch.slice(at, 1))
                self._starts.append((counted * self._period, float(t[at])))
            if len(t):
                last, self._end = int(numbers[-1]), float(t[-1])
            row += batch.num_rows
            yield batch

    def unexplained(self, bursts: Sequence[Interval]) -> str:
        """What to do about these intervals, counted from sample 0; empty if they have no time."""
        found = self.of(bursts)
        return advice(found, self._starts[0][1], self._end) if found else ""

    def of(self, bursts: Sequence[Interval]) -> list[Interval]:
        """These intervals, counted from sample 0, in the times of the log.

        Those of several logs, and those before the first sample of this table, have no time.
        """
        if self._several or not self._starts:
            return []
        if any(burst.start < self._starts[0][0] for burst in bursts):
            return []
        return [Interval(self._time(burst.start), self._time(burst.end)) for burst in bursts]

    def _time(self, counted: float) -> float:
        """The time in the log [s] of a time that is counted from sample 0 [s]."""
        start, t = self._starts[max(0, bisect_right(self._starts, (counted, np.inf)) - 1)]
        return t + counted - start


def advice(found: Sequence[Interval], start: float, end: float) -> str:
    """Which torques are not explained, and how they are left out of a log from `start` to `end`.

    The options keep the longest part.
    """
    edges = _rounded(found)
    kept = pairwise([start, *(time for edge in edges for time in edge), end])
    first, last = max(list(kept)[::2], key=lambda part: part[1] - part[0])
    options = [f"--from-time {first:g}"] if first != start else []
    options += [f"--to-time {last:g}"] if last != end else []
    few = last - first < MUCH * (end - start)
    parts = "give the other parts as several logs, or " if few else ""
    return (
        f"the torques at {spans(found)} cannot be explained ({CAUSE}): {parts}leave them out with "
        f"{' '.join(options)}"
    )


def spans(found: Sequence[Interval]) -> str:
    """The intervals in words."""
    return listed([f"{a:g} to {b:g} s" for a, b in _rounded(found)])


def _rounded(found: Sequence[Interval]) -> list[tuple[float, float]]:
    """Starts and ends [s], rounded so that the intervals grow."""
    return [(floor(10.0 * x.start) / 10.0, ceil(10.0 * x.end) / 10.0) for x in found]
