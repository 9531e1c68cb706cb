"""Readings of a slow sensor, interpolated at the rows in which a logger only repeats them.

Positions and torques often come from different devices, so each of these groups of signals has a
rate of its own. A group of a single signal proves nothing, and is left alone.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.arrays import Array, Marks, Numbers, median

NODES = 4  # readings through which the polynomial goes
READINGS = 32  # new values of a group, by which its rate is judged
SEARCH = 100_000  # rows in which so many have to be found
SLOWER = 1.5  # times the interval of the rows: that of a slower sensor's readings, at least
TOGETHER = 0.9  # share of a group's values that change in a reading, as a mean


def reading_interval(t: Array, values: Array) -> float | None:
    """The interval between the readings of a group [s] if it is slower than the rows, else None.

    Times (rows) [s] and values (signals, rows), of which the first readings decide.
    """
    if len(values) < 2:
        return None
    t, values = t[:SEARCH], values[:, :SEARCH]
    changed = (np.diff(values, axis=1) != 0.0).mean(axis=0)
    at = np.flatnonzero(changed)[: READINGS + 1]
    if len(at) <= READINGS or changed[at].mean() < TOGETHER:
        return None
    steps = np.diff(t[: at[-1] + 2])
    rows = median(steps[steps > 0.0]) if np.any(steps > 0.0) else np.inf
    interval = median(np.diff(t[at + 1]))
    return interval if interval > SLOWER * rows else None


@dataclass(frozen=True)
class Readings:
    """The rows `at` (readings) with new values, at times `t` (rows) [s], in pieces.

    Within a piece readings are at most a given interval apart; `first` and `last` (readings) are
    the numbers of the first and the last reading of its piece. The last piece of all `ended` if no
    further reading can belong to it.
    """

    t: Array
    at: Numbers
    first: Numbers
    last: Numbers
    ended: bool

    @classmethod
    def of(cls, t: Array, fresh: Marks, segments: Numbers, limit: float) -> Readings:
        """From the times [s] (rows), the `fresh` rows with new values, and the longest interval."""
        at = np.flatnonzero(fresh)
        begins = np.ones(len(at), dtype=np.bool_)
        begins[1:] = (np.diff(t[at]) > limit) | (np.diff(segments[at]) != 0)
        starts = np.flatnonzero(begins)
        piece = np.cumsum(begins) - 1
        last = np.append(starts[1:], len(at)) - 1
        ended = bool(len(at) == 0 or t[-1] - t[at[-1]] > limit)
        return cls(t, at, starts[piece], last[piece], ended)

    def decided(self) -> int:
        """The number of rows at the start that further readings cannot change."""
        if self.ended:
            return len(self.t)
        first, last = int(self.first[-1]), int(self.last[-1])
        return int(self.at[last - 1 if last - first >= NODES - 1 else first])

    def needed(self) -> int:
        """The row from which on rows are needed to interpolate those that are not decided."""
        if self.ended:
            return len(self.t) - 1
        first, last = int(self.first[-1]), int(self.last[-1])
        return int(self.at[max(first, last - NODES + 1)])

    def filled(self, values: Array) -> tuple[Array, Marks]:
        """The values (signals, rows) on cubic polynomials through readings, and the rows changed.

        The polynomial of Lagrange goes through the two readings before a row and the two after it,
        or through the four nearest ones at the ends of a piece. A straight line would take 3 % of
        an oscillation that has ten readings a period, which its acceleration then lacks; this takes
        0.2 %. Rows that are not decided are left alone.
        """
        marks = np.zeros(len(self.t), dtype=np.bool_)
        if not len(self.at):
            return values, marks
        marks[: self.decided()] = True
        marks[self.at] = False
        rows = np.flatnonzero(marks)
        before = np.searchsorted(self.at, rows, side="right") - 1
        between = (before >= 0) & (before < self.last[before])
        between &= self.last[before] - self.first[before] >= NODES - 1
        rows, before = rows[between], before[between]
        start = np.clip(before - 1, self.first[before], self.last[before] - NODES + 1)
        nodes = self.at[start + np.arange(NODES)[:, None]]
        new = values.copy()
        new[:, rows] = _lagrange(self.t[nodes], values[:, nodes], self.t[rows])
        changed: Marks = np.zeros(len(self.t), dtype=np.bool_)
        changed[rows] = True
        return new, changed


def _lagrange(nodes: Array, values: Array, t: Array) -> Array:
    """Polynomials through values (signals, nodes, rows) at times (nodes, rows), at t (rows)."""
    found = np.zeros((len(values), len(t)))
    for i, own in enumerate(nodes):
        weight = np.ones_like(t)
        for j, other in enumerate(nodes):
            if j != i:
                weight *= (t - other) / (own - other)
        found += weight * values[:, i]
    return found
