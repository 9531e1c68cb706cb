"""Whether torques lead the motion as behind a low-pass of first order, or as behind a delay.

To second order the two differ by a multiple of the second derivative of the torques (shifting.py).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.effects.parallel import Window
from scarid_cli.algorithms.regression.rows import Rows, runs
from scarid_cli.algorithms.uncertainty.jackknife import block_numbers
from scarid_cli.algorithms.uncertainty.reversals import away_from_reversals
from scarid_cli.arrays import Array, Numbers

MARGIN = 0.25  # periods of the bandwidth, beyond those that are left out near a reversal


@dataclass(frozen=True)
class Form:
    """How torques lead the motion: by the log-likelihood `ratio` of a low-pass over a delay.

    `share` is the curvature that they have, of that behind a low-pass: 0 behind a delay, 1 behind a
    low-pass, between them behind both.
    """

    ratio: float
    share: float


def form(rows: Rows, bent: Array, residuals: Sequence[Array]) -> Form:
    """The form of the lead, from the residuals behind the delay and behind the low-pass.

    `bent` (samples, joints) is the difference of the two for the predicted torques. What the
    columns of W leave of it is an instrument: no change of the estimates changes its product with
    the residual, whose mean is 0 for the true form. The variance of the sum is that of its blocks
    of half a second.

    All signals pass one window of 0.2 s first, because torques predicted from noisy accelerations
    have a curvature even where the true ones have none; for the same reason the mean squares of the
    residuals would not tell. Rows near those that are left out do not count either: what the
    low-pass of the soft sensor makes of Coulomb friction looks like a curvature.
    """
    counted = away_from_reversals(rows, MARGIN / rows.bandwidth if rows.bandwidth else 0.0) > 0.0
    squares = np.sum(residuals[0] ** 2 * counted, axis=0)
    weights = np.divide(counted.sum(axis=0), squares, np.zeros_like(squares), where=squares > 0.0)
    further = np.stack((bent, *residuals), axis=2)
    scales = (counted * np.sqrt(weights))[:, :, None]
    smooth, at = _smooth(rows, further, scales)
    if not len(at):
        return Form(0.0, 0.0)
    W, others = np.split(smooth.reshape(-1, smooth.shape[2]), [rows.W.shape[2]], axis=1)
    instrument = others[:, 0] - W @ np.linalg.lstsq(W, others[:, 0], rcond=None)[0]
    number, count = block_numbers(at, rows.h)
    of_joints = np.repeat(number, rows.W.shape[1])
    products = [np.bincount(of_joints, e * instrument, count) for e in others[:, 1:].T]
    variance = min(float(x @ x) for x in products)
    delay, low_pass = (float(np.sum(x)) for x in products)
    if not variance or delay == low_pass:
        return Form(0.0, 0.0)
    share = float(np.clip(delay / (delay - low_pass), 0.0, 1.0))
    return Form(0.5 * (delay**2 - low_pass**2) / variance, share)


def _smooth(rows: Rows, further: Array, scales: Array) -> tuple[Array, Numbers]:
    """[W, further columns] (samples, joints, columns), scaled, behind the window; the samples."""
    window = Window.of(rows.h)
    parts = [part for run in runs(rows.at) for part in window.parts(run)]
    smooth = [
        window.passed(np.concatenate((rows.W[part], further[part]), axis=2) * scales[part])
        for part in parts
    ]
    none = np.empty((0, further.shape[1], rows.W.shape[2] + further.shape[2]))
    return np.concatenate([none, *smooth]), rows.at[window.centres_of(parts)]
