"""Filters of finite impulse response (FIR) with their state, and differentiators made of them."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.algorithms.processes.matching import CentralDifferences
from scarid_cli.algorithms.processes.method import Matching, Method
from scarid_cli.algorithms.processes.process import Causal
from scarid_cli.arrays import Array
from scarid_cli.kernels import fir


@dataclass(frozen=True)
class ConvolutionState:
    """The last samples, the taps of each output, the lag, and the outputs still to be dropped.

    A filter that looks `lag` samples ahead makes as many outputs before that of its first row.
    """

    held: Array
    taps: tuple[Array, ...]
    lag: int
    drop: int


class Convolution(Causal):
    """Filters of the same length, side by side.

    They are at rest before the first sample and, if they look ahead, after the last one.
    """

    @abstractmethod
    def taps(self, h: float) -> tuple[Array, ...]:
        """The taps of each output, that of the newest sample first; h [s]."""

    def init(self, x: float, h: float) -> ConvolutionState:
        taps, lag = self.taps(h), int(self.lag(h))
        return ConvolutionState(np.full(len(taps[0]) - 1, x), taps, lag, lag)

    def step(self, state: ConvolutionState, x: Array) -> tuple[ConvolutionState, tuple[Array, ...]]:
        samples = np.concatenate((state.held, x))
        outputs = tuple(convolved(samples, taps)[state.drop :] for taps in state.taps)
        held = samples[len(x) :]
        return replace(state, held=held, drop=max(state.drop - len(x), 0)), outputs

    def finish(self, state: ConvolutionState) -> tuple[Array, ...]:
        if not state.lag:
            return ()
        return self.step(state, np.full(state.lag, state.held[-1]))[1]


def convolved(samples: Array, taps: Array) -> Array:
    """The outputs of a filter at every sample but the first len(taps) - 1."""
    y = np.empty(len(samples) - len(taps) + 1)
    fir.filtered(np.ascontiguousarray(samples), y, np.ascontiguousarray(taps))
    return y


class LowpassMethod(Method):
    """A differentiator that is a FIR low-pass followed by differences."""

    MATCHING = Matching.EXACT

    @abstractmethod
    def lowpass(self, h: float) -> Array:
        """The taps of the low-pass, of unit sum; h [s].

        The acceleration, or the derivative from which the method is matched, is its difference.
        """

    def matched(self) -> CentralDifferences:
        return CentralDifferences(FirLowpass(self))


class FirMethod(Convolution, LowpassMethod):
    """A causal differentiator whose velocity and acceleration are two FIR filters."""


@dataclass(frozen=True)
class FirLowpass(Convolution):
    """The low-pass of a differentiator."""

    method: LowpassMethod

    def lag(self, h: float) -> float:
        return self.method.lag(h)

    def taps(self, h: float) -> tuple[Array, ...]:
        return (self.method.lowpass(h),)


def integrated(taps: Array, order: int, h: float) -> Array:
    """The low-pass of which these taps of a derivative are the difference of the given order."""
    for _ in range(order):
        taps = np.cumsum(taps)[:-1] * h
    return taps
