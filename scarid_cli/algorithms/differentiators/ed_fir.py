"""Euler (backward) difference and a low-pass FIR filter, once for velocity, twice for acceleration.

The paper's ED+FIR: a Hamming window design. Delay: order / 2 samples and half a sample a stage
(27.5 ms for the velocity and 55 ms for the acceleration at 200 Hz).
order = 10, cutoff = 5 [Hz]: as in Table 1. So short a filter is -3 dB at 12.8 Hz, not at 5 Hz.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.recursion import Causal, Derivatives, Recursion
from scarid_cli.algorithms.settings import require_positive
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault
from scarid_cli.kernels import fir


@dataclass(frozen=True)
class Differentiator(Causal):
    order: int = 10
    cutoff: float = 5.0

    PRESETS: ClassVar = {"table1": {}}

    def __post_init__(self) -> None:
        require_positive(self, "order", "cutoff")
        if self.order != int(self.order):
            raise UsageFault(f"order must be a whole number, not {self.order:g}")

    def init(self, q: float, h: float) -> Recursion:
        if self.cutoff * h >= 0.5:
            raise UsageFault(
                f"cutoff {self.cutoff:g} Hz is not below half the rate, {0.5 / h:g} Hz"
            )
        lines = np.zeros((2, int(self.order) + 2))
        lines[0, -1] = q
        return Recursion(lines, h)

    def step(self, state: Recursion, q: Array) -> tuple[Recursion, Derivatives]:
        state = state.copy()
        v, a = np.empty_like(q), np.empty_like(q)
        taps = lowpass(int(self.order), self.cutoff * state.h)
        fir.differentiate(q, v, state.values[0], taps, state.h)
        fir.differentiate(v, a, state.values[1], taps, state.h)
        return state, (v, a)


def lowpass(order: int, cutoff: float) -> Array:
    """Taps (order + 1) of a windowed-sinc low-pass of unit gain; cutoff in cycles per sample."""
    n = np.arange(order + 1) - order / 2.0
    taps: Array = np.sinc(2.0 * cutoff * n) * np.hamming(order + 1)
    taps /= taps.sum()
    return taps
