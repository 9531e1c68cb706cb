"""Residuals that are correlated in time, and rows whitened by their autocovariance.

Disturbances that last (friction that drifts, a cable, a base that vibrates) hold most of their
power at a few frequencies. Generalised least squares gives little weight to these. The noise of a
joint is taken to be stationary, with the autocovariance of its residual (Parzen 1961, whose window
it passes). Rows are whitened by what the rows before them predict (Levinson 1947, Durbin 1960),
from the start of each run without a gap on.

A soft sensor passes nothing above its bandwidth, where the residuals are small, and whitening would
amplify what is left there of the noise of positions. Therefore white noise is added beyond the
bandwidth, of BEYOND times the mean density within it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from scarid_cli.algorithms.filters.two_sided import two_sided_bandwidth, two_sided_gain
from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.arrays import Array, Marks, Numbers

RATE = 4.0  # rows per period of the bandwidth: more hold nothing that is new
SHARE = 0.05  # of the record, up to which the autocovariance is estimated
LONGEST = 2.0  # s, of its lags
MOST = 64  # rows that predict the next one
BEYOND = 3.0
ORDER = 4  # of the Butterworth low-pass, forwards and backwards, that stands for any soft sensor
CUTOFF = 1.0 / two_sided_bandwidth(ORDER)  # of one pass, over the bandwidth of both
POINTS = 512  # frequencies at which it is integrated
UNPREDICTABLE = 1e-3  # of the variance, that of noise that is white for certain
CHUNK = 64  # rows that are whitened by one matrix product


@dataclass(frozen=True)
class ColouredNoise:
    """The autocovariance (joints, lags) of the residual of each joint, at lags of h [s] from 0 on.

    `bandwidth` [Hz] is that of the soft sensor behind the rows.
    """

    autocovariance: Array
    h: float
    bandwidth: float

    @classmethod
    def of(cls, rows: Rows, estimates: Array) -> ColouredNoise:
        """From the residuals of the rows that count."""
        bandwidth = min(rows.bandwidth or np.inf, 0.5 / rows.h)
        counts = (rows.scales > 0.0).T
        residuals = (rows.y - rows.W @ estimates).T * counts
        length = int(rows.at[-1] - rows.at[0]) + 1
        lags = max(2, int(min(LONGEST / rows.h, SHARE * length)))
        grid = np.zeros((len(residuals), length))
        grid[:, rows.at - rows.at[0]] = residuals
        products = _products(grid, lags) / np.maximum(counts.sum(axis=1), 1)[:, None]
        return cls(products * _parzen(lags), rows.h, bandwidth)

    @property
    def step(self) -> int:
        """The number of samples from one whitened row to the next."""
        return max(1, int(1.0 / (RATE * self.bandwidth * self.h)))

    def kept(self, rows: Rows) -> Numbers:
        """The places of the rows that are kept."""
        apart = max(1, int(self.step * self.h / rows.h + 1e-9))
        return np.flatnonzero(rows.at % apart == 0)

    def rows(self, rows: Rows) -> Rows:
        """Every `step`-th of the rows, whitened."""
        kept = self.kept(rows)
        part = rows if len(kept) == rows.samples else rows.part(kept)
        W, y = np.empty_like(part.W), np.empty_like(part.y)
        for j, white in enumerate(self._filters(part.scales > 0.0, part.at, part.h)):
            both = white(np.column_stack((part.W[:, j], part.y[:, j])))
            W[:, j], y[:, j] = both[:, :-1], both[:, -1]
        return replace(part, W=W, y=y)

    def whitened(self, A: Array, counts: Marks, at: Numbers, h: float) -> Array:
        """A (samples, joints, columns) with unit white noise, 0 where a row does not count.

        `at` (samples) are the numbers of the samples in units of h [s]; the least distance of two
        is that of rows which follow each other. A is large, and is overwritten.
        """
        for j, white in enumerate(self._filters(counts, at, h)):
            A[:, j] = white(np.ascontiguousarray(A[:, j]))
        return A

    def _filters(self, counts: Marks, at: Numbers, h: float) -> Iterator[Callable[[Array], Array]]:
        """What whitens the rows (samples, columns) of each joint."""
        distances = np.diff(at)
        least = int(distances.min(initial=len(at)))
        step = max(1, round(least * h / self.h))
        follows = np.append(False, distances == least)
        for j, covariance in enumerate(self._covariances(step)):
            predictors, deviations = _levinson(covariance)
            before = _before(counts[:, j], follows, len(covariance) - 1)
            scales = counts[:, j] / deviations[before]
            yield partial(_filtered, factors=predictors[before], scales=scales)

    def _covariances(self, step: int) -> Array:
        """The autocovariances (joints, lags) of rows that are `step` samples apart."""
        own = self.autocovariance[:, ::step][:, : MOST + 1]
        interval = step * self.h
        f = (np.arange(POINTS) + 0.5) / POINTS * 0.5 / interval
        passed = two_sided_gain(f / (CUTOFF * self.bandwidth), ORDER) ** 2
        lags = 2.0 * np.pi * interval * np.outer(np.arange(own.shape[1]), f)
        beyond = np.cos(lags) @ (1.0 - passed) / passed.sum()
        total = own + BEYOND * own[:, :1] * beyond
        total[:, 0] *= 1.0 + UNPREDICTABLE
        return np.where(own[:, :1] > 0.0, total, np.eye(1, own.shape[1]))


def _products(x: Array, lags: int) -> Array:
    """The sums over k of x(k) x(k + lag) (rows, lags) of each row of x, at lags from 0 on."""
    size = 1 << int(x.shape[1] + lags).bit_length()
    power = np.abs(np.fft.rfft(x, size)) ** 2
    return np.asarray(np.fft.irfft(power, size)[:, :lags])


def _parzen(lags: int) -> Array:
    """The window that keeps an autocovariance positive and its spectrum smooth (lags)."""
    x = np.arange(lags) / lags
    return np.where(x < 0.5, 1.0 - 6.0 * x**2 * (1.0 - x), 2.0 * (1.0 - x) ** 3)


def _levinson(covariance: Array) -> tuple[Array, Array]:
    """The best predictions from 0, 1, ... rows before, and the standard deviations of their errors.

    Row m (lags, lags - 1) has the factors of the m rows before, the last one first.
    """
    lags = len(covariance)
    predictors, variances = np.zeros((lags, lags - 1)), np.empty(lags)
    variances[0], last = covariance[0], np.empty(0)
    for m in range(1, lags):
        reflected = (covariance[m] - last @ covariance[m - 1 : 0 : -1]) / variances[m - 1]
        last = np.append(last - reflected * last[::-1], reflected)
        predictors[m, :m], variances[m] = last, variances[m - 1] * (1.0 - reflected**2)
    return predictors, np.sqrt(variances)


def _before(counts: Marks, follows: Marks, most: int) -> Numbers:
    """How many rows that count are directly before each row (samples), at most so many."""
    broken = ~follows
    broken[1:] |= ~counts[:-1]
    at = np.arange(len(counts))
    start = np.maximum.accumulate(np.where(broken, at, 0))
    return np.minimum(at - start, most)


def _filtered(A: Array, factors: Array, scales: Array) -> Array:
    """The rows of A (samples, columns) less factors (samples, lags) times the rows before, scaled.

    The rows of a chunk are one product with a matrix that has the factors beside its diagonal.
    """
    lags, white = factors.shape[1], np.empty_like(A)
    padded = np.concatenate((np.zeros((lags, A.shape[1])), A))
    for first in range(0, len(A), CHUNK):
        own = factors[first : first + CHUNK]
        each = np.arange(len(own))[:, None]
        matrix = np.zeros((len(own), len(own) + lags))
        matrix[each, each + lags - 1 - np.arange(lags)] = -own
        matrix[each, each + lags] = 1.0
        matrix *= scales[first : first + CHUNK, None]
        white[first : first + CHUNK] = matrix @ padded[first : first + len(own) + lags]
    return white
