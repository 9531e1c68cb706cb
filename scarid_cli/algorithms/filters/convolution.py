"""Finite impulse response filters with their state, and differentiators made of them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.algorithms.processes.matching import Differences
from scarid_cli.algorithms.processes.process import Causal
from scarid_cli.arrays import Array
from scarid_cli.kernels import fir


@dataclass(frozen=True)
class Window:
    """The last samples, the taps of each output, the lag, and how many outputs are yet to drop.

    A filter that looks so many samples ahead makes as many outputs before that of its first row.
    """

    held: Array
    taps: tuple[Array, ...]
    lag: int
    drop: int


class Convolution(Causal, ABC):
    """Filters of one length, at rest before the first sample and, with a lag, after the last."""

    @abstractmethod
    def taps(self, h: float) -> tuple[Array, ...]:
        """One set for each output, for the newest sample first; h [s]."""

    def init(self, x: float, h: float) -> Window:
        taps, lag = self.taps(h), int(self.lag(h))
        return Window(np.full(len(taps[0]) - 1, x), taps, lag, lag)

    def step(self, state: Window, x: Array) -> tuple[Window, tuple[Array, ...]]:
        samples = np.concatenate((state.held, x))
        outputs = tuple(convolved(samples, taps)[state.drop :] for taps in state.taps)
        held = samples[len(x) :]
        return replace(state, held=held, drop=max(state.drop - len(x), 0)), outputs

    def finish(self, state: Window) -> tuple[Array, ...]:
        if not state.lag:
            return ()
        return self.step(state, np.full(state.lag, state.held[-1]))[1]


def convolved(samples: Array, taps: Array) -> Array:
    """The outputs of a filter at every sample but the first len(taps) - 1."""
    y = np.empty(len(samples) - len(taps) + 1)
    fir.filtered(np.ascontiguousarray(samples), y, np.ascontiguousarray(taps))
    return y


class FirMethod(Convolution):
    """A differentiator of finite impulse response."""

    @abstractmethod
    def lowpass(self, h: float) -> Array:
        """What a derivative is the difference of: taps of unit sum; h [s]."""

    def matched(self) -> Differences:
        return Differences(Lowpass(self))


@dataclass(frozen=True)
class Lowpass(Convolution):
    """The low-pass of a differentiator, one sample early where that looks ahead."""

    method: FirMethod

    def lag(self, h: float) -> float:
        return self.method.lag(h)

    def taps(self, h: float) -> tuple[Array, ...]:
        return (self.method.lowpass(h),)


def integrated(taps: Array, order: int, h: float) -> Array:
    """The low-pass whose difference of this order these taps of a derivative are."""
    for _ in range(order):
        taps = np.cumsum(taps)[:-1] * h
    return taps
