"""The window that smooths all signals, and the rows within it of a reversal."""

from __future__ import annotations

import numpy as np

from scarid_cli.algorithms.regression.rows import Rows, runs
from scarid_cli.arrays import Array

WINDOW = 0.2  # s: length of the Hann window that smooths all signals


def hann(h: float) -> Array:
    """The taps of the window for rows that are h [s] apart; their sum is 1."""
    taps = np.hanning(2 * round(0.5 * WINDOW / h) + 3)[1:-1] if h > 0.0 else np.ones(1)
    return np.asarray(taps / taps.sum())


def away_from_reversals(rows: Rows, within: float = 0.5 * WINDOW) -> Array:
    """The scales of the rows, 0 `within` this time [s] of a reversal or of a row left out."""
    half = max(1, round(within / rows.h)) if rows.h > 0.0 else 1
    scales = np.zeros_like(rows.scales)
    for run in runs(rows.at):
        direction = np.sign(rows.motion[1][:, run].T) * (rows.scales[run] > 0.0)
        scales[run] = rows.scales[run] * _constant(direction, half)
    return scales


def _constant(x: Array, half: int) -> Array:
    """Whether x (samples, joints) is the same, and not 0, in a window around each sample."""
    samples = len(x)
    changes = (x == 0.0).astype(np.int64)
    changes[1:] += x[1:] != x[:-1]
    sums = np.concatenate((np.zeros((1, x.shape[1]), dtype=np.int64), np.cumsum(changes, axis=0)))
    at = np.arange(samples)
    inside = (at >= half) & (at < samples - half)
    end, start = np.minimum(at + half + 1, samples), np.maximum(at - half, 0)
    still: Array = (sums[end] - sums[start] == 0) & inside[:, None]
    return still
