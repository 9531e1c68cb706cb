"""Kalman smoother of fixed lag: the filter `kalman`, corrected by the samples after each row.

Fixed lag, streaming: a row waits for `delay` and keeps its own time. Anderson and Moore, Optimal
Filtering (1979), chapter 7. See docs/theory.md, section "Kalman filters and smoothers".
Delay: none beyond the wait, once the lag is long enough.
Matched (exact, except at glitches): with the gain held constant, position and torque pass the
low-pass between position and acceleration.
Rule: `scarid tune` finds all settings except delay and gate by maximum likelihood. A delay of
2 / bandwidth (see kalman) brings most of what a smoother can gain.
delay = 0.1 [s]: the lag.
noise = 5e-5: standard deviation of the position, at least resolution / 3.5.
intensity = 10000: spectral density of the white noise, [rad2/s7] for 4 states.
states = 4: number of states, 3 to 5.
damping = frequency = 0: damping [1/s] and frequency [rad/s] of the acceleration process.
gate = 20: number of standard deviations beyond which an innovation is taken for a glitch and left
out (at most 3 in a row).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.choices.settings import require_positive
from scarid_cli.algorithms.filters import kalman
from scarid_cli.algorithms.filters.kalman_method import KalmanMethod
from scarid_cli.algorithms.filters.smoother import SmootherLowpass
from scarid_cli.algorithms.processes.matching import CentralDifferences
from scarid_cli.algorithms.processes.method import Matching
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault


@dataclass(frozen=True)
class FixedLagState:
    """The filter, the records of the rows that wait, and the weights of later innovations."""

    filter: kalman.KalmanState
    waiting: kalman.Records
    weights: Array


@dataclass(frozen=True)
class Differentiator(KalmanMethod):
    delay: float = 0.1

    MATCHING = Matching.EXACT

    def check(self) -> None:
        super().check()
        require_positive(self, "delay")

    def lag(self, h: float) -> float:
        return round(self.delay / h)

    def init(self, x: float, h: float) -> FixedLagState:
        if self.lag(h) < 1:
            raise UsageFault(f"delay must be at least a period, {h:g} s, not {self.delay:g}")
        weights = kalman.lag_weights(self.observer(x, h), int(self.lag(h)))
        return FixedLagState(self.model(h).at_rest(x), kalman.Records.of(0, self.states), weights)

    def step(self, state: FixedLagState, x: Array) -> tuple[FixedLagState, tuple[Array, ...]]:
        after, new = kalman.recorded(state.filter, x)
        records = kalman.Records.joined([state.waiting, new])
        lag = len(state.weights) - 1
        out = kalman.lagged(records, max(len(records) - lag, 0), after, state.weights)
        waiting = FixedLagState(after, records.last(lag), state.weights)
        return waiting, tuple(np.ascontiguousarray(out.T))

    def finish(self, state: FixedLagState) -> tuple[Array, ...]:
        records = state.waiting
        out = kalman.lagged(records, len(records), state.filter, state.weights)
        return tuple(np.ascontiguousarray(out.T))

    def matched(self) -> CentralDifferences:
        return CentralDifferences(SmootherLowpass(self), SmootherLowpass(self.ungated()))
