"""Savitzky-Golay: the polynomial that fits the window around each sample best.

Fixed lag of half a window; at both ends of the record the polynomial of the first or the last whole
window is evaluated. Savitzky and Golay, Anal. Chem. 36 (1964) 1627; the same as
scipy.signal.savgol_filter.
Delay: none beyond the wait.
Matched (exact): position and torque pass the symmetric low-pass of which the acceleration is the
second difference.
Rule: choose the longest window over which the motion is nearly a polynomial.
window = 81: length in samples, odd.
degree = 5: degree of the polynomial, at least 2 and below the window.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.choices.ranges import Range
from scarid_cli.algorithms.choices.settings import require_odd
from scarid_cli.algorithms.filters.convolution import LowpassMethod, convolved, integrated
from scarid_cli.algorithms.filters.polynomials import derivative_taps, require_window
from scarid_cli.arrays import Array
from scarid_cli.errors import TooShort


@dataclass(frozen=True)
class WindowState:
    """The last samples, a window of them once it is full, and the sampling period [s]."""

    samples: Array
    h: float


@dataclass(frozen=True)
class Differentiator(LowpassMethod):
    window: int = 81
    degree: int = 5

    TUNED: ClassVar = {"window": Range(0.05, 1.5, samples=True, step=2)}

    def check(self) -> None:
        require_window(self)
        require_odd(self, "window")

    @property
    def half(self) -> int:
        """The samples on either side of the middle of the window."""
        return self.window // 2

    def lag(self, h: float) -> float:  # noqa: ARG002 (in samples)
        return self.half

    def lowpass(self, h: float) -> Array:
        return integrated(self._fit(self.half, h)[1], 2, h)

    def init(self, x: float, h: float) -> WindowState:  # noqa: ARG002 (the first step brings it)
        return WindowState(np.empty(0), h)

    def step(self, state: WindowState, x: Array) -> tuple[WindowState, tuple[Array, ...]]:
        full = len(state.samples) == self.window
        samples = np.concatenate((state.samples, x))
        after = WindowState(samples[-self.window :], state.h)
        if len(samples) < self.window:
            return after, (np.empty(0), np.empty(0))
        middle = [convolved(samples[full:], taps) for taps in self._fit(self.half, state.h)]
        if full:
            return after, tuple(middle)
        early = range(self.window - 1, self.half, -1)
        first = self._edge(samples[: self.window], early, state.h)
        return after, tuple(np.concatenate(pair) for pair in zip(first, middle, strict=True))

    def finish(self, state: WindowState) -> tuple[Array, ...]:
        if len(state.samples) < self.window:
            raise TooShort(
                f"window of {self.window:g} samples is longer than the log of "
                f"{len(state.samples)} rows"
            )
        return self._edge(state.samples, range(self.half - 1, -1, -1), state.h)

    def _edge(self, window: Array, ages: range, h: float) -> tuple[Array, ...]:
        """The derivatives at samples of the window other than the middle one."""
        fits = [self._fit(age, h) for age in ages]
        return tuple(
            np.array([convolved(window, taps)[0] for taps in rows])
            for rows in zip(*fits, strict=True)
        )

    def _fit(self, age: int, h: float) -> list[Array]:
        """The taps of velocity and acceleration at the sample `age` periods ago."""
        return [derivative_taps(self.window, self.degree, order, age, h) for order in (1, 2)]
