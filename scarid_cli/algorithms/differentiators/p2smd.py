"""Proposed second-order sliding mode differentiator, with adaptive gains (paper eq. 7-9).

Causal. Velocity is y0, acceleration y1. Nearly the linear observer with poles
s^2 + gamma0 s + gamma0 gamma1: the acceleration lags by 1 / gamma1 (50 ms), the velocity does
not. Rule: gamma1 = 1 / (wanted delay), gamma0 = 2 gamma1 or less. Matched (--match): by its
linearisation, without the adaptive terms; velocity is z1, position and torque pass the observer.
gamma0 = 25, gamma1 = 20: convergence gains [1/s] (Table 1).
eta0 = eta1 = eta2 = 0: initial adaptive gains.
leak = 0.1 [1/s], cap = 2, nu_max = 1 [s]: keep the adaptive gains (in 0..cap) and the integral of
the sign bounded. Eq. 9 alone lets them grow for ever, and diverges at standstill; preset table1
is that literal law.
implicit = 0: 1 for implicit Euler's steps, stable at every gain; 0 for the paper's explicit ones.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.choices.ranges import Range
from scarid_cli.algorithms.choices.settings import (
    require_between,
    require_not_negative,
    require_positive,
    require_positive_or_infinite,
)
from scarid_cli.algorithms.filters.sections import SectionState, advanced, at_rest
from scarid_cli.algorithms.processes.process import Causal, Recursion
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault
from scarid_cli.kernels import p2smd


@dataclass(frozen=True)
class Differentiator(Causal):
    gamma0: float = 25.0
    gamma1: float = 20.0
    eta0: float = 0.0
    eta1: float = 0.0
    eta2: float = 0.0
    leak: float = 0.1
    cap: float = 2.0
    nu_max: float = 1.0
    implicit: int = 0

    PRESETS: ClassVar = {"table1": {"leak": 0.0, "cap": inf, "nu_max": inf}}
    TUNED: ClassVar = {"gamma0": Range(2.0, 300.0), "gamma1": Range(2.0, 300.0)}

    def __post_init__(self) -> None:
        require_positive(self, "gamma0", "gamma1")
        require_positive_or_infinite(self, "cap", "nu_max")
        require_not_negative(self, "eta0", "eta1", "eta2", "leak")
        require_between(self, 0, 1, "implicit")
        if self.implicit and self.cap == inf:
            raise UsageFault("implicit must be 0 with an infinite cap: its law needs gains above 0")

    def init(self, x: float, h: float) -> Recursion:
        return Recursion(np.array([x, 0.0, 0.0, self.eta0, self.eta1, self.eta2]), h)

    def step(self, state: Recursion, x: Array) -> tuple[Recursion, tuple[Array, ...]]:
        state = state.copy()
        v, a = np.empty_like(x), np.empty_like(x)
        run = p2smd.implicit if self.implicit else p2smd.differentiate
        run(x, v, a, state.values, self._gains(), state.h)
        return state, (v, a)

    def matched(self) -> Matched:
        return Matched(self)

    def _gains(self) -> Array:
        # The literal law has no lower bound: eta2 of eq. 9 is free to change its sign.
        floor = 0.0 if self.cap < inf else -inf
        return np.array([self.gamma0, self.gamma1, self.leak, floor, self.cap, self.nu_max])


@dataclass(frozen=True)
class MatchedState:
    """The method's own state, and the position on its way through the linear observer."""

    own: Recursion
    position: SectionState


@dataclass(frozen=True)
class Matched(Causal):
    """Acceleration y1 as it is; velocity z1, brought to the instant of y1."""

    method: Differentiator

    @property
    def torque_filter(self) -> Observer:
        method = self.method
        return Observer(method.gamma0, method.gamma1, implicit=bool(method.implicit))

    def init(self, x: float, h: float) -> MatchedState:
        return MatchedState(self.method.init(x, h), self.torque_filter.init(x, h))

    def step(self, state: MatchedState, x: Array) -> tuple[MatchedState, tuple[Array, ...]]:
        own, (_, a) = self.method.step(state.own, x)
        h = own.h
        # z1 as the recursion runs through it, from sample to sample; a is centred between two
        z1 = np.cumsum(np.concatenate((state.own.values[1:2], h * a)))
        position, (q,) = self.torque_filter.step(state.position, x)
        return MatchedState(own, position), (q, z1[:-1] + 0.5 * h * a, a)


@dataclass(frozen=True)
class Observer(Causal):
    """gamma0 gamma1 / (s^2 + gamma0 s + gamma0 gamma1) in the Euler steps of the method.

    Its output is the sum of h z1 as of the sample where central differences of it are h-exactly
    the matched velocity and acceleration: the next sample's (explicit) or the last one's.
    """

    gamma0: float
    gamma1: float
    implicit: bool

    def init(self, x: float, h: float) -> SectionState:
        g0, g1 = self.gamma0 * h, self.gamma0 * self.gamma1 * h * h
        if self.implicit:
            a0 = 1.0 + g0 + g1
            section = np.array([0.0, g1, 0.0, -2.0 - g0, 1.0]) / a0
        else:
            section = np.array([0.0, g1, 0.0, g0 - 2.0, 1.0 - g0 + g1])
        return at_rest(section[None, :], x)

    def step(self, state: SectionState, x: Array) -> tuple[SectionState, tuple[Array, ...]]:
        state, y = advanced(state, x)
        return state, (y,)
