"""Whether torques lead the motion as behind a low-pass of first order, or as behind a delay.

The two differ by a multiple of the second derivative of the torques (shifting.py).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from scarid_cli.algorithms.regression.rows import Rows, runs
from scarid_cli.algorithms.statistics.alternatives import hann
from scarid_cli.algorithms.statistics.jackknife import block_numbers
from scarid_cli.arrays import Array


def log_likelihood_ratio(rows: Rows, bent: Array, residuals: Sequence[Array]) -> float:
    """Of a low-pass over a delay, from the residuals behind the delay and behind the low-pass.

    `bent` (samples, joints) is in proportion to the curvature of the predicted torques, with which
    the residual of the true form is uncorrelated. The sum of their products has the variance of its
    blocks of half a second. The mean squares of the residuals would not tell, because the torques
    that are predicted from noisy accelerations have a curvature even where the true ones have none.
    """
    counted = rows.scales > 0.0
    squares = np.sum(residuals[0] ** 2 * counted, axis=0)
    with np.errstate(divide="ignore"):
        weights = counted * np.where(squares > 0.0, counted.sum(axis=0) / squares, 0.0)
    instrument = weights * _smooth(rows, bent)
    number, count = block_numbers(rows.at, rows.h)
    products = [np.bincount(number, np.sum(e * instrument, axis=1), count) for e in residuals]
    variance = min(float(x @ x) for x in products)
    delay, low_pass = (float(np.sum(x)) ** 2 for x in products)
    return 0.5 * (delay - low_pass) / variance if variance > 0.0 else 0.0


def _smooth(rows: Rows, x: Array) -> Array:
    """The signals x (samples, joints) behind a Hann window, 0 in runs that are shorter."""
    taps = hann(rows.h)
    found = np.zeros_like(x)
    for run in runs(rows.at):
        if run.stop - run.start >= len(taps):
            found[run] = np.stack([np.convolve(y, taps, "same") for y in x[run].T], 1)
    return found
