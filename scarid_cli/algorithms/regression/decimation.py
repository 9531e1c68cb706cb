"""Decimation with parallel filtering: every column of W and the torque by the same low-pass.

As MATLAB's `decimate`: Chebyshev type I of order 8, ripple 0.05 dB, cut-off 0.8 of the new Nyquist
frequency, forwards and backwards; of the samples every N-th is kept, the last among them.
"""

from __future__ import annotations

import numpy as np
from scipy.signal import cheby1, sosfiltfilt

from scarid_cli.algorithms.regression.rows import Rows, joined, runs
from scarid_cli.arrays import Array

ORDER = 8
RIPPLE = 0.05  # dB
CUTOFF = 0.8  # of the new Nyquist frequency
PADDING = 3 * ORDER


def decimated(rows: Rows, factor: int) -> Rows:
    """Every `factor`-th sample after the low-pass; each run of the record by itself.

    Runs too short for the filter's padding are left out; `at` counts in the new samples.
    """
    sections = cheby1(ORDER, RIPPLE, CUTOFF / factor, output="sos")
    parts = []
    for run in runs(rows.at):
        part = rows.part(run)
        if part.samples > PADDING:
            parts.append(_decimated(part, factor, sections))
    return joined(parts) if parts else rows.part(slice(0, 0))


def _decimated(rows: Rows, factor: int, sections: Array) -> Rows:
    kept = slice((rows.samples - 1) % factor, None, factor)

    def lowpassed(x: Array, axis: int) -> Array:
        smooth = sosfiltfilt(sections, x, axis=axis, padlen=PADDING)
        return np.ascontiguousarray(np.take(smooth, range(rows.samples)[kept], axis=axis))

    return Rows(
        W=lowpassed(rows.W, 0),
        y=lowpassed(rows.y, 0),
        scales=np.ascontiguousarray(rows.scales[kept]),
        at=rows.at[kept] // factor,
        h=rows.h * factor,
        motion=lowpassed(rows.motion, 2),
        reference=None if rows.reference is None else rows.reference[:, :, kept],
    )
