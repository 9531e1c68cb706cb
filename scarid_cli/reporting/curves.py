"""Curves of records of any length, reduced to what a figure can show while they are read."""

from __future__ import annotations

import numpy as np

from scarid_cli.arrays import Array

POINTS = 2000  # of a curve; a multiple of 4


class Curve:
    """The least and the greatest sample of each of at most POINTS / 2 equal parts of a record.

    A part grows with the record, from 2 samples: up to POINTS samples are kept as they are. The
    samples of the last, unfinished part are held: at most one in POINTS / 4.
    """

    def __init__(self) -> None:
        self._points = np.empty((2, 0))
        self._rest = np.empty((2, 0))
        self._part = 2

    def add(self, t: Array, x: Array) -> None:
        """Take in the next samples."""
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
    """The least and the greatest point of each part, in the order of time."""
    parts = points.reshape(2, -1, part)
    ends = np.stack([parts[1].argmin(axis=1), parts[1].argmax(axis=1)])
    # A constant part has one extreme: take both of its ends.
    ends[1] = np.where(ends[0] == ends[1], part - 1, ends[1])
    ends.sort(axis=0)
    rows = np.arange(parts.shape[1])
    return np.ascontiguousarray(parts[:, rows[:, None], ends.T].reshape(2, -1))
