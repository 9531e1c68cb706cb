"""Central difference, twice: no delay and no filter, for positions that are filtered already.

The field's standard after a zero-phase filter. One-sided at both ends, like numpy.gradient. A row
waits for the two that follow it. Matched as it is. No settings.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.recursion import Derivatives
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
    LAG: ClassVar[int] = 2
    PRESETS: ClassVar[dict[str, dict[str, float]]] = {}

    companion: ClassVar[None] = None

    def matched(self) -> Differentiator:
        """Central differences add no dynamics."""
        return self

    def init(self, q: float, h: float) -> State:  # noqa: ARG002 (no state before the first sample)
        none = np.empty(0)
        return State(Line(none), Line(none), none, h)

    def step(self, state: State, q: Array) -> tuple[State, Derivatives]:
        position, v = advance(state.position, q, state.h)
        velocity, a = advance(state.velocity, v, state.h)
        waiting = np.concatenate((state.waiting, v))
        return State(position, velocity, waiting[len(a) :], state.h), (waiting[: len(a)], a)

    def finish(self, state: State) -> Derivatives:
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
