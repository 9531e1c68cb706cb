"""Held samples: rows with which a logger repeats the values of a slower sensor.

Only the first row of a run has values of its time; the others are old by up to a period of the
sensor, which interpolation between the first rows mends. A robot at rest repeats values as well.
A run is of held samples if the interval that is left without it is no gap, and if at least half of
the values change together in the row that ends it: encoders of a joint that moves off one after
another do not. A single signal proves nothing.
"""

from __future__ import annotations

import numpy as np

from scarid_cli.arrays import Array, Marks, Numbers, median

TOGETHER = 0.5  # share of the values that change in the row that ends a run of held samples
SLOWEST = 25.0  # periods of the log per value of a slower sensor, whose samples it holds
FIRST = 32  # intervals, whose median is taken as the period of the log
MAX_GAP = 5.0  # periods of the log; a longer interval is a gap


def sensor_period(every: Array, new: Array) -> float:
    """The period [s] of the sensors, given the first intervals between all rows and `new` values.

    It is that of the log, unless the sensors are slower and the log holds their samples.
    """
    period = median(every[:FIRST])
    if len(new):
        slower = median(new[:FIRST])
        period = slower if slower <= SLOWEST * period else period
    return period


def intervals(t: Array, values: Array, segments: Numbers) -> tuple[Array, Array]:
    """The positive intervals [s] between all rows, and between those with new values."""
    every = new = np.diff(t)
    if len(values) > 1 and len(t):
        new = np.diff(t[~repeating(t, values, segments)])
    return every[every > 0.0], new[new > 0.0]


def held_in(t: Array, values: Array) -> tuple[Marks, float]:
    """Which rows of a whole log are held samples, and the period [s] of its sensors.

    Times t (rows) [s], values (columns, rows).
    """
    segments = np.zeros(len(t), dtype=np.int64)
    every, new = intervals(t, values, segments)
    if len(values) < 2 or not len(every):
        return np.zeros(len(t), dtype=np.bool_), median(every) if len(every) else 0.0
    period = sensor_period(every, new)
    held, waiting = held_rows(t, values, segments, MAX_GAP * period)
    held[waiting + 1 :] = held.any()  # what ends a log with held samples is taken for some as well
    return held, period


def repeating(t: Array, values: Array, segments: Numbers) -> Marks:
    """Which rows repeat all values of the row before, at a later time (rows)."""
    changed = np.any(np.diff(values, axis=1) != 0.0, axis=0)
    same: Marks = (np.diff(t) > 0.0) & (np.diff(segments) == 0) & ~changed
    return np.concatenate(([False], same))


def held_rows(t: Array, values: Array, segments: Numbers, limit: float) -> tuple[Marks, int]:
    """Which rows are held samples, and the number of the row that the undecided rest repeats.

    Times (rows) [s], values (columns, rows). The rest has no end yet.
    """
    held = np.zeros(len(t), dtype=np.bool_)
    waiting = len(t) - 1
    edges = np.flatnonzero(np.diff(repeating(t, values, segments), append=False))
    for before, last in edges.reshape(-1, 2).tolist():  # the row before a run, and its last row
        if last == len(t) - 1:
            waiting = before if t[last] - t[before] <= limit else last
        elif t[last + 1] - t[before] <= limit and segments[last] == segments[last + 1]:
            changed = np.mean(values[:, last + 1] != values[:, last])
            held[before + 1 : last + 1] = changed >= TOGETHER
    return held, waiting
