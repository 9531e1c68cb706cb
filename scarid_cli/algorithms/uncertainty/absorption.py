"""What a fit takes out of the autocovariance of its residuals.

The residuals are r = e - X G^-1 S' e: the noise e less the part that the estimates follow, with the
regressor X, the scores S and their product G. Slow noise is followed best, so the residuals of a
short log are smaller, and forget sooner, than the noise. For noise of unit variance that decays as
exp(-lag / T), the expected autocovariance of the residuals is exp(-lag / T) less the part

    X G^-1 S' R + R S G^-1 X' - X G^-1 S' R S G^-1 X'     with R = exp(-|lag| / T)

whose mean over all pairs of rows with the same lag is computed here, from rows that are summed over
a tenth of a second.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.arrays import Array, Marks, Numbers

INTERVAL = 0.1  # s: rows are summed over such intervals
MOST = 600  # intervals: those of longer logs, whose fit absorbs little, are longer
LAGS = np.array([0.0, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0])  # s


def absorbed(rows: Rows, weights: Array, inverse: Array, times: Sequence[float]) -> Array:
    """The part that the fit absorbs (joints, times, LAGS) of noise with these correlation times.

    inverse: G^-1 of the rows, each joint weighted by `weights`. The noise of each joint is taken to
    be as large as its weight says, and of the same correlation time in all joints.
    """
    sums = _Sums.of(rows, weights)
    followed = sums.means @ inverse
    parts = [list(sums.taken(followed, time)) for time in times]
    return np.array(parts).transpose(2, 0, 1)


@dataclass(frozen=True)
class _Sums:
    """Sums of the scores and means of the rows (intervals, joints, parameters) in intervals of h.

    `known` (intervals, joints) tells which of them have rows that count.
    """

    scores: Array
    means: Array
    known: Marks
    h: float

    @classmethod
    def of(cls, rows: Rows, weights: Array) -> _Sums:
        longest = int(rows.at[-1] - rows.at[0]) // MOST + 1
        length = max(longest, round(INTERVAL / rows.h)) if rows.h > 0.0 else 1
        h = length * rows.h
        numbers = intervals(rows.at // length, round(3.0 * LAGS[-1] / h) if h > 0.0 else 1)
        counts = (rows.scales > 0.0).astype(np.float64)
        count = summed(counts, numbers)
        scores = _summed_of_joints(rows.W, rows.scales**2 * weights, numbers)
        means = _summed_of_joints(rows.W, counts * weights, numbers)
        return cls(scores, means / np.maximum(count, 1.0)[:, :, None], count > 0.0, h)

    def taken(self, followed: Array, time: float) -> Iterator[Array]:
        """The part of the autocovariance (joints) that is taken out at each lag."""
        smooth = self._correlated(np.exp(-self.h / time))
        product = np.tensordot(self.scores, smooth, axes=((0, 1), (0, 1)))
        again = followed @ product
        for lag in np.round(LAGS / self.h).astype(int).tolist():
            n = max(len(smooth) - lag, 0)
            pairs = self.known[:n] & self.known[lag : lag + n]
            early, late = slice(0, n), slice(lag, lag + n)
            part = _dot(followed[early], smooth[late]) + _dot(followed[late], smooth[early])
            part -= _dot(again[early], followed[late])
            yield np.sum(part * pairs, axis=0) / np.maximum(pairs.sum(axis=0), 1)

    def _correlated(self, keep: float) -> Array:
        """The sum over l of keep^|k - l| times the scores of interval l, for each interval k."""
        before, after = decayed(self.scores, keep), decayed(self.scores[::-1], keep)[::-1]
        return np.asarray(before + self.scores + after)


def _summed_of_joints(W: Array, scales: Array, numbers: Numbers) -> Array:
    """The sums of the scaled rows, joint by joint: a copy of W would be large."""
    joints = enumerate(scales.T)
    return np.stack([summed(W[:, j] * own[:, None], numbers) for j, own in joints], axis=1)


def summed(x: Array, numbers: Numbers) -> Array:
    """The sums of the rows of x with each of these ascending numbers, from 0."""
    starts = np.flatnonzero(np.diff(numbers, prepend=-1))
    sums = np.zeros((int(numbers[-1]) + 1, *x.shape[1:]))
    sums[numbers[starts]] = np.add.reduceat(x, starts)
    return sums


def decayed(x: Array, keep: float) -> Array:
    """The sum of keep^(k - l) x[l] over all l before k, for each k."""
    before = np.zeros_like(x)
    for k in range(1, len(x)):
        before[k] = keep * (before[k - 1] + x[k - 1])
    return before


def _dot(a: Array, b: Array) -> Array:
    return np.asarray(np.einsum("kjp,kjp->kj", a, b))


def intervals(numbers: Numbers, longest: int) -> Numbers:
    """The numbers from 0, without gaps that are longer than so many."""
    return np.cumsum(np.minimum(np.diff(numbers, prepend=numbers[0]), longest))
