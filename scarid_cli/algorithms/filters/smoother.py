"""The low-pass that a fixed-lag smoother of constant gain is between position and acceleration.

See docs/theory.md, sections "Kalman filters and smoothers" and "Phase matching".
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.algorithms.filters.convolution import convolved
from scarid_cli.algorithms.filters.kalman import KalmanState, filtered, lag_weights
from scarid_cli.algorithms.filters.kalman_method import KalmanMethod
from scarid_cli.algorithms.filters.observer import read, readout
from scarid_cli.algorithms.processes.process import Process
from scarid_cli.arrays import Array


@dataclass(frozen=True)
class SmootherLowpassState:
    """The filter, and its low-passed predictions and innovations of the last rows (`held`).

    readouts: the weights that read either from the filter's state. taps: what the innovations
    weigh in the smoothed acceleration. drop: the number of outputs that belong to no row yet.
    """

    observer: KalmanState
    held: tuple[Array, ...]
    readouts: tuple[Array, Array]
    taps: Array
    drop: int


@dataclass(frozen=True)
class SmootherLowpass(Process):
    """What the smoother is between position and acceleration, one sample early.

    The smoothed acceleration is the predicted one plus a weighted sum of the innovations that
    follow, so its low-pass is the same sum of their low-passes.
    """

    method: KalmanMethod

    def lag(self, h: float) -> float:
        return self.method.lag(h)

    def init(self, x: float, h: float) -> SmootherLowpassState:
        lag = int(self.lag(h))
        observer = self.method.observer(x, h)
        position, _, acceleration, *_ = np.eye(len(observer.x))
        variance = observer.P[0, 0] + observer.model.variance
        prediction = readout(observer, h, acceleration)
        innovation = readout(observer, h, -position / variance)
        taps = lag_weights(observer, lag)[::-1, 2]
        # Of unit gain, for a model with damping does not quite follow a constant acceleration.
        gain = prediction[0] + innovation[0] * taps.sum()
        readouts = (prediction / gain, innovation / gain)
        held = tuple(np.full(lag, u[0] * x) for u in readouts)
        return SmootherLowpassState(observer, held, readouts, taps, lag)

    def step(
        self, state: SmootherLowpassState, x: Array
    ) -> tuple[SmootherLowpassState, tuple[Array, ...]]:
        observer, rows = filtered(state.observer, x)
        predictions, innovations = (
            np.concatenate((held, read(u, rows)))
            for held, u in zip(state.held, state.readouts, strict=True)
        )
        y = predictions[: len(x)] + convolved(innovations, state.taps)
        held = (predictions[len(x) :], innovations[len(x) :])
        drop = max(state.drop - len(x), 0)
        return replace(state, observer=observer, held=held, drop=drop), (y[state.drop :],)

    def finish(self, state: SmootherLowpassState) -> tuple[Array, ...]:
        standing = np.full(len(state.taps) - 1, state.observer.x[0])
        return self.step(state, standing)[1]
