"""Curves that are reduced while a record of any length is read, to what a figure can show."""

from __future__ import annotations

import numpy as np

from scarid_cli.arrays import Array

POINTS = 2000  # of a curve at most; a multiple of 4
GAP_STEPS = 5.0  # times the mean step is a gap: the points of a reduced curve lie up to 4 apart


class Curve:
    """The minimum and the maximum of each of at most POINTS / 2 equal parts of a record.

    Up to POINTS samples are kept as they are; beyond, parts grow with the record, from 2 samples.
    The samples of the last, unfinished part are kept as well, at most one in POINTS / 4.
    """

    def __init__(self) -> None:
        self._points = np.empty((2, 0))
        self._rest = np.empty((2, 0))
        self._part = 2

    def add(self, t: Array, x: Array) -> None:
        """Add the next samples: times [s] and values."""
        self._rest = np.hstack([self._rest, [t, x]])
        while self._rest.shape[1] >= self._part:
            room = (POINTS - self._points.shape[1]) // 2
            count = min(room, self._rest.shape[1] // self._part) * self._part
            self._points = np.hstack([self._points, extremes(self._rest[:, :count], self._part)])
            self._rest = self._rest[:, count:]
            if self._points.shape[1] == POINTS:
                self._points = extremes(self._points, 4)
                self._part *= 2

    def points(self) -> Array:
        """Times and values (2, points), in the order of time."""
        rest = self._rest
        return np.hstack([self._points, extremes(rest, rest.shape[1]) if rest.size > 4 else rest])


def extremes(points: Array, part: int) -> Array:
    """The minimum and the maximum of each part of so many points, in the order of time."""
    parts = points.reshape(2, -1, part)
    ends = np.stack([parts[1].argmin(axis=1), parts[1].argmax(axis=1)])
    # The minimum of a constant part is its maximum as well: take its two ends.
    ends[1] = np.where(ends[0] == ends[1], part - 1, ends[1])
    ends.sort(axis=0)
    rows = np.arange(parts.shape[1])
    return np.ascontiguousarray(parts[:, rows[:, None], ends.T].reshape(2, -1))


def broken(points: Array) -> Array:
    """The curve with nan in the gaps of the record, so that no line is drawn across them."""
    steps = np.diff(points[0])
    mean = steps.sum() / max(len(steps), 1)
    return np.insert(points, np.flatnonzero(steps > GAP_STEPS * mean) + 1, np.nan, axis=1)
