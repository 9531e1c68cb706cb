"""An observer of constant gain, and the low-pass that it is between position and acceleration."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from scarid_cli.algorithms.filters.kalman import State, filtered
from scarid_cli.algorithms.processes.process import Causal
from scarid_cli.arrays import Array


def readout(observer: State, h: float, c: Array, order: int = 2) -> Array:
    """u such that y(k+1) = u x(k), x the filtered state, has h^order c p as a difference.

    p is the predicted state; c p must be zero as long as the derivatives of lower order of the
    measurement are constant. Of order 2 the difference is central: y(k+1) - 2 y(k) + y(k-1). With
    the closed loop A = F (I - K H): w (A - I)^order = h^order c A and u = w F.
    """
    F, K = observer.model.F, observer.gain
    identity = np.eye(len(K))
    # In units of the observer's own time constant, where all numbers are of one size.
    scale = (K[0] / K[1]) ** np.arange(len(K))
    F, K = F * scale[:, None] / scale[None, :], K * scale
    A = F @ (identity - np.outer(K, identity[0]))
    power = np.linalg.matrix_power(A - identity, order)
    u: Array = np.linalg.solve(power.T, h**order * (c / scale) @ A) @ F * scale
    return u


def read(u: Array, rows: Array) -> Array:
    """u x for each filtered state x; column by column, for the same bits in any number of rows."""
    y: Array = u[0] * rows[:, 0]
    for weight, column in zip(u[1:], rows.T[1:], strict=True):
        y += weight * column
    return y


class Observing(Protocol):
    """A method that, once settled, is an observer of constant gain."""

    def observer(self, x: float, h: float) -> State:
        """At rest at x."""


@dataclass(frozen=True)
class ObserverState:
    """The observer, and the readout of its low-pass."""

    observer: State
    u: Array


@dataclass(frozen=True)
class Lowpass(Causal):
    """What an observer is between position and its highest derivative, one sample early.

    All poles and no zero: it does not overshoot as what lies below the acceleration would.
    """

    method: Observing

    def init(self, x: float, h: float) -> ObserverState:
        observer = self.method.observer(x, h)
        m = len(observer.x)
        u = readout(observer, h, np.eye(m)[-1], m - 1)
        # Unit gain: a model with damping follows a constant acceleration not quite.
        return ObserverState(observer, u / u[0])

    def step(self, state: ObserverState, x: Array) -> tuple[ObserverState, tuple[Array, ...]]:
        observer, rows = filtered(state.observer, x)
        return ObserverState(observer, state.u), (read(state.u, rows),)
