"""Logs whose rows have the values of one source each: of a topic, a bus or a device in turn.

The rows of the first signal are kept. The others are interpolated linearly at them, between their
own readings.
"""

from __future__ import annotations

import numpy as np

from scarid_cli.algorithms.processes.holding import MAX_GAP
from scarid_cli.arrays import Array, Numbers, median

FEWEST = 10  # readings of each signal
MOST = 0.5  # of the rows: where more are whole, single values are missing


def in_turn(values: Array) -> bool:
    """Whether most of these rows lack a value, although no signal lacks many.

    Values (signals, rows) that are missing are nan.
    """
    there = np.isfinite(values)
    return bool(there.sum(axis=1).min() >= FEWEST and there.all(axis=0).mean() < MOST)


def interpolated(t: Array, values: Array) -> tuple[Numbers, Array]:
    """The rows (from 0) that have the first signal, and the values there (signals, kept rows).

    Times (rows) [s] increase. Rows outside the readings of another signal, or in a gap of it, are
    not kept.
    """
    kept = np.flatnonzero(np.isfinite(values[0]) & np.isfinite(t))
    at, whole, found = t[kept], np.ones(len(kept), dtype=np.bool_), [values[0, kept]]
    for own in values[1:]:
        there = np.isfinite(own) & np.isfinite(t)
        times = t[there]
        if len(times) < 2:
            return np.empty(0, dtype=np.int64), np.empty((len(values), 0))
        after = np.clip(np.searchsorted(times, at), 1, len(times) - 1)
        within = (at >= times[0]) & (at <= times[-1])
        near = times[after] - times[after - 1] <= MAX_GAP * median(np.diff(times))
        whole &= within & (near | (times[after] == at) | (times[after - 1] == at))
        found.append(np.interp(at, times, own[there]))
    return kept[whole], np.array(found)[:, whole]
