"""The two-sided low-pass behind rows, by itself."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.filters.two_sided import (
    PERIODS,
    two_sided_bandwidth,
    two_sided_gain,
)
from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.arrays import Array


@dataclass(frozen=True)
class LowPass:
    """A Butterworth filter, forwards and backwards; the cut-off in cycles per sample."""

    cutoff: float
    order: int

    @classmethod
    def behind(cls, rows: Rows) -> LowPass | None:
        """The one behind the rows; None if it is not known to be such a filter, or passes all."""
        if not (rows.order and rows.bandwidth and rows.h > 0.0):
            return None
        cutoff = rows.bandwidth / two_sided_bandwidth(rows.order)
        return cls(cutoff * rows.h, rows.order) if cutoff * rows.h < 0.5 else None

    def over(self, x: Array) -> Array:
        """x (samples of a run, ...) behind the filter, as if its first and last value went on."""
        edge, rest = int(PERIODS / self.cutoff) + 1, x.ndim - 1
        length = 1 << (len(x) + 2 * edge - 1).bit_length()
        padded = np.pad(x, [(edge, length - len(x) - edge), *[(0, 0)] * rest], mode="edge")
        gain = two_sided_gain(np.asarray(np.fft.rfftfreq(length)) / self.cutoff, self.order)
        spectrum = gain.reshape(-1, *[1] * rest) * np.fft.rfft(padded, axis=0)
        return np.asarray(np.fft.irfft(spectrum, length, axis=0)[edge : edge + len(x)])
