"""The torque that a drive reports: its motor constant, an offset, and a low-pass."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.arrays import Array
from scarid_cli.kernels import sos


@dataclass(frozen=True)
class TorqueSensor:
    """logged = (1 + error) commanded + offset, then a first-order low-pass; one value per joint.

    The command is constant from one tick of the controller to the next, h [s] later, so that
    the low-pass dy/dt = w (u - y) has the exact solution y(t) = u + (y(0) - u) exp(-w t) in
    between. The bandwidth [Hz] is w / (2 pi); 0 stands for no low-pass.
    """

    error: Array
    offset: Array
    bandwidth: Array
    h: float

    @property
    def decay(self) -> Array:
        """w h (joints): how fast the low-pass forgets, per period."""
        return 2.0 * np.pi * self.bandwidth * self.h

    def step(self, sums: Array | None, tau: Array) -> tuple[Array, Array, Array]:
        """The state of the low-pass after these ticks, its input and its output (joints, ticks).

        The state is None before the first tick, at which the low-pass is at rest.
        """
        u = tau
        if self.error.any():
            u = (1.0 + self.error)[:, None] * u
        if self.offset.any():
            u = u + self.offset[:, None]
        if sums is None:
            sums = np.zeros((len(u), 1, 2))
            sums[:, 0, 0] = u[:, 0]
        sums, y = sums.copy(), np.array(u, order="C")
        for j in np.flatnonzero(self.bandwidth):
            a = np.exp(-self.decay[j])
            section = np.array([[0.0, 1.0 - a, 0.0, -a, 0.0]])
            sos.filtered(np.ascontiguousarray(u[j]), y[j], sums[j], section)
        return sums, u, y

    def between(self, u: Array, y: Array, fraction: Array) -> Array:
        """The torque at a fraction of the period after the ticks with the input u and output y.

        All are (joints, samples).
        """
        return u + (y - u) * np.exp(-self.decay[:, None] * fraction)


def rounded(x: Array, resolution: Array) -> Array:
    """The nearest multiples of a resolution (joints) to x (joints, samples); 0: x itself."""
    steps = np.where(resolution > 0.0, resolution, 1.0)[:, None]
    return np.where(resolution[:, None] > 0.0, np.floor(x / steps + 0.5) * steps, x)
