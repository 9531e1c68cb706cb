"""Standard errors from the autocovariance of the residuals, for disturbances that last long.

Blocks of half a second are not independent if a residual keeps its sign for a second or two. The
autocovariance of the residual of each joint at lags from 0.1 to 4 s is fitted by c exp(-lag / T),
less the part that the fit has absorbed (absorption.py). What remains at shorter lags counts as
white noise of the same power at low frequencies. From both follows the covariance of the estimates,
G^-1 (sum of w_k gamma(k - l) w_l') G^-1 (the estimator of Newey and West 1987, with this model in
place of a window).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.algorithms.statistics.absorption import LAGS, absorbed, intervals
from scarid_cli.arrays import Array, Marks, Numbers

BIN = 0.025  # s: residuals and rows are summed over such intervals
SHORT, LONG = 0.1, 4.0  # s: the lags to which the exponential is fitted
TIMES: Array = np.asarray(
    np.geomspace(0.05, LONG, 12), dtype=np.float64
)  # s: the correlation times that are tried


@dataclass(frozen=True)
class Noise:
    """The residual of a joint as white and coloured noise.

    `white` is the variance per row, `coloured` that of the part that decays as exp(-lag / `time`).
    """

    white: float
    coloured: float
    time: float


def autocovariance_errors(rows: Rows, estimates: Array, weights: Array) -> Array:
    """The standard errors (parameters) of least squares with each joint weighted.

    They are nan if the rows do not determine all parameters.
    """
    length = max(1, round(BIN / rows.h)) if rows.h > 0.0 else 1
    bins = intervals(rows.at // length, round(3.0 * LONG / BIN))
    residuals = rows.y - rows.W @ estimates
    parameters = rows.W.shape[2]
    scaled = rows.W * (rows.scales * weights)[:, :, None]
    gram = np.tensordot(scaled, scaled, axes=((0, 1), (0, 1)))
    if np.linalg.matrix_rank(gram, hermitian=True) < parameters:
        return np.full(parameters, np.nan)
    inverse = np.asarray(np.linalg.inv(gram), dtype=np.float64)
    middle = np.zeros((parameters, parameters))
    taken = absorbed(rows, weights, inverse, TIMES.tolist())
    for j, weight in enumerate(weights):
        scales = rows.scales[:, j] * weight
        noise = noise_of(residuals[:, j], scales > 0.0, bins, length * rows.h, taken[j])
        scores = scaled[:, j] * scales[:, None]
        middle += noise.white * scores.T @ scores
        if noise.coloured > 0.0:
            middle += noise.coloured * _correlated(scores, bins, length * rows.h / noise.time)
    return np.asarray(np.sqrt(np.maximum(np.diag(inverse @ middle @ inverse), 0.0)))


def noise_of(residual: Array, counts: Marks, bins: Numbers, h: float, taken: Array) -> Noise:
    """The noise of one joint, from its residual (samples) in bins of h [s].

    Only the samples that count are used. taken (TIMES, LAGS): the part of the autocovariance of
    unit noise that the fit has absorbed.
    """
    size = int(bins[-1]) + 1
    rows = np.bincount(bins, counts, size)
    means = np.bincount(bins, residual * counts, size) / np.maximum(rows, 1.0)
    last = min(round(LONG / h), size // 2)
    first = max(1, round(SHORT / h))
    gamma, pairs = _autocovariance(means, rows > 0.0, last)
    if last <= first or not pairs[0]:
        return Noise(float(np.mean(residual[counts] ** 2)) if counts.any() else 0.0, 0.0, LONG)
    lags = h * np.arange(last + 1, dtype=np.float64)
    shapes = np.exp(-lags / TIMES[:, None]) - [np.interp(lags, LAGS, part) for part in taken]
    coloured, best = _nearest(gamma[first:], pairs[first:], shapes[:, first:])
    short = gamma[:first] - coloured * shapes[best, :first]
    white = max(2.0 * float(short.sum()) - float(short[0]), 0.0)
    return Noise(white * float(np.mean(rows[rows > 0.0])), coloured, float(TIMES[best]))


def _autocovariance(x: Array, known: Marks, last: int) -> tuple[Array, Array]:
    """The mean products of x at lags from 0 to `last`, and the numbers of pairs."""
    marks = known.astype(np.float64)
    size = len(x)
    pairs = np.array([marks[lag:] @ marks[: size - lag] for lag in range(last + 1)])
    sums = np.array([x[lag:] @ x[: size - lag] for lag in range(last + 1)])
    return sums / np.maximum(pairs, 1.0), pairs


def _nearest(gamma: Array, pairs: Array, shapes: Array) -> tuple[float, int]:
    """c and the number of the shape for which c times it is nearest to gamma; c is not < 0."""
    sizes = np.maximum((shapes * pairs) @ gamma / ((shapes**2) @ pairs + 1e-300), 0.0)
    errors = ((gamma - sizes[:, None] * shapes) ** 2) @ pairs
    best = int(np.argmin(errors))
    return float(sizes[best]), best


def _correlated(scores: Array, bins: Numbers, decay: float) -> Array:
    """The sum over all pairs of rows of s_k exp(-decay |bin_k - bin_l|) s_l'."""
    sums = np.zeros((int(bins[-1]) + 1, scores.shape[1]))
    starts = np.flatnonzero(np.diff(bins, prepend=-1))
    sums[bins[starts]] = np.add.reduceat(scores, starts)
    keep, before = np.exp(-decay), np.zeros_like(sums)
    for k in range(1, len(sums)):
        before[k] = keep * (before[k - 1] + sums[k - 1])
    cross = sums.T @ before
    return np.asarray(sums.T @ sums + cross + cross.T)
