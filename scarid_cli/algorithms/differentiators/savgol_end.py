"""Savitzky-Golay at the end of its window: the polynomial that fits the last samples best.

Causal. Savitzky and Golay, Anal. Chem. 36 (1964) 1627; the same as scipy.signal.savgol_coeffs with
`pos` at the newest sample.
Delay: none on motions that are polynomials of the degree; on quintic moves of 0.8 to 2 s 31 ms at
the default and 200 Hz.
Matched (exact): position and torque pass the low-pass of which the highest derivative of the
polynomial is a difference, and velocity and acceleration are differences of it.
Rule: choose the longest window over which the motion is nearly a polynomial. The noise of the
acceleration falls with the length to the power 2.5.
window = 45: length in samples.
degree = 3: degree of the polynomial, at least 2 and below the window.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from scarid_cli.algorithms.choices.ranges import Range
from scarid_cli.algorithms.filters.convolution import FirMethod, integrated
from scarid_cli.algorithms.filters.polynomials import derivative_taps, require_window
from scarid_cli.arrays import Array


@dataclass(frozen=True)
class Differentiator(FirMethod):
    window: int = 45
    degree: int = 3

    TUNED: ClassVar = {"window": Range(0.03, 1.0, samples=True, step=1)}

    def check(self) -> None:
        require_window(self)

    def taps(self, h: float) -> tuple[Array, ...]:
        return self._taps(1, h), self._taps(2, h)

    def lowpass(self, h: float) -> Array:
        return integrated(self._taps(self.degree, h), self.degree, h)

    def _taps(self, order: int, h: float) -> Array:
        return derivative_taps(self.window, self.degree, order, 0, h)
