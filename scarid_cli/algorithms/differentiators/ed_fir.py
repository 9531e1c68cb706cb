"""Euler (backward) difference and FIR low-pass: once for velocity, twice for acceleration.

Causal. The paper's ED+FIR, with a Hamming window design.
Delay: order / 2 samples and half a sample per stage, at 200 Hz 27.5 ms for the velocity and 55 ms
for the acceleration.
Matched (exact): the velocity passes both filters, as position and torque do.
Rule: choose the cutoff a little above the fastest motion. The filter reaches it only with an order
of about 3.3 rate / cutoff.
order = 10, cutoff = 5 [Hz]: as in Table 1 of the paper. So short a filter is -3 dB at 12.8 Hz, not
at 5 Hz.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.choices.ranges import Range
from scarid_cli.algorithms.choices.settings import require_below_nyquist, require_positive
from scarid_cli.algorithms.filters.convolution import FirMethod
from scarid_cli.arrays import Array


@dataclass(frozen=True)
class Differentiator(FirMethod):
    order: int = 10
    cutoff: float = 5.0

    PRESETS: ClassVar = {"table1": {}}
    TUNED: ClassVar = {"order": Range(0.02, 0.5, samples=True, step=1), "cutoff": Range(1.0, 50.0)}

    def check(self) -> None:
        require_positive(self, "order", "cutoff")

    def taps(self, h: float) -> tuple[Array, ...]:
        stage = np.convolve(self._stage(h), [1.0, -1.0]) / h
        twice = np.convolve(stage, stage)
        return np.concatenate((stage, np.zeros(len(twice) - len(stage)))), twice

    def lowpass(self, h: float) -> Array:
        return np.convolve(self._stage(h), self._stage(h))

    def _stage(self, h: float) -> Array:
        require_below_nyquist(self.cutoff, h)
        return lowpass(self.order, self.cutoff * h)


def lowpass(order: int, cutoff: float) -> Array:
    """The taps (order + 1) of a windowed-sinc low-pass of unit gain.

    cutoff: in cycles per sample.
    """
    n = np.arange(order + 1) - order / 2.0
    taps: Array = np.sinc(2.0 * cutoff * n) * np.hamming(order + 1)
    taps /= taps.sum()
    return taps
