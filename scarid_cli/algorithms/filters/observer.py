"""Observers: differentiators that settle to a constant gain, and their low-pass.

See docs/theory.md, section "Phase matching".
"""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.filters.kalman import KalmanState, filtered
from scarid_cli.algorithms.processes.matching import CentralDifferences
from scarid_cli.algorithms.processes.method import Matching, Method
from scarid_cli.algorithms.processes.process import Causal
from scarid_cli.arrays import Array


class ObserverMethod(Causal, Method):
    """A causal differentiator that runs the Kalman kernel and settles to a constant gain."""

    MATCHING = Matching.EXACT

    @abstractmethod
    def observer(self, x: float, h: float) -> KalmanState:
        """The observer of constant gain, at rest at the position x; h [s]."""

    def ungated(self) -> ObserverMethod:
        """The same observer without a gate against encoder glitches, for torques."""
        return self

    def step(self, state: KalmanState, x: Array) -> tuple[KalmanState, tuple[Array, ...]]:
        state, rows = filtered(state, x)
        return state, tuple(np.ascontiguousarray(rows[:, 1:3].T))

    def matched(self) -> CentralDifferences:
        return CentralDifferences(ObserverLowpass(self), ObserverLowpass(self.ungated()))


def readout(observer: KalmanState, h: float, c: Array, order: int = 2) -> Array:
    """The weights u (m) for which h^order c p is a difference of y(k+1) = u x(k).

    x is the filtered state, p the predicted one; c p (c has m weights) must be zero as long as the
    derivatives of lower order of the measurement are constant. For order 2 the difference is the
    central one, y(k+1) - 2 y(k) + y(k-1). With the closed loop A = F (I - K H), w solves
    w (A - I)^order = h^order c A, and u = w F.
    """
    F, K = observer.model.F, observer.gain
    identity = np.eye(len(K))
    # In units of the observer's own time constant, in which all numbers are of one size.
    scale = (K[0] / K[1]) ** np.arange(len(K))
    F, K = F * scale[:, None] / scale[None, :], K * scale
    A = F @ (identity - np.outer(K, identity[0]))
    power = np.linalg.matrix_power(A - identity, order)
    u: Array = np.linalg.solve(power.T, h**order * (c / scale) @ A) @ F * scale
    return u


def read(u: Array, rows: Array) -> Array:
    """u x for each filtered state x (rows, m).

    Column by column, so that the bits do not depend on the number of rows.
    """
    y: Array = u[0] * rows[:, 0]
    for weight, column in zip(u[1:], rows.T[1:], strict=True):
        y += weight * column
    return y


@dataclass(frozen=True)
class ObserverLowpassState:
    """The observer, and the weights (m) that read the low-passed position from its state."""

    observer: KalmanState
    u: Array


@dataclass(frozen=True)
class ObserverLowpass(Causal):
    """What an observer is between position and its highest derivative, one sample early.

    It has all poles of the observer and no zero, so it does not overshoot, as the transfer function
    between position and acceleration would.
    """

    method: ObserverMethod

    def init(self, x: float, h: float) -> ObserverLowpassState:
        observer = self.method.observer(x, h)
        m = len(observer.x)
        u = readout(observer, h, np.eye(m)[-1], m - 1)
        # Of unit gain, for a model with damping does not quite follow a constant acceleration.
        return ObserverLowpassState(observer, u / u[0])

    def step(
        self, state: ObserverLowpassState, x: Array
    ) -> tuple[ObserverLowpassState, tuple[Array, ...]]:
        observer, rows = filtered(state.observer, x)
        return ObserverLowpassState(observer, state.u), (read(state.u, rows),)
