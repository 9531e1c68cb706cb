"""Kalman smoother of fixed lag: the filter `kalman`, and what the samples after a row say of it.

Fixed lag, streaming: a row waits for `delay`, and carries its own time. No delay otherwise. D.11 of
the equations; Anderson and Moore, Optimal Filtering, chapter 7. Matched (--match, exact but at
glitches): constant gain; position and torque pass the low-pass between position and acceleration.
Rule: `scarid tune` finds the others by maximum likelihood; a delay of 2 / bandwidth (see kalman)
buys most of what there is to gain.
delay = 0.1 [s]: the lag.
noise = 5e-5: standard deviation of the position, at least resolution / 3.5.
intensity = 10000: spectral density of the white noise, [rad2/s7] for 4 states.
states = 4: 3 to 5.
damping = frequency = 0: of the acceleration process [1/s], [rad/s].
gate = 20: standard deviations from which on an innovation is a glitch and left out (3 in a row
at most).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.choices.ranges import Range
from scarid_cli.algorithms.choices.settings import require_positive
from scarid_cli.algorithms.filters import kalman
from scarid_cli.algorithms.filters.smoother import Lowpass
from scarid_cli.algorithms.processes.matching import Differences
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault


@dataclass(frozen=True)
class State:
    """The filter, the records of the rows that wait, and the weights of later innovations."""

    filter: kalman.State
    waiting: kalman.Records
    weights: Array


@dataclass(frozen=True)
class Differentiator(kalman.Settings):
    delay: float = 0.1

    PRESETS: ClassVar[dict[str, dict[str, float]]] = {}
    TUNED: ClassVar[dict[str, Range]] = {}

    def __post_init__(self) -> None:
        super().__post_init__()
        require_positive(self, "delay")

    def lag(self, h: float) -> float:
        return round(self.delay / h)

    def init(self, x: float, h: float) -> State:
        if self.lag(h) < 1:
            raise UsageFault(f"delay must be at least a period, {h:g} s, not {self.delay:g}")
        model = self.model(h)
        weights = kalman.lag_weights(self.observer(x, h), int(self.lag(h)))
        return State(model.at_rest(x), kalman.Records.of(0, int(self.states)), weights)

    def step(self, state: State, x: Array) -> tuple[State, tuple[Array, ...]]:
        after, new = kalman.recorded(state.filter, x)
        records = state.waiting.followed_by(new)
        lag = len(state.weights) - 1
        out = kalman.lagged(records, max(len(records) - lag, 0), after, state.weights)
        return State(after, records.last(lag), state.weights), tuple(np.ascontiguousarray(out.T))

    def finish(self, state: State) -> tuple[Array, ...]:
        records = state.waiting
        out = kalman.lagged(records, len(records), state.filter, state.weights)
        return tuple(np.ascontiguousarray(out.T))

    def matched(self) -> Differences:
        return Differences(Lowpass(self), Lowpass(replace(self, gate=inf)))
