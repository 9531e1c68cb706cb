"""Phase matching of nonlinear methods by the delays that they have on a reference motion.

See docs/theory.md, section "Phase matching".
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.polynomial import Polynomial

from scarid_cli.algorithms.processes.method import MatchedForm, Matching, Method
from scarid_cli.algorithms.processes.process import Causal
from scarid_cli.arrays import Array

# Orders of derivatives of the motion, and the largest absolute values that a method follows.
Bounds = tuple[tuple[int, float], ...]

DURATIONS = (0.8, 1.2, 1.6, 2.0)  # of the moves of the reference motion [s]
SLOWEST = 10.0  # times these durations, however low a bound is
RESOLUTION = 2.0 * np.pi / 2**18  # of the encoder that sees the reference motion [rad]


class MeasuredMethod(Causal, Method):
    """A nonlinear method without a linearisation, which is matched by measured delays."""

    MATCHING = Matching.MEASURED

    def bounds(self) -> Bounds:
        """The bounds on derivatives of the motion [1/s^order] under which the method converges."""
        return ()

    def matched(self) -> MatchedForm:
        return MeasuredDelays(self)


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

    method: MeasuredMethod

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

    method: MeasuredMethod

    def init(self, x: float, h: float) -> DelayLine:
        return DelayLine.of(delays(self.method, h)[1], x, h)

    def step(self, state: DelayLine, x: Array) -> tuple[DelayLine, tuple[Array, ...]]:
        after, late = state.delayed(x)
        return after, (late,)


@cache  # each column asks for them, and at a high rate they take a while
def delays(method: MeasuredMethod, h: float) -> tuple[float, float]:
    """The delays [s] of velocity and acceleration on the reference motion of the method.

    The motion is measured by an encoder of 18 bit: without its noise most of these methods would
    have no delay. Each delay is that of the least squared error over the second half of the motion,
    when a method that adapts has done so. The delay of the velocity is not allowed to exceed that
    of the acceleration.
    """
    q, v, a = reference(h, method.bounds())
    q = RESOLUTION * np.round(q / RESOLUTION)
    _, (got_v, got_a) = method.step(method.init(float(q[0]), h), q)
    half = slice(len(q) // 2, None)
    late = lateness(got_a[half], a[half], h)
    return min(lateness(got_v[half], v[half], h), late), late


def reference(h: float, bounds: Bounds = ()) -> tuple[Array, Array, Array]:
    """Position [rad], velocity and acceleration of moves to and fro, sampled every h [s].

    The moves of 1 rad take 0.8 to 2 s, as the segments of the paper's excitation, or longer by one
    factor, so that no derivative exceeds its bound. They are quintic, or of the least higher
    degree that bounds those derivatives.
    """
    move = shape(max([2, *(order - 1 for order, _ in bounds)]))
    slower = max([1.0, *(excess(move, order, bound) for order, bound in bounds)])
    parts = []
    for sign, duration in zip((1.0, -1.0) * 4, DURATIONS * 2, strict=True):
        longer = duration * min(slower, SLOWEST)
        s = np.arange(0.0, longer, h) / longer
        start = 0.0 if sign > 0.0 else 1.0
        q, v, a = (move.deriv(k)(s) / longer**k for k in range(3))
        parts.append(np.array([start + sign * q, sign * v, sign * a]))
    q, v, a = np.concatenate(parts, axis=1)
    return q, v, a


def shape(degree: int) -> Polynomial:
    """A move from 0 to 1 in the time 1 whose velocity is proportional to (s (1 - s))^degree.

    The derivative of order degree + 1 is bounded also where one move follows another.
    """
    path = (Polynomial([0.0, 1.0, -1.0]) ** degree).integ()
    return path / path(1.0)


def excess(move: Polynomial, order: int, bound: float) -> float:
    """By how much longer the fastest move must take to have a derivative within its bound."""
    largest = np.abs(move.deriv(order)(np.linspace(0.0, 1.0, 1001))).max() / DURATIONS[0] ** order
    return float((largest / bound) ** (1.0 / order))


def lateness(estimate: Array, truth: Array, h: float) -> float:
    """The delay [s], from 0 to 0.2 s, after which the truth is nearest to the estimate."""
    grid = np.linspace(0.0, 0.2, 81)
    errors = [np.sum((estimate - later(truth, d / h)) ** 2) for d in grid]
    at = int(np.argmin(errors))
    if not 0 < at < len(grid) - 1:
        return float(grid[at])
    left, here, right = errors[at - 1 : at + 2]
    return float(grid[at] + 0.5 * grid[1] * (left - right) / (left - 2.0 * here + right))


def later(x: Array, delay: float) -> Array:
    """The samples x after a delay [samples], linearly interpolated; the first one is held."""
    whole = min(int(delay), len(x) - 1)
    late = np.empty_like(x)
    late[: whole + 1] = x[0]
    here, before = x[1 : len(x) - whole], x[: len(x) - whole - 1]
    late[whole + 1 :] = here + (delay - whole) * (before - here)
    return late
