"""Phase matching: position, derivatives and torque of one instant (A.3 of the equations; ours).

tau = W(q, dq, ddq) theta holds between signals of the same instant only. A linear method is a
low-pass followed by differences; its matched form gives the derivatives that are exactly the
central differences of the low-passed position, and torques go through the same low-pass.
"""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, ClassVar

import numpy as np

from scarid_cli.algorithms.processes.process import Process
from scarid_cli.arrays import Array

POSITION, ACCELERATION = 0.01, 0.005  # see settling_rows


@dataclass(frozen=True)
class Behind:
    """The state of a low-pass, its last two outputs, and the sampling period [s]."""

    lowpass: Any
    last: Array
    h: float


class AfterLowpass:
    """What is made of a low-pass and the samples on both sides."""

    lowpass: Process

    def lag(self, h: float) -> float:
        return self.lowpass.lag(h)

    def init(self, x: float, h: float) -> Behind:
        return Behind(self.lowpass.init(x, h), np.full(2, x), h)

    def step(self, state: Behind, x: Array) -> tuple[Behind, tuple[Array, ...]]:
        after, (y,) = self.lowpass.step(state.lowpass, x)
        samples = np.concatenate((state.last, y))
        return Behind(after, samples[-2:], state.h), self.outputs(samples, state.h)

    def finish(self, state: Behind) -> tuple[Array, ...]:
        rest = self.lowpass.finish(state.lowpass)
        return self.outputs(np.concatenate((state.last, *rest)), state.h) if rest else ()

    @abstractmethod
    def outputs(self, samples: Array, h: float) -> tuple[Array, ...]:
        """Those of all samples but the first and the last."""


@dataclass(frozen=True)
class Differences(AfterLowpass):
    """The matched form of a linear method: its low-pass, and the central differences of that.

    torques: the same low-pass where it is another for torques, without a gate against glitches.
    """

    lowpass: Process
    torques: Process | None = None

    @property
    def torque_filter(self) -> Delayed:
        return Delayed(self.torques or self.lowpass)

    def outputs(self, samples: Array, h: float) -> tuple[Array, ...]:
        v = (samples[2:] - samples[:-2]) / (2.0 * h)
        return samples[1:-1], v, np.diff(np.diff(samples)) / h**2


@dataclass(frozen=True)
class Delayed(AfterLowpass):
    """A low-pass and the sample of delay by which its differences are central."""

    lowpass: Process

    def outputs(self, samples: Array, h: float) -> tuple[Array, ...]:  # noqa: ARG002
        return (samples[1:-1],)


@dataclass(frozen=True)
class Beside:
    """The state of a method, and the positions that wait for their derivatives."""

    own: Any
    positions: Array


@dataclass(frozen=True)
class WithPosition:
    """The matched form of a method that adds no dynamics: the position as it is."""

    method: Process
    torque_filter: ClassVar[None] = None

    def lag(self, h: float) -> float:
        return self.method.lag(h)

    def init(self, x: float, h: float) -> Beside:
        return Beside(self.method.init(x, h), np.empty(0))

    def step(self, state: Beside, x: Array) -> tuple[Beside, tuple[Array, ...]]:
        own, outputs = self.method.step(state.own, x)
        positions = np.concatenate((state.positions, x))
        rows = len(outputs[0]) if outputs else 0
        return Beside(own, positions[rows:]), (positions[:rows], *outputs) if outputs else ()

    def finish(self, state: Beside) -> tuple[Array, ...]:
        return state.positions, *self.method.finish(state.own)


def settling_rows(process: Process, h: float) -> tuple[int, int]:
    """Rows before and after a step over which the response is off, or still moves.

    So many rows at the end and at the start of a record are not what they would be in the middle:
    the position by more than 1 % of a step, or, where the record begins in motion, the acceleration
    by more than .5 % of what a step of the velocity does to it.
    """
    return _settling_rows(process, h)  # type: ignore[arg-type]  # processes are frozen dataclasses


@lru_cache(maxsize=64)  # the joints of a robot often have the same
def _settling_rows(process: Process, h: float) -> tuple[int, int]:
    known: tuple[int, int] | None = getattr(process, "edges", None)
    if known is not None:
        return known
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
    """The outputs of a process for a whole record x."""
    state, begun = process.step(process.init(float(x[0]), h), x)
    rest = process.finish(state)
    parts = [rows for rows in (begun, rest) if rows]
    return tuple(np.concatenate(pieces) for pieces in zip(*parts, strict=True))
