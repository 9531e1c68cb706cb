"""Central difference, twice: no delay and no filter, for positions that are filtered already.

The field's standard after a zero-phase filter. Fixed lag of two samples; one-sided at both ends,
like numpy.gradient. Matched as it is. No settings.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.choices.ranges import Range
from scarid_cli.algorithms.processes.matching import WithPosition
from scarid_cli.arrays import Array


@dataclass(frozen=True)
class Line:
    """One differentiator: the last samples (at most two), and whether the first has its output."""

    held: Array
    begun: bool = False


@dataclass(frozen=True)
class State:
    position: Line
    velocity: Line
    waiting: Array
    h: float


@dataclass(frozen=True)
class Differentiator:
    PRESETS: ClassVar[dict[str, dict[str, float]]] = {}
    TUNED: ClassVar[dict[str, Range]] = {}

    def lag(self, h: float) -> float:  # noqa: ARG002 (the same at every rate)
        return 2

    def matched(self) -> WithPosition:
        return WithPosition(self)

    def init(self, x: float, h: float) -> State:  # noqa: ARG002 (no state before the first sample)
        none = np.empty(0)
        return State(Line(none), Line(none), none, h)

    def step(self, state: State, x: Array) -> tuple[State, tuple[Array, ...]]:
        position, v = advance(state.position, x, state.h)
        velocity, a = advance(state.velocity, v, state.h)
        waiting = np.concatenate((state.waiting, v))
        return State(position, velocity, waiting[len(a) :], state.h), (waiting[: len(a)], a)

    def finish(self, state: State) -> tuple[Array, ...]:
        last = settle(state.position, state.h)
        velocity, a = advance(state.velocity, last, state.h)
        a = np.concatenate((a, settle(velocity, state.h)))
        return np.concatenate((state.waiting, last)), a


def advance(line: Line, x: Array, h: float) -> tuple[Line, Array]:
    """The derivatives that the new samples settle."""
    samples = np.concatenate((line.held, x))
    inner = (samples[2:] - samples[:-2]) / (2.0 * h)
    if line.begun or len(samples) < 2:
        return Line(samples[-2:], line.begun), inner
    first = (samples[1:2] - samples[:1]) / h
    return Line(samples[-2:], begun=True), np.concatenate((first, inner))


def settle(line: Line, h: float) -> Array:
    """The derivative of the last sample."""
    return np.diff(line.held) / h
