"""Short intervals of a record whose torques the model does not explain, such as a collision.

The record is divided into blocks of half a second. In a few of them the mean square of the residual
of a joint is more than FAR times the one that nine blocks of ten do not exceed, and these blocks
hold most of the sum of its squares. Neither noise nor friction that the model lacks does that.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import ceil, floor

import numpy as np

from scarid_cli.arrays import Array, Marks, Numbers

BLOCK = 0.5  # s
FEWEST = 16  # blocks with rows that count, below which what is usual is not known
MOST = 4  # blocks
USUAL = 0.9  # of the blocks
FAR = 50.0  # times the mean square that USUAL blocks do not exceed
FULL = 0.5  # of the rows of the fullest block, by which the squares are at least divided
SHARE = 0.5  # of the squares of the residual
SIZE = 0.1  # of the root-mean-square torque: a smaller residual is none of a collision


@dataclass(frozen=True)
class Interval:
    """From `start` to `end` [s]."""

    start: float
    end: float


def bursts(residual: Array, torque: Array, counts: Marks, t: Array) -> tuple[Interval, ...]:
    """The intervals, in the order of time; none if there is nothing extraordinary.

    Residual and torque (samples, joints) [N m or N], which of them count (samples, joints), and the
    times t (samples) [s].
    """
    block = ((t - t[0]) / BLOCK).astype(np.int64)
    far = np.zeros(len(t), dtype=np.bool_)
    for r, y, k in zip(residual.T, torque.T, counts.T, strict=True):
        far[k] |= _far(r[k] ** 2, float(np.sum(y[k] ** 2)), block[k])
    if not 0 < np.count_nonzero(np.bincount(block[far])) <= MOST:
        return ()
    at = np.flatnonzero(far)
    parts = np.split(at, np.flatnonzero(np.diff(t[at]) > BLOCK) + 1)
    return tuple(Interval(float(t[part[0]]), float(t[part[-1]])) for part in parts)


def _far(squares: Array, torque: float, block: Numbers) -> Marks:
    """Which squares of the residual (rows) of a joint belong to a burst; the torque's sum."""
    none = np.zeros(len(squares), dtype=np.bool_)
    counts, sums = np.bincount(block), np.bincount(block, squares)
    if np.count_nonzero(counts) < FEWEST:
        return none
    means = sums / np.maximum(counts, FULL * counts.max())  # a few rows prove nothing
    known = np.sort(means[counts > 0])
    usual = float(known[int(USUAL * (len(known) - 1))])
    burst = (means > FAR * usual) & (means > SIZE**2 * torque / len(squares))
    if not sums[burst].sum() > SHARE * sums.sum():
        return none
    return np.asarray(burst[block] & (squares > FAR * usual))


def advice(found: Sequence[Interval], start: float, end: float) -> str:
    """Which torques are not explained, and how they are left out of a log from `start` to `end`.

    Times [s] are rounded so that the intervals grow. The longest part without a burst is kept.
    """
    if not found:
        return ""
    edges = [(floor(10.0 * x.start) / 10.0, ceil(10.0 * x.end) / 10.0) for x in found]
    parts = pairwise([start, *(time for edge in edges for time in edge), end])
    first, last = max(list(parts)[::2], key=lambda part: part[1] - part[0])
    options = [f"--from-time {first:g}"] if first != start else []
    options += [f"--to-time {last:g}"] if last != end else []
    times = " and at ".join(f"{a:g} to {b:g} s" for a, b in edges)
    return (
        f"the torques at {times} cannot be explained (a collision?): leave them out with "
        f"{' '.join(options)}"
    )
