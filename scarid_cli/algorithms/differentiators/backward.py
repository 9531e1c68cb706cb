"""Backward (Euler) difference without a filter: once for the velocity, twice for the acceleration.

Causal. It is meant for positions that have been filtered already, online.
Delay: half a sample for the velocity, one sample for the acceleration.
Matched (exact): the velocity is averaged over two samples, and position and torque are delayed by
one sample. No settings.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.filters.convolution import FirMethod
from scarid_cli.arrays import Array


@dataclass(frozen=True)
class Differentiator(FirMethod):
    def taps(self, h: float) -> tuple[Array, ...]:
        return np.array([1.0, -1.0, 0.0]) / h, np.array([1.0, -2.0, 1.0]) / h**2

    def lowpass(self, h: float) -> Array:  # noqa: ARG002 (none at any rate)
        return np.ones(1)
