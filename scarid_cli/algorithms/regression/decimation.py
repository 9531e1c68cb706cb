"""Decimation with parallel filtering: every column of W and the torques pass the same low-pass.

The filter is that of MATLAB's `decimate`: Chebyshev type I of order 8 with a ripple of 0.05 dB and
a cut-off at 0.8 of the new Nyquist frequency, run forwards and backwards. Then every N-th sample is
kept, counted back from the last one.
"""

from __future__ import annotations

import numpy as np
from scipy.signal import cheby1, sosfiltfilt

from scarid_cli.algorithms.regression.counting import CUTOFF_OF_NYQUIST
from scarid_cli.algorithms.regression.rows import Rows, joined, runs
from scarid_cli.arrays import Array
from scarid_cli.errors import TooShort

ORDER = 8
RIPPLE = 0.05  # dB
PADDING = 3 * ORDER


def decimated(rows: Rows, factor: int) -> Rows:
    """Every `factor`-th sample after the low-pass, which filters each run between gaps by itself.

    Runs that are too short for the padding of the filter are left out; `at` numbers the new
    samples.
    """
    if factor >= max(rows.samples, 2):
        raise TooShort(
            f"one row in {factor:.12g} of a log of {rows.samples} is none; give a longer log"
        )
    sections = cheby1(ORDER, RIPPLE, CUTOFF_OF_NYQUIST / factor, output="sos")
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
        bandwidth=min(rows.bandwidth or np.inf, CUTOFF_OF_NYQUIST * 0.5 / (rows.h * factor)),
    )
