"""Euler (backward) difference and a low-pass FIR filter, once for velocity, twice for acceleration.

The paper's ED+FIR: a Hamming window design. Delay: order / 2 samples and half a sample a stage
(27.5 ms for the velocity and 55 ms for the acceleration at 200 Hz). Matched (--match): the velocity
passes both filters, position and torque as well.
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

    def matched(self) -> Matched:
        return Matched(self)


@dataclass(frozen=True)
class MatchedState:
    """The method's own state, and the velocities that the second filter holds."""

    own: Recursion
    line: Array


@dataclass(frozen=True)
class Matched(Causal):
    """The velocity filtered once more, and averaged over the sample that the second step takes."""

    method: Differentiator

    @property
    def companion(self) -> Twice:
        return Twice(self.method)

    def init(self, q: float, h: float) -> MatchedState:
        return MatchedState(self.method.init(q, h), np.zeros(int(self.method.order) + 2))

    def step(self, state: MatchedState, q: Array) -> tuple[MatchedState, Derivatives]:
        own, (once, a) = self.method.step(state.own, q)
        taps = np.convolve(lowpass(int(self.method.order), self.method.cutoff * own.h), [0.5, 0.5])
        line, v = state.line.copy(), np.empty_like(q)
        fir.filtered(once, v, line, taps)
        return MatchedState(own, line), (v, a)


@dataclass(frozen=True)
class Twice:
    """Both filters in a row, and the one sample by which their differences are central."""

    method: Differentiator

    def init(self, x: float, h: float) -> Recursion:
        return Recursion(np.full(2 * int(self.method.order) + 2, x), h)

    def step(self, state: Recursion, x: Array) -> tuple[Recursion, Array]:
        taps = lowpass(int(self.method.order), self.method.cutoff * state.h)
        state, y = state.copy(), np.empty_like(x)
        fir.filtered(x, y, state.values, np.concatenate(([0.0], np.convolve(taps, taps))))
        return state, y


def lowpass(order: int, cutoff: float) -> Array:
    """Taps (order + 1) of a windowed-sinc low-pass of unit gain; cutoff in cycles per sample."""
    n = np.arange(order + 1) - order / 2.0
    taps: Array = np.sinc(2.0 * cutoff * n) * np.hamming(order + 1)
    taps /= taps.sum()
    return taps
