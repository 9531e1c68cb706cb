"""A fixed-lag smoother of constant gain, and the low-pass that it is."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from scarid_cli.algorithms.filters.convolution import convolved
from scarid_cli.algorithms.filters.kalman import State, filtered, lag_weights
from scarid_cli.algorithms.filters.observer import Observing, read, readout
from scarid_cli.arrays import Array


class Smoothing(Observing, Protocol):
    """An observer whose rows wait for a lag."""

    def lag(self, h: float) -> float: ...


@dataclass(frozen=True)
class LowpassState:
    """The filter, and its low-passed predictions and innovations of the last rows.

    Each has its readout; taps: what the innovations weigh in the smoothed acceleration. drop: as
    many outputs belong to no row yet.
    """

    observer: State
    predictions: Array
    innovations: Array
    readouts: tuple[Array, Array]
    taps: Array
    drop: int


@dataclass(frozen=True)
class Lowpass:
    """What the smoother is between position and acceleration, one sample early.

    The smoothed acceleration is the predicted one and a sum over the innovations that follow; so
    its low-pass is a sum of their low-passes.
    """

    method: Smoothing

    def lag(self, h: float) -> float:
        return self.method.lag(h)

    def init(self, x: float, h: float) -> LowpassState:
        lag = int(self.lag(h))
        observer = self.method.observer(x, h)
        position, _, acceleration, *_ = np.eye(len(observer.x))
        variance = observer.P[0, 0] + observer.model.noise[0]
        prediction = readout(observer, h, acceleration)
        innovation = readout(observer, h, -position / variance)
        taps = lag_weights(observer, lag)[::-1, 2]
        # Unit gain: a model with damping follows a constant acceleration not quite.
        gain = prediction[0] + innovation[0] * taps.sum()
        readouts = (prediction / gain, innovation / gain)
        predictions, innovations = (np.full(lag, u[0] * x) for u in readouts)
        return LowpassState(observer, predictions, innovations, readouts, taps, lag)

    def step(self, state: LowpassState, x: Array) -> tuple[LowpassState, tuple[Array, ...]]:
        observer, rows = filtered(state.observer, x)
        predictions, innovations = (
            np.concatenate((held, read(u, rows)))
            for held, u in zip((state.predictions, state.innovations), state.readouts, strict=True)
        )
        y = predictions[: len(x)] + convolved(innovations, state.taps)
        after = replace(
            state,
            observer=observer,
            predictions=predictions[len(x) :],
            innovations=innovations[len(x) :],
            drop=max(state.drop - len(x), 0),
        )
        return after, (y[state.drop :],)

    def finish(self, state: LowpassState) -> tuple[Array, ...]:
        standing = np.full(len(state.taps) - 1, state.observer.x[0])
        return self.step(state, standing)[1]
