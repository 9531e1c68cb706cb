"""Phase matching: position, derivatives and torque of one instant.

tau = W(q, dq, ddq) theta holds only between signals of the same instant, but a differentiator
delays. A linear method is a low-pass followed by differences. Its matched form gives the low-passed
position with exactly its central differences, and torques pass the same low-pass. See
docs/theory.md, section "Phase matching".
"""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from scarid_cli.algorithms.processes.method import MatchedForm, Method
from scarid_cli.algorithms.processes.process import Process
from scarid_cli.arrays import Array

POSITION, ACCELERATION = 0.01, 0.005  # see settling_rows


@dataclass(frozen=True)
class LowpassedSamples:
    """The state of a low-pass, its last two outputs, and the sampling period [s]."""

    lowpass: Any
    last: Array
    h: float


class AfterLowpass(Process):
    """A process that looks at the output of a low-pass and at the samples on both sides of it."""

    lowpass: Process

    def lag(self, h: float) -> float:
        return self.lowpass.lag(h)

    def init(self, x: float, h: float) -> LowpassedSamples:
        return LowpassedSamples(self.lowpass.init(x, h), np.full(2, x), h)

    def step(self, state: LowpassedSamples, x: Array) -> tuple[LowpassedSamples, tuple[Array, ...]]:
        after, (y,) = self.lowpass.step(state.lowpass, x)
        samples = np.concatenate((state.last, y))
        return LowpassedSamples(after, samples[-2:], state.h), self.outputs(samples, state.h)

    def finish(self, state: LowpassedSamples) -> tuple[Array, ...]:
        rest = self.lowpass.finish(state.lowpass)
        return self.outputs(np.concatenate((state.last, *rest)), state.h) if rest else ()

    @abstractmethod
    def outputs(self, samples: Array, h: float) -> tuple[Array, ...]:
        """The outputs of all samples but the first and the last."""


@dataclass(frozen=True)
class CentralDifferences(AfterLowpass, MatchedForm):
    """The matched form of a linear method: its low-pass, and the central differences of that.

    `torques` is the low-pass for torques where it is not that for positions: the same one without
    a gate against encoder glitches.
    """

    lowpass: Process
    torques: Process | None = None

    @property
    def torque_filter(self) -> DelayedLowpass:
        return DelayedLowpass(self.torques or self.lowpass)

    def outputs(self, samples: Array, h: float) -> tuple[Array, ...]:
        v = (samples[2:] - samples[:-2]) / (2.0 * h)
        steps = samples[1:] - samples[:-1]
        return samples[1:-1], v, (steps[1:] - steps[:-1]) / h**2


@dataclass(frozen=True)
class DelayedLowpass(AfterLowpass):
    """A low-pass, delayed by the sample that central differences of it need."""

    lowpass: Process

    def outputs(self, samples: Array, h: float) -> tuple[Array, ...]:  # noqa: ARG002
        return (samples[1:-1],)


@dataclass(frozen=True)
class WaitingPositions:
    """The state of a method, and the positions that wait for their derivatives."""

    own: Any
    positions: Array


@dataclass(frozen=True)
class Unfiltered(MatchedForm):
    """The matched form of a method that delays nothing: the position is as it was measured."""

    method: Method

    @property
    def torque_filter(self) -> None:
        return None

    def lag(self, h: float) -> float:
        return self.method.lag(h)

    def init(self, x: float, h: float) -> WaitingPositions:
        return WaitingPositions(self.method.init(x, h), np.empty(0))

    def step(self, state: WaitingPositions, x: Array) -> tuple[WaitingPositions, tuple[Array, ...]]:
        own, outputs = self.method.step(state.own, x)
        positions = np.concatenate((state.positions, x))
        rows = len(outputs[0]) if outputs else 0
        after = WaitingPositions(own, positions[rows:])
        return after, (positions[:rows], *outputs) if outputs else ()

    def finish(self, state: WaitingPositions) -> tuple[Array, ...]:
        return state.positions, *self.method.finish(state.own)


def settling_rows(process: Process, h: float) -> tuple[int, int]:
    """The rows before and after a step [sampled every h, in s] over which the response is off.

    As many rows at the end and at the start of a record are not what they would be in the middle
    of a longer one. The response counts as settled once the position is within 1 % of the step,
    and the acceleration, for a record that begins in motion, within 0.5 % of its response to a
    step of the velocity. Both numbers are measured on steps, unless the process declares them.
    """
    return _settling_rows(process, h)


@lru_cache(maxsize=64)  # processes are frozen dataclasses; the joints often have the same one
def _settling_rows(process: Process, h: float) -> tuple[int, int]:
    if process.SETTLING_ROWS is not None:
        return process.SETTLING_ROWS
    half = 64
    while True:
        step = np.repeat([0.0, 1.0], half)
        response = over(process, step, h)[0]
        moves = np.abs(np.diff(response, prepend=0.0))
        off = np.flatnonzero(
            (np.abs(response - step) > POSITION) | (moves > ACCELERATION * moves.max())
        )
        if not len(off):
            return 0, 0
        before, after = max(half - int(off[0]), 0), max(int(off[-1]) + 1 - half, 0)
        if max(before, after) <= half // 2 or half > 1e6:
            return before, after
        half *= 2


def over(process: Process, x: Array, h: float) -> tuple[Array, ...]:
    """The outputs of a process for a whole record x, sampled every h [s]."""
    state, first = process.step(process.init(float(x[0]), h), x)
    rest = process.finish(state)
    parts = [rows for rows in (first, rest) if rows]
    return tuple(np.concatenate(pieces) for pieces in zip(*parts, strict=True))
