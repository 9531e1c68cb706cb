"""Short intervals of a record whose torques the model does not explain, such as a collision.

The record is divided into blocks of half a second. In a few of them the mean square of the residual
of a joint is more than FAR times the one that three blocks of four do not exceed, and these blocks
hold most of the sum of its squares. Neither noise nor friction that the model lacks does that, if
the residual is that of the blocks which the model explains best (trimmed.py).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.regression.rows import Rows, predicted
from scarid_cli.arrays import Array, Marks, Numbers

BLOCK = 0.5  # s
FEWEST = 16  # blocks with rows that count, below which what is usual is not known
USUAL = 0.75  # of the blocks, at least
FAR = 50.0  # times the mean square that USUAL blocks do not exceed
NEAR, GAP = 9.0, 0.05  # times this, and s between samples: what belongs to a burst beside it
FULL = 0.5  # of the rows of the fullest block, by which the squares are at least divided
SHARE = 0.5  # of the squares of the residual
SIZE = 0.1  # of the root-mean-square torque: a smaller residual is none of a collision


@dataclass(frozen=True)
class Interval:
    """From `start` to `end` [s]."""

    start: float
    end: float


def bursts_of(rows: Rows, estimates: Array) -> tuple[Interval, ...]:
    """The intervals [s], counted from sample 0, that estimates of the first columns leave."""
    residual = rows.y - predicted(rows, estimates)
    return bursts(residual, rows.y, rows.scales > 0.0, np.asarray(rows.at * rows.h))


def bursts(residual: Array, torque: Array, counts: Marks, t: Array) -> tuple[Interval, ...]:
    """The intervals, in the order of time; none if there is nothing extraordinary.

    Residual and torque (samples, joints) [N m or N], which of them count (samples, joints), and the
    times t (samples) [s].
    """
    block = ((t - t[0]) / BLOCK).astype(np.int64)
    far, near = np.zeros((2, len(t)), dtype=np.bool_)
    for r, y, k in zip(residual.T, torque.T, counts.T, strict=True):
        usual, burst = _of_joint(r[k] ** 2, float(np.sum(y[k] ** 2)), block[k], block[-1] + 1)
        far |= k & burst[block] & (r**2 > FAR * usual)
        near |= k & (r**2 > NEAR * usual)
    blocks = len(np.unique(block[np.any(counts, axis=1)]))
    if not 0 < len(np.unique(block[far])) <= (1.0 - USUAL) * blocks:
        return ()
    parts = [part for part in _parts(np.flatnonzero(near), t, GAP) if far[part].any()]
    parts = _parts(np.concatenate(parts), t, BLOCK)
    return tuple(Interval(float(t[part[0]]), float(t[part[-1]])) for part in parts)


def _parts(at: Numbers, t: Array, gap: float) -> list[Numbers]:
    """The samples `at` in parts with more than a gap [s] between them."""
    return np.split(at, np.flatnonzero(np.diff(t[at]) > gap) + 1)


def _of_joint(squares: Array, torque: float, block: Numbers, blocks: int) -> tuple[float, Marks]:
    """The usual mean square of the residual of a joint, and which blocks are far above it.

    squares (rows) of the residual, the sum of those of the torque, the block of each row and the
    number of blocks. The first is infinite and there are none if these do not hold most of the sum.
    """
    counts, sums = (np.bincount(block, x, blocks) for x in (None, squares))
    nothing = np.inf, np.zeros(blocks, dtype=np.bool_)
    if np.count_nonzero(counts) < FEWEST:
        return nothing
    means = sums / np.maximum(counts, FULL * counts.max())  # a few rows prove nothing
    known = np.sort(means[counts > 0])
    usual = float(known[int(USUAL * (len(known) - 1))])
    burst = (means > FAR * usual) & (means > SIZE**2 * torque / len(squares))
    return (usual, burst) if sums[burst].sum() > SHARE * sums.sum() else nothing
