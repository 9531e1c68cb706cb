"""Sines and cosines, with a polynomial that brings them to rest at both ends.

The corrections are the polynomials of lowest order with the values, slopes and curvatures of the
function at both ends (a Fourier series: Swevers et al. 1997; with a polynomial: Park 2006).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from scarid_cli.arrays import Array

# In u = t / duration. A sine has the slope of its phase at both ends and a cosine a curvature.
SLOPE = np.polynomial.Polynomial([0.0, 1.0, 0.0, -10.0, 15.0, -6.0])
CURVATURE = np.polynomial.Polynomial([0.0, 0.0, 0.5, -1.0, 0.5])


@dataclass(frozen=True)
class FourierBasis:
    """Harmonics of 1 / duration, each function with a peak acceleration of 1.

    Motions are periodic: position, velocity and acceleration are the same at both ends.
    """

    duration: float
    harmonics: int

    @property
    def size(self) -> int:
        return 2 * self.harmonics

    @property
    def scale(self) -> float:
        return self.duration / self.harmonics / 4.0  # a quarter of the shortest period

    @property
    def summary(self) -> str:
        return f"Fourier series of {self.harmonics} harmonics"

    def values(self, t: Array, order: int) -> Array:
        """A derivative of each function (size, samples) at the times t [s]."""
        return self._scales[:, None] * self._derivative(t, order)

    @cached_property
    def _scales(self) -> Array:
        t = np.linspace(0.0, self.duration, 100 * self.harmonics + 1)
        scales: Array = 1.0 / np.abs(self._derivative(t, 2)).max(axis=1)
        return scales

    def _derivative(self, t: Array, order: int) -> Array:
        """Of all functions before they are scaled, from the nearer end, where they are exact."""
        u = t / self.duration
        near, side = np.minimum(u, 1.0 - u), np.where(u > 0.5, -1.0, 1.0)
        w = 2.0 * np.pi * np.arange(1, self.harmonics + 1)[:, None]
        turned = order % 4
        sines = (np.sin, np.cos)[order % 2](w * near) * (1.0, 1.0, -1.0, -1.0)[turned] * w**order
        cosines = (np.cos, np.sin)[order % 2](w * near) * (1.0, -1.0, -1.0, 1.0)[turned] * w**order
        rest = 1.0 if order == 0 else 0.0
        # About the middle a sine is odd and a cosine even, and each derivative changes that.
        odd, even = side ** (order + 1), side**order
        sines = odd * (sines - w * SLOPE.deriv(order)(near))
        cosines = even * (cosines - rest + w**2 * CURVATURE.deriv(order)(near))
        return np.concatenate((sines, cosines)) / self.duration**order
