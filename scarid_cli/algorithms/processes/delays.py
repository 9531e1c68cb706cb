"""Phase matching of nonlinear methods: by the delays they have on a reference motion."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from scarid_cli.algorithms.processes.process import Causal
from scarid_cli.arrays import Array


@dataclass(frozen=True)
class Line:
    """The samples that a delay holds, and the part of a period beyond whole ones."""

    samples: Array
    fraction: float

    @classmethod
    def of(cls, seconds: float, x: float, h: float) -> Line:
        return cls(np.full(int(seconds / h) + 1, x), seconds / h % 1.0)

    def delayed(self, x: Array) -> tuple[Line, Array]:
        """Between samples by linear interpolation."""
        samples = np.concatenate((self.samples, x))
        late, early = samples[: len(x)], samples[1 : len(x) + 1]
        return Line(samples[len(x) :], self.fraction), early + self.fraction * (late - early)


@dataclass(frozen=True)
class MeasuredState:
    """The method's own state, and the positions and velocities that wait."""

    own: Any
    position: Line
    velocity: Line


@dataclass(frozen=True)
class Measured(Causal):
    """The matched form of a nonlinear method: by the delays that it has on a reference motion."""

    method: Any

    @property
    def torque_filter(self) -> Delay:
        return Delay(self.method)

    def init(self, x: float, h: float) -> MeasuredState:
        v, a = delays(self.method, h)
        return MeasuredState(self.method.init(x, h), Line.of(a, x, h), Line.of(a - v, 0.0, h))

    def step(self, state: MeasuredState, x: Array) -> tuple[MeasuredState, tuple[Array, ...]]:
        own, (v, a) = self.method.step(state.own, x)
        position, q = state.position.delayed(x)
        velocity, v = state.velocity.delayed(v)
        return MeasuredState(own, position, velocity), (q, v, a)


@dataclass(frozen=True)
class Delay(Causal):
    """The delay of a method's acceleration."""

    method: Any

    def init(self, x: float, h: float) -> Line:
        return Line.of(delays(self.method, h)[1], x, h)

    def step(self, state: Line, x: Array) -> tuple[Line, tuple[Array, ...]]:
        after, late = state.delayed(x)
        return after, (late,)


def delays(method: Any, h: float) -> tuple[float, float]:
    """By how much velocity and acceleration are late [s] on moves of 1 rad in 0.8 to 2 s.

    The delay of the least squared error; the velocity's is no longer than the acceleration's.
    """
    q, v, a = reference(h)
    _, (got_v, got_a) = method.step(method.init(float(q[0]), h), q)
    late = lateness(got_a, a, h)
    return min(lateness(got_v, v, h), late), late


def reference(h: float) -> tuple[Array, Array, Array]:
    """Quintic moves to and fro, the fastest and the slowest of the paper's excitation."""
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
    """The delay [s], not negative, after which the truth is nearest to the estimate."""
    t = np.arange(len(truth)) * h
    grid = np.linspace(0.0, 0.2, 81)
    errors = [np.sum((estimate - np.interp(t - d, t, truth)) ** 2) for d in grid]
    at = int(np.argmin(errors))
    if not 0 < at < len(grid) - 1:
        return float(grid[at])
    left, here, right = errors[at - 1 : at + 2]
    return float(grid[at] + 0.5 * grid[1] * (left - right) / (left - 2.0 * here + right))
