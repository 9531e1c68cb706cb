"""Standard errors from the autocovariance of the residuals, for disturbances that last long.

Blocks of half a second are not independent if a residual keeps its sign for a second or two. The
autocovariance of the residual of each joint at lags from 0.1 to 4 s is fitted by c exp(-lag / T),
less the part that the fit has absorbed (absorption.py). What remains at shorter lags counts as
white noise of the same power at low frequencies. From both follows the covariance of the estimates,
G^-1 (sum of w_k gamma(k - l) w_l') G^-1 (the estimator of Newey and West 1987, with this model in
place of a window).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.algorithms.uncertainty.absorption import LAGS, absorbed, decayed, intervals, summed
from scarid_cli.arrays import Array, Marks, Numbers

BIN = 0.025  # s: residuals and rows are summed over such intervals
SHORT, LONG = 0.1, 4.0  # s: the lags to which the exponential is fitted
TIMES: Array = np.asarray(
    np.geomspace(0.05, LONG, 12), dtype=np.float64
)  # s: the correlation times that are tried
FEWEST = 4.0  # degrees of freedom of the variance of slow noise, however short the record


@dataclass(frozen=True)
class Noise:
    """The residual of a joint as white and coloured noise.

    `white` is the variance per row, `coloured` that of the part that decays as exp(-lag / `time`).
    """

    white: float
    coloured: float = 0.0
    time: float = LONG


def autocovariance_errors(rows: Rows, estimates: Array, weights: Array) -> Array:
    """The standard errors (parameters) of least squares with each joint weighted.

    They are nan if the rows do not determine all parameters.
    """
    length = max(1, round(BIN / rows.h)) if rows.h > 0.0 else 1
    bins = intervals(rows.at // length, round(3.0 * LONG / BIN))
    residuals = rows.y - rows.W @ estimates
    parameters = rows.W.shape[2]
    scales = rows.scales * weights
    gram = np.zeros((parameters, parameters))
    for j, own in enumerate(scales.T):  # joint by joint: a copy of W would be large
        scaled = rows.W[:, j] * own[:, None]
        gram += scaled.T @ scaled
    size = np.sqrt(np.diag(gram))  # in any unit of the torques: that of a delay is one per second
    alike = gram / np.outer(size, size) if size.all() else np.zeros_like(gram)
    if np.linalg.matrix_rank(alike, hermitian=True) < parameters:
        return np.full(parameters, np.nan)
    inverse = np.asarray(np.linalg.inv(alike) / np.outer(size, size), dtype=np.float64)
    middle = np.zeros((parameters, parameters))
    taken = absorbed(rows, weights, inverse, TIMES.tolist())
    noises = noises_of(residuals, scales > 0.0, bins, length * rows.h, taken)
    for j, noise in enumerate(noises):
        scores = rows.W[:, j] * (scales[:, j] ** 2)[:, None]
        middle += noise.white * scores.T @ scores
        if noise.coloured > 0.0:
            middle += noise.coloured * _correlated(scores, bins, length * rows.h / noise.time)
    return np.asarray(np.sqrt(np.maximum(np.diag(inverse @ middle @ inverse), 0.0)))


def noises_of(
    residuals: Array, counts: Marks, bins: Numbers, h: float, taken: Array
) -> list[Noise]:
    """The noise of each joint, from the residuals (samples, joints) in bins of h [s].

    Only the samples that count are used. taken (joints, TIMES, LAGS): the part of the
    autocovariance of unit noise that the fit has absorbed.

    A record of a few correlation times often shows no slow noise in a joint that has it. Therefore
    each joint is given at least as much of it, relative to its residual, as the joints have on
    average.
    """
    last, first = min(round(LONG / h), int(bins[-1] + 1) // 2), max(1, round(SHORT / h))
    if last <= first:
        squares = np.sum(residuals**2 * counts, axis=0) / np.maximum(counts.sum(axis=0), 1)
        return [Noise(float(square)) for square in squares]
    joints = zip(residuals.T, counts.T, taken, strict=True)
    seen = [_Seen.of(*joint, bins, h, last) for joint in joints]
    noisy = [one for one in seen if one.gamma[0] > 0.0]
    least = _common(noisy).slow(first) if noisy else _Slow(0.0, 0)
    return [one.noise(first, least) for one in seen]


@dataclass(frozen=True)
class _Slow:
    """A part of an autocovariance that decays with TIMES[`number`]."""

    variance: float
    number: int

    @property
    def power(self) -> float:
        """Its power at low frequencies."""
        return self.variance * float(TIMES[self.number])


@dataclass(frozen=True)
class _Seen:
    """The autocovariance `gamma` (lags) of a residual, from so many `pairs` of bins of h [s].

    Slow noise of unit variance is expected to leave `shapes` (TIMES, lags) of it. A bin has so many
    `rows`.
    """

    gamma: Array
    pairs: Array
    shapes: Array
    rows: float
    h: float

    @classmethod
    def of(
        cls, residual: Array, counts: Marks, taken: Array, bins: Numbers, h: float, last: int
    ) -> _Seen:
        """At lags from 0 to `last` bins."""
        size = int(bins[-1]) + 1
        rows = np.bincount(bins, counts, size)
        means = np.bincount(bins, residual * counts, size) / np.maximum(rows, 1.0)
        gamma, pairs = _autocovariance(means, rows > 0.0, last)
        lags = h * np.arange(last + 1, dtype=np.float64)
        shapes = np.exp(-lags / TIMES[:, None]) - [np.interp(lags, LAGS, part) for part in taken]
        return cls(gamma, pairs, shapes, float(counts.sum()) / max(pairs[0], 1.0), h)

    def slow(self, first: int) -> _Slow:
        """The part from the lag `first` on: the multiple of a shape that is nearest to it."""
        gamma, pairs, shapes = self.gamma[first:], self.pairs[first:], self.shapes[:, first:]
        sizes = np.maximum((shapes * pairs) @ gamma / ((shapes**2) @ pairs + 1e-300), 0.0)
        best = int(np.argmin(((gamma - sizes[:, None] * shapes) ** 2) @ pairs))
        return _Slow(float(sizes[best]), best)

    def noise(self, first: int, least: _Slow) -> Noise:
        """White and slow noise; the latter has at least this power, relative to the residual."""
        least = _Slow(least.variance * float(self.gamma[0]), least.number)
        slow = max(self.slow(first), least, key=lambda one: one.power)
        short = self.gamma[:first] - slow.variance * self.shapes[slow.number, :first]
        white = max(2.0 * float(short.sum()) - float(short[0]), 0.0)
        time = float(TIMES[slow.number])
        return Noise(white * self.rows, self.unknown(time) * slow.variance, time)

    def unknown(self, time: float) -> float:
        """How many times as large the variance of slow noise is, on average, as it seems.

        That of noise with the correlation time T has nu = duration / T degrees of freedom, with
        which the mean of the variances that may have led to the one that is seen is nu / (nu - 2)
        of it.
        """
        freedom = max(float(self.pairs[0]) * self.h / time, FEWEST)
        return freedom / (freedom - 2.0)


def _common(seen: list[_Seen]) -> _Seen:
    """The mean over joints of what is seen of them, relative to the variance of each."""
    parts = [(one.gamma / one.gamma[0], one.pairs, one.shapes) for one in seen]
    gamma, pairs, shapes = (np.mean(part, axis=0) for part in zip(*parts, strict=True))
    return replace(seen[0], gamma=gamma, pairs=pairs, shapes=shapes)


def _autocovariance(x: Array, known: Marks, last: int) -> tuple[Array, Array]:
    """The mean products of x at lags from 0 to `last`, and the numbers of pairs."""
    marks = known.astype(np.float64)
    size = len(x)
    pairs = np.array([marks[lag:] @ marks[: size - lag] for lag in range(last + 1)])
    sums = np.array([x[lag:] @ x[: size - lag] for lag in range(last + 1)])
    return sums / np.maximum(pairs, 1.0), pairs


def _correlated(scores: Array, bins: Numbers, decay: float) -> Array:
    """The sum over all pairs of rows of s_k exp(-decay |bin_k - bin_l|) s_l'."""
    sums = summed(scores, bins)
    cross = sums.T @ decayed(sums, float(np.exp(-decay)))
    return np.asarray(sums.T @ sums + cross + cross.T)
