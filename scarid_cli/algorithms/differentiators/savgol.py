"""Savitzky-Golay: the polynomial that fits the window around each sample best.

Fixed lag of half a window; at both ends of the record the first and the last window serve. Savitzky
and Golay, Anal. Chem. 36 (1964) 1627; the same as scipy.signal.savgol_filter. No delay. Matched
(--match, exact): position and torque pass the symmetric low-pass whose second difference the
acceleration is. Rule: the longest window over which the motion is nearly a polynomial.
window = 81: samples, odd.
degree = 5: of the polynomial, 2 or more and below the window.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.choices.ranges import Range
from scarid_cli.algorithms.choices.settings import require_odd
from scarid_cli.algorithms.filters.convolution import FirMethod, convolved, integrated
from scarid_cli.algorithms.filters.polynomials import derivative_taps, require_window
from scarid_cli.arrays import Array
from scarid_cli.errors import TooShort


@dataclass(frozen=True)
class State:
    """The last samples, a window of them once it is full, and the sampling period [s]."""

    samples: Array
    h: float


@dataclass(frozen=True)
class Differentiator(FirMethod):
    window: int = 81
    degree: int = 5

    TUNED: ClassVar = {"window": Range(0.05, 1.5, samples=True, step=2)}

    def __post_init__(self) -> None:
        require_window(self)
        require_odd(self, "window")

    @property
    def half(self) -> int:
        return int(self.window) // 2

    def lag(self, h: float) -> float:  # noqa: ARG002 (in samples)
        return self.half

    def taps(self, h: float) -> tuple[Array, ...]:
        return self._fit(self.half, h)

    def lowpass(self, h: float) -> Array:
        return integrated(self.taps(h)[1], 2, h)

    def init(self, x: float, h: float) -> State:  # type: ignore[override]  # noqa: ARG002
        return State(np.empty(0), h)

    def step(self, state: State, x: Array) -> tuple[State, tuple[Array, ...]]:  # type: ignore[override]
        begun = len(state.samples) == self.window
        samples = np.concatenate((state.samples, x))
        after = State(samples[-int(self.window) :], state.h)
        if len(samples) < self.window:
            return after, (np.empty(0), np.empty(0))
        middle = [convolved(samples[begun:], taps) for taps in self.taps(state.h)]
        if begun:
            return after, tuple(middle)
        early = range(int(self.window) - 1, self.half, -1)
        first = self._edge(samples[: int(self.window)], early, state.h)
        return after, tuple(np.concatenate(pair) for pair in zip(first, middle, strict=True))

    def finish(self, state: State) -> tuple[Array, ...]:  # type: ignore[override]
        if len(state.samples) < self.window:
            raise TooShort(
                f"window of {self.window:g} samples is longer than the log of "
                f"{len(state.samples)} rows"
            )
        return self._edge(state.samples, range(self.half - 1, -1, -1), state.h)

    def _edge(self, window: Array, ages: range, h: float) -> tuple[Array, ...]:
        """The derivatives at other samples than the middle one."""
        fits = [self._fit(age, h) for age in ages]
        return tuple(
            np.array([convolved(window, taps)[0] for taps in rows])
            for rows in zip(*fits, strict=True)
        )

    def _fit(self, age: int, h: float) -> tuple[Array, Array]:
        first, second = (
            derivative_taps(int(self.window), int(self.degree), order, age, h) for order in (1, 2)
        )
        return first, second
