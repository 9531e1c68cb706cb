"""Extended Kalman filter of joint positions, velocities and parameters (the paper's ref. 45).

It is included for comparison. It needs initial parameters (`--initial`) instead of derivatives, and
it is far slower than least squares. It reads only positions and torques; accelerations are those of
the model. Its standard errors come from its own covariance and are not robust.
spread = 0.5: initial standard deviation of a parameter, relative to its initial value (or to 0.1
if that is 0).
acceleration_noise = 2: standard deviation per sample of the acceleration that the model lacks
[rad/s2 or m/s2].
smoothing = 0.05: velocity over which Coulomb friction changes its sign [rad/s or m/s].
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from scarid_cli.algorithms.choices.settings import require_positive
from scarid_cli.algorithms.regression.estimation import Estimation, RobotEstimator
from scarid_cli.algorithms.regression.information import Fit
from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault

STEP = 1e-6  # rad, m, and per s: for numerical derivatives
TINY = 1e-6  # rad or m: the smallest standard deviation of a position


@dataclass(frozen=True)
class FilterState:
    """The state (position, velocity, parameters) and its covariance."""

    x: Array
    covariance: Array


@dataclass(frozen=True)
class Estimator(RobotEstimator):
    spread: float = 0.5
    acceleration_noise: float = 2.0
    smoothing: float = 0.05
    RECURSIVE: ClassVar[bool] = True
    INITIAL: ClassVar[bool] = True
    ALIGNS: ClassVar[bool] = False

    def check(self) -> None:
        require_positive(self, "spread", "acceleration_noise", "smoothing")

    def for_robot(self, robot: Robot) -> Self:
        return super().for_robot(robot.smoothed(self.smoothing))

    def init(self, initial: Array) -> FilterState:
        if not np.any(initial):
            raise UsageFault("ekf needs initial parameters: give --initial apriori, or a table")
        n = len(self.robot.joints)
        deviations = self.spread * np.where(initial == 0.0, 0.1, np.abs(initial))
        # Velocities are not known at the start: nan until the first sample.
        x = np.concatenate((np.full(2 * n, np.nan), initial))
        return FilterState(x, np.diag(np.concatenate((np.ones(2 * n), deviations)) ** 2))

    def step(
        self, state: FilterState, rows: Rows, *, trace: bool = False
    ) -> tuple[FilterState, Array]:
        n = len(self.robot.joints)
        noise = self._position_noise()
        x: Array = state.x.copy()
        covariance = state.covariance.copy()
        estimates = np.empty((rows.samples if trace else 0, len(x) - 2 * n))
        for k in range(rows.samples):
            q, tau = rows.motion[0, :, k], rows.motion[3, :, k]
            if np.isnan(x[0]):
                x[: 2 * n] = np.concatenate((q, rows.motion[1, :, k]))
                covariance[:n, :n] = np.diag(noise)
            else:
                x, covariance = _corrected(x, covariance, q, noise)
            if trace:
                estimates[k] = x[2 * n :]
            x, covariance = self._predicted(x, covariance, tau, rows.h)
        return FilterState(x, covariance), estimates

    def fit(self, state: FilterState) -> Estimation:
        n = 2 * len(self.robot.joints)
        if not np.isfinite(state.x).all():
            raise UsageFault(
                "ekf diverged; give better initial parameters (--initial) or a larger smoothing "
                "of friction (--set smoothing=V)"
            )
        fit = Fit(
            estimates=state.x[n:],
            unit_covariance=state.covariance[n:, n:],
            variance=1.0,
            condition=float("nan"),
        )
        return Estimation(fit, scores=None)

    def _position_noise(self) -> Array:
        """The variance of each position, which an encoder rounds."""
        steps = np.array([joint.encoder_resolution for joint in self.robot.joints])
        variance: Array = np.maximum(steps / np.sqrt(12.0), TINY) ** 2
        return variance

    def _predicted(self, x: Array, covariance: Array, tau: Array, h: float) -> tuple[Array, Array]:
        """The state one period later, from the model's acceleration and its derivatives."""
        n = len(self.robot.joints)
        with np.errstate(all="ignore"):
            acceleration, slope = self._acceleration(x, tau)
        F = np.eye(len(x))
        F[:n] += 0.5 * h * h * slope
        F[:n, n : 2 * n] += h * np.eye(n)
        F[n : 2 * n] += h * slope
        moved = x.copy()
        moved[:n] += h * x[n : 2 * n] + 0.5 * h * h * acceleration
        moved[n : 2 * n] += h * acceleration
        spread = F @ covariance @ F.T
        reach = np.concatenate((np.full(n, 0.5 * h * h), np.full(n, h))) * self.acceleration_noise
        for i in range(n):
            pair = [i, n + i]
            spread[np.ix_(pair, pair)] += np.outer(reach[pair], reach[pair])
        return moved, spread

    def _acceleration(self, x: Array, tau: Array) -> tuple[Array, Array]:
        """The model's acceleration (joints), and its derivatives by the state (joints, states)."""
        n = len(self.robot.joints)
        theta = x[2 * n :]
        # The state, then each position and velocity a step forwards, then a step backwards.
        steps = STEP * np.vstack((np.zeros(2 * n), np.eye(2 * n), -np.eye(2 * n)))
        points = x[: 2 * n] + steps
        found = forward(self.robot, points[:, :n].T, points[:, n:].T, tau, theta)
        slope = np.empty((n, len(x)))
        slope[:, : 2 * n] = (found[:, 1 : 2 * n + 1] - found[:, 2 * n + 1 :]) / (2.0 * STEP)
        at = (x[:n, None], x[n : 2 * n, None], found[:, :1])
        inertia = _inertia(self.robot, at[0], at[1], theta)[0]
        slope[:, 2 * n :] = -np.linalg.solve(inertia, self.robot.regressor(*at)[0])
        return found[:, 0], slope


def _corrected(x: Array, covariance: Array, q: Array, noise: Array) -> tuple[Array, Array]:
    """The state corrected by the measured positions."""
    n = len(q)
    gain = np.linalg.solve(covariance[:n, :n] + np.diag(noise), covariance[:n]).T
    moved: Array = x + gain @ (q - x[:n])
    reduced: Array = covariance - gain @ covariance[:n]
    return moved, np.asarray(0.5 * (reduced + reduced.T), dtype=np.float64)


def forward(robot: Robot, q: Array, dq: Array, tau: Array, theta: Array) -> Array:
    """Forward dynamics: eq. 1 solved for the accelerations (joints, points) at q, dq and tau."""
    rest = robot.regressor(q, dq, np.zeros_like(q)) @ theta
    inertia = _inertia(robot, q, dq, theta)
    return np.asarray(np.linalg.solve(inertia, (tau - rest)[:, :, None])[:, :, 0].T)


def _inertia(robot: Robot, q: Array, dq: Array, theta: Array) -> Array:
    """The inertia matrix (points, joints, joints), column by column from the regressor."""
    rest = robot.regressor(q, dq, np.zeros_like(q)) @ theta
    columns = []
    for i in range(len(q)):
        unit = np.zeros_like(q)
        unit[i] = 1.0
        columns.append(robot.regressor(q, dq, unit) @ theta - rest)
    return np.stack(columns, axis=2)
