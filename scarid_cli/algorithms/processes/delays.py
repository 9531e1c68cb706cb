"""Phase matching of nonlinear methods by the delays that they have on a reference motion.

See docs/theory.md, section "Phase matching".
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from scarid_cli.algorithms.processes.method import MatchedForm, Method
from scarid_cli.algorithms.processes.process import Causal
from scarid_cli.arrays import Array


@dataclass(frozen=True)
class DelayLine:
    """The samples that a delay holds, and its fraction of a period beyond whole periods."""

    samples: Array
    fraction: float

    @classmethod
    def of(cls, seconds: float, x: float, h: float) -> DelayLine:
        """A delay [s] at the sampling period h [s] that holds nothing but x."""
        return cls(np.full(int(seconds / h) + 1, x), seconds / h % 1.0)

    def delayed(self, x: Array) -> tuple[DelayLine, Array]:
        """The delay line after the samples x, and what leaves it, linearly interpolated."""
        samples = np.concatenate((self.samples, x))
        late, early = samples[: len(x)], samples[1 : len(x) + 1]
        return DelayLine(samples[len(x) :], self.fraction), early + self.fraction * (late - early)


@dataclass(frozen=True)
class MeasuredDelaysState:
    """The state of the method, and the delay lines of positions and velocities."""

    own: Any
    position: DelayLine
    velocity: DelayLine


@dataclass(frozen=True)
class MeasuredDelays(Causal, MatchedForm):
    """The matched form: position and velocity are delayed to the instant of the acceleration."""

    method: Method

    @property
    def torque_filter(self) -> AccelerationDelay:
        return AccelerationDelay(self.method)

    def init(self, x: float, h: float) -> MeasuredDelaysState:
        v, a = delays(self.method, h)
        own, position = self.method.init(x, h), DelayLine.of(a, x, h)
        return MeasuredDelaysState(own, position, DelayLine.of(a - v, 0.0, h))

    def step(
        self, state: MeasuredDelaysState, x: Array
    ) -> tuple[MeasuredDelaysState, tuple[Array, ...]]:
        own, (v, a) = self.method.step(state.own, x)
        position, q = state.position.delayed(x)
        velocity, v = state.velocity.delayed(v)
        return MeasuredDelaysState(own, position, velocity), (q, v, a)


@dataclass(frozen=True)
class AccelerationDelay(Causal):
    """Delays a signal by as much as a method delays the acceleration."""

    method: Method

    def init(self, x: float, h: float) -> DelayLine:
        return DelayLine.of(delays(self.method, h)[1], x, h)

    def step(self, state: DelayLine, x: Array) -> tuple[DelayLine, tuple[Array, ...]]:
        after, late = state.delayed(x)
        return after, (late,)


def delays(method: Method, h: float) -> tuple[float, float]:
    """The delays [s] of velocity and acceleration on quintic moves of 1 rad in 0.8 to 2 s.

    Each delay is that of the least squared error. The delay of the velocity is not allowed to
    exceed that of the acceleration.
    """
    q, v, a = reference(h)
    _, (got_v, got_a) = method.step(method.init(float(q[0]), h), q)
    late = lateness(got_a, a, h)
    return min(lateness(got_v, v, h), late), late


def reference(h: float) -> tuple[Array, Array, Array]:
    """Position, velocity and acceleration of quintic moves to and fro, sampled every h [s].

    The durations span those of the segments of the paper's excitation.
    """
    parts = []
    for sign, duration in zip((1.0, -1.0) * 4, (0.8, 1.2, 1.6, 2.0) * 2, strict=True):
        s = np.arange(0.0, duration, h) / duration
        q = s**3 * (10.0 + s * (-15.0 + 6.0 * s))
        v = 30.0 * s**2 * (1.0 - s) ** 2 / duration
        a = 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / duration**2
        start = 0.0 if sign > 0.0 else 1.0
        parts.append(np.array([start + sign * q, sign * v, sign * a]))
    q, v, a = np.concatenate(parts, axis=1)
    return q, v, a


def lateness(estimate: Array, truth: Array, h: float) -> float:
    """The delay [s], from 0 to 0.2 s, after which the truth is nearest to the estimate."""
    t = np.arange(len(truth)) * h
    grid = np.linspace(0.0, 0.2, 81)
    errors = [np.sum((estimate - np.interp(t - d, t, truth)) ** 2) for d in grid]
    at = int(np.argmin(errors))
    if not 0 < at < len(grid) - 1:
        return float(grid[at])
    left, here, right = errors[at - 1 : at + 2]
    return float(grid[at] + 0.5 * grid[1] * (left - right) / (left - 2.0 * here + right))
