"""The momentum observer as a regression: the residual torque without accelerations.

With the generalised momentum p = M dq, the equation of motion is

    dp/dt = tau + C^T dq - g - friction + tau_ext.

The observer r = K (p - integral(tau + C^T dq - g - friction + r)) is the external torque behind a
low-pass of first order, K / (s + K) (De Luca and Mattone, ICRA 2005). All of its terms are linear
in the parameters. Low-passed by K / (s + K), dp/dt becomes K (p - low-passed p), so that

    low-passed tau = W_m theta - r,  W_m = K (P - low-passed P) - low-passed D,

where P theta = p and D theta = C^T dq - g - friction. Rows with W_m and the low-passed torque take
the place of those of the acceleration.
"""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np

from scarid_cli.algorithms.regression.rows import Rows, joined, runs
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array

STEP = 1e-5  # s: of the motion over which dM/dt is a central difference; its error is 1e-10
SETTLED = 5.0  # time constants, after which the first row has been forgotten


class Observer:
    """Turns the rows of a record into those that a momentum observer sees, part by part."""

    def __init__(self, robot: Robot, frequency: float, h: float) -> None:
        """`frequency` [Hz] is K / 2 pi; the samples are `h` [s] apart."""
        self._robot, self._gain = robot, 2.0 * pi * frequency
        half = 0.5 * self._gain * h
        self._b = np.array([half, half]) / (1.0 + half)  # K / (s + K), by the bilinear rule
        self._a = np.array([1.0, (half - 1.0) / (1.0 + half)])
        self._states: list[Array] = []
        self._last: int | None = None
        self._wait = int(np.ceil(SETTLED / (self._gain * h))) if h > 0.0 else 0
        self._since = 0

    def __call__(self, rows: Rows) -> Rows:
        """The next rows, low-passed; those right behind a gap are left out by their scales."""
        return joined([self._run(rows.part(run)) for run in runs(rows.at)])

    def _run(self, rows: Rows) -> Rows:
        P, D = momentum(self._robot, rows.motion)
        if self._last is None or rows.at[0] != self._last + 1:
            rate = rows.W[:1] + D[:1]  # dP/dt at the first row
            self._states = self._resting(rows.y[:1], P[:1] - rate / self._gain, D[:1], P[:1])
            self._since = 0
        y, behind, slow = (self._low_passed(k, x) for k, x in enumerate((rows.y, P, D)))
        new = self._since + np.arange(rows.samples) >= self._wait
        self._last, self._since = int(rows.at[-1]), self._since + rows.samples
        W = self._gain * (P - behind) - slow
        return replace(rows, W=W, y=y, scales=rows.scales * new[:, None])

    def _resting(self, y: Array, behind: Array, D: Array, P: Array) -> list[Array]:
        """The states with which the low-pass of the first row is what is given."""
        return [out - self._b[0] * x for out, x in ((y, y), (behind, P), (D, D))]

    def _low_passed(self, k: int, x: Array) -> Array:
        from scipy.signal import lfilter  # takes a second to import

        found, self._states[k] = lfilter(self._b, self._a, x, axis=0, zi=self._states[k])
        return np.ascontiguousarray(found)


def momentum(robot: Robot, motion: Array) -> tuple[Array, Array]:
    """P and D (samples, joints, parameters) of the module's docstring.

    motion (3 or more, joints, samples): positions and velocities; accelerations are not used.
    """
    q, dq = motion[:2]
    rest = np.zeros_like(q)

    def inertial(at: Array) -> Array:
        return robot.regressor(at, rest, dq) - robot.regressor(at, rest, rest)

    ahead, behind = inertial(q + STEP * dq), inertial(q - STEP * dq)
    return inertial(q), (ahead - behind) / (2.0 * STEP) - robot.regressor(q, dq, rest)
