"""Central difference without a filter: once for the velocity, twice for the acceleration.

Fixed lag of two samples; at both ends of the record the differences are one-sided, as in
numpy.gradient. It is meant for positions that have been filtered already: after a zero-phase filter
it is the standard of the field.
Delay: none.
Matched (unfiltered): position and torque stay as they are. No settings.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.processes.matching import Unfiltered
from scarid_cli.algorithms.processes.method import Matching, Method
from scarid_cli.arrays import Array


@dataclass(frozen=True)
class RunningDifference:
    """One differentiation: the last samples (at most two), and whether the first has its output."""

    held: Array
    started: bool = False


@dataclass(frozen=True)
class CentralState:
    """The differentiation of positions and of velocities, and the velocities that wait."""

    position: RunningDifference
    velocity: RunningDifference
    waiting: Array
    h: float


@dataclass(frozen=True)
class Differentiator(Method):
    MATCHING = Matching.UNFILTERED

    def lag(self, h: float) -> float:  # noqa: ARG002 (the same at every rate)
        return 2

    def matched(self) -> Unfiltered:
        return Unfiltered(self)

    def init(self, x: float, h: float) -> CentralState:  # noqa: ARG002 (the first step brings it)
        none = np.empty(0)
        return CentralState(RunningDifference(none), RunningDifference(none), none, h)

    def step(self, state: CentralState, x: Array) -> tuple[CentralState, tuple[Array, ...]]:
        position, v = advance(state.position, x, state.h)
        velocity, a = advance(state.velocity, v, state.h)
        waiting = np.concatenate((state.waiting, v))
        after = CentralState(position, velocity, waiting[len(a) :], state.h)
        return after, (waiting[: len(a)], a)

    def finish(self, state: CentralState) -> tuple[Array, ...]:
        last = last_derivative(state.position, state.h)
        velocity, a = advance(state.velocity, last, state.h)
        a = np.concatenate((a, last_derivative(velocity, state.h)))
        return np.concatenate((state.waiting, last)), a


def advance(running: RunningDifference, x: Array, h: float) -> tuple[RunningDifference, Array]:
    """The differentiation after the samples x, and the derivatives known by then."""
    samples = np.concatenate((running.held, x))
    inner = (samples[2:] - samples[:-2]) / (2.0 * h)
    if running.started or len(samples) < 2:
        return RunningDifference(samples[-2:], running.started), inner
    first = (samples[1:2] - samples[:1]) / h
    return RunningDifference(samples[-2:], started=True), np.concatenate((first, inner))


def last_derivative(running: RunningDifference, h: float) -> Array:
    """The one-sided derivative of the last sample."""
    return np.diff(running.held) / h
